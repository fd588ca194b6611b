#include "volcal/identify/result/surface_values.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

constexpr int kPlaces = 17;  // per driver

/// Equally spaced, the last driver first.
std::vector<std::vector<double>> places(const TensorBasis& basis) {
  std::vector<std::vector<double>> all = {{}};
  for (const TensorBasis::Side& side : basis.sides()) {
    std::vector<std::vector<double>> longer;
    for (const auto& place : all) {
      for (int i = 0; i < kPlaces; ++i) {
        longer.push_back(place);
        longer.back().push_back(side.from + (side.to - side.from) * i / (kPlaces - 1.0));
      }
    }
    all = std::move(longer);
  }
  return all;
}

SurfaceValues values_of(std::shared_ptr<const Effect> effect, const EffectSpec& spec,
                        const ParameterBlock& block, const FitResult& result) {
  const TensorBasis& basis = *effect->surface();
  SurfaceValues values;
  values.label = effect_label(*effect);
  values.target = effect->name().target.name();
  values.factor = spec.options.text("factor").value_or("");
  values.drivers = variables_in(*spec.options.text("drivers"));
  values.unit = block.units.front();
  values.si_per_unit = block.si_per_unit.front();
  values.offset = block.offset;
  const Eigen::VectorXd coefficients = result.parameters.segment(block.offset, block.size());
  double squares = 0.0;
  const auto all = places(basis);
  for (const auto& place : all) {
    const Eigen::VectorXd row = basis.row(place);
    const double value = row.dot(coefficients);
    squares += value * value;
    if (values.at.empty() || std::abs(value) > std::abs(values.largest)) {
      values.largest = value;
      values.at = place;
      values.largest_row = row;
    }
  }
  values.rms = std::sqrt(squares / static_cast<double>(all.size()));
  values.effect = std::move(effect);
  values.largest_u = uncertainty_of_values(result, values, values.largest_row.transpose())[0];
  return values;
}

}  // namespace

std::string SurfaceValues::place_words() const {
  std::string words;
  for (std::size_t i = 0; i < at.size(); ++i)
    words += fmt::format("{}{} = {:.4g}", i > 0 ? ", " : "", drivers[i].written(), at[i]);
  return words;
}

std::vector<SurfaceValues> surface_values(const FitResult& result) {
  std::vector<SurfaceValues> surfaces;
  for (const EffectSpec& spec : result.identified.effects) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) continue;
    std::shared_ptr<const Effect> effect = kind->make(spec, result.identified.file);
    if (effect->surface() == nullptr) continue;
    if (const ParameterBlock* block = result.layout.find_block(common_label(*effect)))
      surfaces.push_back(values_of(std::move(effect), spec, *block, result));
  }
  return surfaces;
}

Eigen::VectorXd uncertainty_of_values(const FitResult& result, const SurfaceValues& surface,
                                      const Eigen::MatrixXd& rows) {
  if (result.covariance.size() == 0) return Eigen::VectorXd::Zero(rows.rows());
  const auto own = result.covariance.block(surface.offset, surface.offset, rows.cols(), rows.cols());
  return (rows * own).cwiseProduct(rows).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace volcal
