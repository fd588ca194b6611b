#include "volcal/identify/result/surface_values.h"

#include <cmath>
#include <utility>

#include "volcal/identify/result/largest_value.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

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
  const Eigen::MatrixXd covariance =
      result.covariance.size() == 0
          ? Eigen::MatrixXd()
          : result.covariance.block(block.offset, block.offset, block.size(), block.size());
  LargestValue largest = largest_value(basis, coefficients, covariance);
  values.rms = basis.root_mean_square(coefficients);
  values.largest = largest.value;
  values.largest_u = largest.u;
  values.largest_row = std::move(largest.row);
  values.at = std::move(largest.at);
  values.effect = std::move(effect);
  return values;
}

}  // namespace

std::string SurfaceValues::place_words() const { return place_in_words(drivers, at); }

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
