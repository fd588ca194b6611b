#pragma once
/// Surfaces of which every value is known: coefficients at the nodes of a variable make a straight line of
/// it, and splines add up to one.

#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal::testing_support {

inline constexpr double kLargestOfSurface = 10e-6, kCoefficientU = 1e-6;

/// An effect of the kind `empirical` whose value is kLargestOfSurface times the share of the range of
/// variable `along`, each coefficient uncertain by kCoefficientU by itself.
inline void add_straight_surface(FitResult& result, const EffectSpec& spec, std::size_t along) {
  const auto effect = find_effect("empirical")->make(spec, "model.toml");
  const TensorBasis& basis = *effect->surface();
  int before = 1, behind = 1;  // functions of the variables before and behind it
  for (std::size_t side = 0; side < basis.sides().size(); ++side) {
    if (side < along) before *= basis.size(side);
    if (side > along) behind *= basis.size(side);
  }
  ParameterBlock block;
  block.kind = ParameterKind::Effect;
  block.name = common_label(*effect);
  block.offset = result.layout.size;
  block.guess = Eigen::VectorXd::Zero(basis.size());
  block.prior_mean = block.prior_sigma = block.guess;
  for (const EffectAmplitude& amplitude : effect->amplitudes()) {
    block.labels.push_back(amplitude.label.substr(block.name.size() + 1));
    block.units.push_back(amplitude.unit());
    block.si_per_unit.push_back(amplitude.si_per_unit());
  }
  const int former = result.layout.size;
  result.layout.size += block.size();
  result.layout.blocks.push_back(block);
  result.identified.effects.push_back(spec);
  result.parameters.conservativeResize(result.layout.size);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(result.layout.size, result.layout.size);
  covariance.topLeftCorner(former, former) = result.covariance;
  covariance.bottomRightCorner(block.size(), block.size()) =
      kCoefficientU * kCoefficientU * Eigen::MatrixXd::Identity(block.size(), block.size());
  result.covariance = covariance;
  const Eigen::VectorXd nodes = basis.nodes(along);
  int next = block.offset;
  for (int i = 0; i < before; ++i) {
    for (const double node : nodes) {
      for (int k = 0; k < behind; ++k) result.parameters[next++] = kLargestOfSurface * node;
    }
  }
}

inline EffectSpec stated_surface(const std::string& target, const std::string& drivers,
                                 std::vector<double> from, std::vector<double> to,
                                 std::vector<double> pieces) {
  return effect_spec("empirical", {{"target", target},
                                   {"drivers", drivers},
                                   {"from", std::move(from)},
                                   {"to", std::move(to)},
                                   {"pieces", std::move(pieces)}});
}

}  // namespace volcal::testing_support
