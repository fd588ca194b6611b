#pragma once
/// Five-axis machines whose errors are known (studies/five_axis_campaign.h), by the names of tests.

#include <random>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/result/result.h"
#include "volcal/studies/five_axis_campaign.h"

namespace volcal::testing_support {

using cli::error_after_datums;
using cli::five_axis_machine;
using cli::five_axis_truth;
using cli::FiveAxisErrors;
using cli::followed;
using cli::GridPlan;
using cli::r_test_campaign;
using cli::state_of;

inline double normal(std::mt19937_64& random, double sigma) {
  return std::normal_distribution<double>(0.0, sigma)(random);
}

}  // namespace volcal::testing_support
