#pragma once
/// Five-axis machines whose errors are known (studies/five_axis_campaign.h), by the names of tests.

#include <random>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/result/result.h"
#include "volcal/studies/five_axis_campaign.h"

namespace volcal::testing_support {

using studies::error_after_datums;
using studies::five_axis_machine;
using studies::five_axis_truth;
using studies::FiveAxisErrors;
using studies::followed;
using studies::GridPlan;
using studies::r_test_campaign;
using studies::state_of;

inline double normal(std::mt19937_64& random, double sigma) {
  return std::normal_distribution<double>(0.0, sigma)(random);
}

}  // namespace volcal::testing_support
