#include "volcal/identify/report/values/correlation.h"

#include <algorithm>
#include <cmath>

namespace volcal::report {
namespace {

constexpr int kSamples = 11;  ///< positions per function

/// Rows that map the parameters to the values of one error.
struct ErrorRows {
  MachineError error;
  Eigen::MatrixXd rows;
};

ErrorRows function_rows(const FitResult& result, const FunctionGroup& group, int slot) {
  const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
  const Axis& axis = result.machine.axis(symbol.axis);
  ErrorRows error{symbol, Eigen::MatrixXd::Zero(kSamples, result.layout.size)};
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::VectorXd values = group.basis->row(axis.travel_min + axis.travel() * i / (kSamples - 1));
    for (int j = 0; j < values.size(); ++j) error.rows(i, group.index(j, slot)) = values[j];
  }
  return error;
}

std::vector<ErrorRows> all_errors(const FitResult& result) {
  std::vector<ErrorRows> errors;
  for (const FunctionGroup& group : result.layout.groups) {
    for (int slot = 0; slot < group.count(); ++slot) errors.push_back(function_rows(result, group, slot));
  }
  for (const ParameterBlock& block : result.layout.blocks) {
    if (!block.location) continue;
    ErrorRows error{*block.location, Eigen::MatrixXd::Zero(1, result.layout.size)};
    error.rows(0, block.offset) = 1.0;
    errors.push_back(std::move(error));
  }
  return errors;
}

}  // namespace

ErrorCorrelation error_correlation(const FitResult& result) {
  const std::vector<ErrorRows> errors = all_errors(result);
  const auto count = static_cast<Eigen::Index>(errors.size());
  ErrorCorrelation correlation;
  correlation.value = Eigen::MatrixXd::Identity(count, count);
  if (result.covariance.size() == 0) {
    for (const ErrorRows& error : errors) correlation.errors.push_back(error.error);
    return correlation;
  }
  Eigen::MatrixXd energy(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    correlation.errors.push_back(errors[static_cast<std::size_t>(a)].error);
    const Eigen::MatrixXd half = errors[static_cast<std::size_t>(a)].rows * result.covariance;
    for (Eigen::Index b = 0; b <= a; ++b) {
      energy(a, b) = (half * errors[static_cast<std::size_t>(b)].rows.transpose()).squaredNorm();
    }
  }
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      const double own = std::sqrt(energy(a, a) * energy(b, b));
      const double value = own > 0.0 ? std::sqrt(energy(a, b) / own) : 0.0;
      correlation.value(a, b) = correlation.value(b, a) = std::min(1.0, value);
    }
  }
  return correlation;
}

}  // namespace volcal::report
