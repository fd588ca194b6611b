#include "volcal/identify/errors/design_stage.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/errors/stated_errors.h"
#include "volcal/model/description/parameter_names.h"

namespace volcal {
namespace {

constexpr int kWaves = 2;
constexpr int kShapes = 1 + 2 * kWaves;

/// A slope and waves over the travel, each of mean square 1 about the middle of its band, less their values
/// at home.
class ToleranceShape final : public Basis {
 public:
  ToleranceShape(const Axis& axis, bool has_slope)
      : low_(axis.travel_min), travel_(axis.travel()), has_slope_(has_slope) {
    shapes(axis.home, 0, at_home_);
  }

  int size() const override { return kShapes; }
  int support() const override { return kShapes; }
  std::vector<double> pieces() const override {
    std::vector<double> ends;
    for (int i = 0; i <= 2 * kWaves; ++i) ends.push_back(low_ + travel_ * i / (2.0 * kWaves));
    return ends;
  }
  int quadrature_order() const override { return 16; }
  int roughness_order() const override { return 0; }

  int evaluate(double q, int order, double* values) const override {
    shapes(q, order, values);
    if (order == 0) {
      for (int i = 0; i < kShapes; ++i) values[i] -= at_home_[i];
    }
    return 0;
  }

 private:
  /// Derivatives to q.
  void shapes(double q, int order, double* values) const {
    const double t = (q - low_) / travel_ - 0.5;
    const double line = order == 0 ? t : order == 1 ? 1.0 : 0.0;
    const double per_unit = std::pow(travel_, -order);
    values[0] = has_slope_ ? std::sqrt(12.0) * line * per_unit : 0.0;
    for (int k = 1; k <= kWaves; ++k) {
      const double wave_number = 2.0 * std::numbers::pi * k;
      const double angle = wave_number * t + 0.5 * std::numbers::pi * order;
      const double factor = std::pow(wave_number, order);
      double sine = factor * std::sin(angle), mean_square = 0.5;
      if (!has_slope_) {
        // The least-squares slope of sin(wave_number t) over t = -1/2 .. 1/2.
        const double slope = -12.0 * (k % 2 == 0 ? 1.0 : -1.0) / wave_number;
        sine -= slope * line;
        mean_square -= slope * slope / 12.0;
      }
      values[2 * k - 1] = sine * per_unit / std::sqrt(mean_square);
      values[2 * k] = std::numbers::sqrt2 * factor * std::cos(angle) * per_unit;
    }
  }

  double low_;
  double travel_;
  bool has_slope_;
  double at_home_[kShapes];
};

/// Shares of the variance: slope, then sine and cosine of each wave.
std::vector<double> variance_shares(bool has_slope) {
  const double first = has_slope ? 1.0 / 3.0 : 2.0 / 3.0, second = 0.5 * first;
  return {has_slope ? 0.5 : 0.0, 0.5 * first, 0.5 * first, 0.5 * second, 0.5 * second};
}

class DesignLayout {
 public:
  void add_function(const Axis& axis, ErrorSymbol symbol, double width) {
    const bool has_slope = has_free_slope(symbol);
    FunctionGroup group;
    group.axis = axis.name;
    group.basis = std::make_shared<const ToleranceShape>(axis, has_slope);
    group.symbols = {symbol};
    group.offset = static_cast<int>(variances_.size());
    layout_.groups.push_back(std::move(group));
    const double u = band_uncertainty(width);
    for (const double share : variance_shares(has_slope)) variances_.push_back(share * u * u);
    layout_.function_size = static_cast<int>(variances_.size());
  }

  void add_location(LocationSymbol symbol, double u) {
    add_block(ParameterKind::Location, symbol.name(), u).location = symbol;
  }

  void add_expansion(AxisName axis, double u) {
    add_block(ParameterKind::Expansion, expansion_parameter(axis), u);
  }

  void take(FitResult& result) {
    layout_.size = static_cast<int>(variances_.size());
    result.layout = std::move(layout_);
    const auto size = static_cast<Eigen::Index>(variances_.size());
    result.parameters = Eigen::VectorXd::Zero(size);
    result.covariance = Eigen::Map<Eigen::VectorXd>(variances_.data(), size).asDiagonal();
  }

 private:
  ParameterBlock& add_block(ParameterKind kind, std::string name, double u) {
    ParameterBlock block;
    block.kind = kind;
    block.name = std::move(name);
    block.labels = {""};
    block.offset = static_cast<int>(variances_.size());
    block.guess = Eigen::VectorXd::Zero(1);
    variances_.push_back(u * u);
    return layout_.blocks.emplace_back(std::move(block));
  }

  ParameterLayout layout_;
  std::vector<double> variances_;
};

}  // namespace

double band_uncertainty(double width) { return width / (2.0 * std::numbers::sqrt3); }

FitResult result_of_tolerances(const Machine& machine, const Tolerances& tolerances) {
  FitResult result = stated_result(machine, {});
  DesignLayout layout;
  for (const auto& [symbol, width] : tolerances.functions)
    layout.add_function(machine.axis(symbol.axis), symbol, width);
  for (const auto& [symbol, width] : tolerances.squareness)
    layout.add_location(symbol, band_uncertainty(width));
  for (const Axis& axis : machine.axes) {
    if (axis.expansion && axis.expansion->per_kelvin_sigma > 0.0)
      layout.add_expansion(axis.name, axis.expansion->per_kelvin_sigma);
  }
  layout.take(result);
  return result;
}

}  // namespace volcal
