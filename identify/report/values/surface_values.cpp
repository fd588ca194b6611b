#include "volcal/identify/report/values/surface_values.h"

#include <fmt/format.h>

#include <cmath>

#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal::report {
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

SurfaceValues values_of(const Effect& effect, const EffectSpec& spec, const ParameterBlock& block,
                        const FitResult& result) {
  const TensorBasis& basis = *effect.surface();
  SurfaceValues values;
  values.label = effect_label(effect);
  values.drivers = variables_in(*spec.options.text("drivers"));
  values.unit = block.units.front();
  values.si_per_unit = block.si_per_unit.front();
  const Eigen::VectorXd coefficients = result.parameters.segment(block.offset, block.size());
  double squares = 0.0;
  Eigen::VectorXd largest_row;
  const auto all = places(basis);
  for (const auto& place : all) {
    const Eigen::VectorXd row = basis.row(place);
    const double value = row.dot(coefficients);
    squares += value * value;
    if (std::abs(value) <= std::abs(values.largest)) continue;
    values.largest = value;
    values.at = place;
    largest_row = row;
  }
  values.rms = std::sqrt(squares / static_cast<double>(all.size()));
  if (largest_row.size() > 0) {
    const auto covariance = result.covariance.block(block.offset, block.offset, block.size(), block.size());
    values.largest_u = std::sqrt(std::max(0.0, largest_row.dot(covariance * largest_row)));
  }
  return values;
}

}  // namespace

std::vector<SurfaceValues> surface_values(const FitResult& result) {
  std::vector<SurfaceValues> surfaces;
  for (const EffectSpec& spec : result.identified.effects) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) continue;
    const std::unique_ptr<Effect> effect = kind->make(spec, result.identified.file);
    if (effect->surface() == nullptr) continue;
    if (const ParameterBlock* block = result.layout.find_block(surface_name(*effect)))
      surfaces.push_back(values_of(*effect, spec, *block, result));
  }
  return surfaces;
}

std::string surface_line(const SurfaceValues& surface, double coverage_factor) {
  std::string place;
  for (std::size_t i = 0; i < surface.at.size(); ++i)
    place += fmt::format("{}{} = {:.4g}", i > 0 ? ", " : " at ", surface.drivers[i].written(), surface.at[i]);
  return fmt::format("{}: up to {:.3g} +- {:.2g} {}{}", surface.label, surface.largest / surface.si_per_unit,
                     coverage_factor * surface.largest_u / surface.si_per_unit, surface.unit, place);
}

}  // namespace volcal::report
