#include "volcal/identify/errors/alignment_checks.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/machine_effects.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/parallel_axes.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kSameOrigin = 1e-9;                      // m
constexpr double kLargestTilt = 10e-3;                    // rad
const Eigen::Vector3d kObliqueOffset(0.11, 0.07, -0.13);  // m

void check_datum(const Machine& machine, const Datum& datum) {
  for (const AxisName axis : {datum.primary, datum.secondary}) {
    if (!machine.has_axis(axis))
      throw InputError({}, std::string("the machine has no axis ") + letter_of(axis),
                       "align to two linear axes of its structure: --primary, --secondary");
  }
}

void check_origin(const Machine& machine, const AxisPosition& origin) {
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name) && std::abs(origin[index_of(axis.name)] - axis.home) > kSameOrigin)
      throw InputError(
          {}, std::string("an origin has linear axes only, and this one names ") + letter_of(axis.name),
          std::string("leave ") + letter_of(axis.name) + " out: errors of rotary axes keep their own zero");
  }
  for (const AxisName name : machine.linear_axes()) {
    const Axis& axis = machine.axis(name);
    const double q = origin[index_of(name)];
    if (q < axis.travel_min - kSameOrigin || q > axis.travel_max + kSameOrigin)
      throw InputError({}, std::string("the origin lies outside the travel of ") + letter_of(name),
                       "give a point within the travel");
  }
}

bool moves_origin(const Machine& machine, const Alignment& alignment) {
  return alignment.origin && std::ranges::any_of(machine.linear_axes(), [&](AxisName axis) {
           return std::abs((*alignment.origin)[index_of(axis)] - machine.axis(axis).home) > kSameOrigin;
         });
}

/// Names of the blocks of surfaces and expressions: their positions are those that the control commands, not
/// counted from home.
std::set<std::string> by_commanded_positions(const FitResult& result) {
  std::set<std::string> names;
  for (const EffectSpec& spec : result.identified.effects) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) continue;
    const std::unique_ptr<Effect> effect = kind->make(spec, result.identified.file);
    if (effect->surface() != nullptr) names.insert(common_label(*effect));
    if (!effect->changes_with_any_driver()) continue;
    for (const EffectAmplitude& amplitude : effect->amplitudes()) names.insert(amplitude.label);
    for (const EffectShape& shape : effect->shapes()) names.insert(shape.label);
  }
  return names;
}

/// Parameters of effects that are the same at every position, as a reversal or a growth with a temperature.
std::set<int> without_position(const FitResult& result) {
  const Tool tool = result.machine.functional_tools().front();
  Tool oblique = tool;  // turned about any direction it moves
  oblique.offset += kObliqueOffset;
  std::set<int> parameters;
  for (const Tool& each : {tool, oblique}) {
    const MachineEffects effects(result, each, default_conditions(result));
    for (const EffectColumn& column : effects.columns()) {
      if (effects.reach(column.effect).positions() == 0) parameters.insert(column.parameter);
    }
  }
  return parameters;
}

void check_parameters(const FitResult& result, bool origin_moves) {
  if (!origin_moves) return;
  const std::set<std::string> commanded = by_commanded_positions(result);
  const std::set<int> anywhere = without_position(result);
  for (const ParameterBlock& block : result.layout.blocks) {
    const bool refers_to_origin =
        block.kind == ParameterKind::Expansion ||
        ((block.kind == ParameterKind::Effect || block.kind == ParameterKind::EffectShape) &&
         !commanded.contains(block.name) && !anywhere.contains(block.offset));
    if (refers_to_origin)
      throw InputError({}, block.name + " refers to the origin that the fit had",
                       "change home_mm in the machine file and fit again, or leave the origin where it is");
  }
}

void check_spindle(const FitResult& result, const Alignment& alignment) {
  if (!alignment.spindle_tilt) return;
  if (alignment.datum.primary != AxisName::Z)
    throw InputError({}, "the spindle is parallel to Z (ISO 841), the primary axis is not",
                     "make Z the primary axis");
  if (alignment.spindle_tilt->cwiseAbs().maxCoeff() > kLargestTilt)
    throw InputError({}, "the spindle leans by more than 10 mrad", "give its tilt in microradians");
  for (const Component component : {Component::X, Component::Y}) {
    const ErrorSymbol symbol{component, AxisName::Z};
    if (alignment.spindle_tilt->norm() > 0.0 && !result.layout.find(symbol))
      throw InputError(
          {}, symbol.name() + " is switched off and cannot hold the slope of Z to the spindle",
          "fit with " + symbol.name() + " in a B-spline or Legendre basis, or align to the axis");
  }
}

}  // namespace

void check_alignment(const FitResult& result, const Alignment& alignment) {
  require_no_parallel_axes(
      result.machine, "the alignment of a result",
      "choose [datum] in the machine file and fit again, home_mm of every axis as the origin");
  if (alignment.datum.primary == alignment.datum.secondary)
    throw InputError({}, "primary and secondary axis are the same", "name two different axes");
  check_datum(result.machine, alignment.datum);
  if (alignment.origin) check_origin(result.machine, *alignment.origin);
  check_parameters(result, moves_origin(result.machine, alignment));
  check_spindle(result, alignment);
}

}  // namespace volcal
