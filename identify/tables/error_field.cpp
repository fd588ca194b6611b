#include "volcal/identify/tables/error_field.h"

#include <memory>
#include <optional>
#include <utility>

#include "volcal/identify/tables/linear_axis_errors.h"
#include "volcal/model/effects/reversal_label.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

std::optional<ErrorSymbol> reversal_of(const ParameterBlock& block) {
  return block.kind == ParameterKind::Effect ? reversal_symbol(block.name) : std::nullopt;
}

}  // namespace

IdentifiedErrors::IdentifiedErrors(const FitResult& result)
    : layout_(result.layout), parameters_(result.parameters) {
  for (const ParameterBlock& block : layout_.blocks) {
    if (const auto symbol = reversal_of(block)) reversals_.push_back({*symbol, parameters_[block.offset]});
  }
}

PoseErrors<double> IdentifiedErrors::at(const AxisPosition& position,
                                        const ApproachDirection& direction) const {
  PoseErrors<double> errors = pose_errors(layout_, position, parameters_);
  for (const Reversal& reversal : reversals_) {
    errors.motion[index_of(reversal.symbol.axis)][index_of(reversal.symbol.component)] +=
        0.5 * direction[index_of(reversal.symbol.axis)] * reversal.amplitude;
  }
  return errors;
}

AxisPosition without_rotary_axes(const AxisPosition& position) {
  AxisPosition linear{};
  for (const AxisName axis : kLinearAxes) linear[index_of(axis)] = position[index_of(axis)];
  return linear;
}

ErrorField plain_error_field(const FitResult& result, const Eigen::Vector3d& tool_offset) {
  const auto errors = std::make_shared<const IdentifiedErrors>(result);
  const KinematicChain chain(result.machine);
  return [errors, chain, tool_offset](const AxisPosition& position, const ApproachDirection& direction) {
    const AxisPosition linear = without_rotary_axes(position);
    PoseErrors<double> values = errors->at(linear, direction);
    for (const AxisName axis : {AxisName::A, AxisName::B, AxisName::C}) {
      values.motion[index_of(axis)] = {};
      values.location[index_of(axis)] = {};
    }
    return Eigen::Vector3d(chain.first_order(linear, tool_offset, values).displacement_w);
  };
}

ErrorField identified_error_field(const FitResult& result, const Eigen::Vector3d& tool_offset) {
  std::optional<LinearAxisErrors> made = LinearAxisErrors::make(result, tool_offset);
  if (!made) return plain_error_field(result, tool_offset);
  const auto errors = std::make_shared<const LinearAxisErrors>(*std::move(made));
  return [errors](const AxisPosition& position, const ApproachDirection& direction) {
    return errors->at(position, direction);
  };
}

std::vector<std::string> effects_not_in_tables(const FitResult& result) {
  std::vector<std::string> names;
  for (const ParameterBlock& block : result.layout.blocks) {
    const bool effect = block.kind == ParameterKind::Effect || block.kind == ParameterKind::EffectShape;
    if (effect && !reversal_of(block)) names.push_back(block.name);
  }
  return names;
}

}  // namespace volcal
