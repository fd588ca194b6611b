#include "volcal/identify/tables/error_field.h"

#include <memory>

namespace volcal {
namespace {

const std::string kReversalPrefix = "reversal ";

std::optional<ErrorSymbol> reversal_symbol(const ParameterBlock& block) {
  if (block.kind != ParameterKind::Effect || !block.name.starts_with(kReversalPrefix)) return std::nullopt;
  return ErrorSymbol::parse(block.name.substr(kReversalPrefix.size()));
}

}  // namespace

IdentifiedErrors::IdentifiedErrors(const FitResult& result)
    : layout_(result.layout), parameters_(result.parameters) {
  for (const ParameterBlock& block : layout_.blocks) {
    if (const auto symbol = reversal_symbol(block))
      reversals_.push_back({*symbol, parameters_[block.offset]});
  }
}

PoseErrors<double> IdentifiedErrors::at(const AxisPosition& position,
                                        const ApproachDirection& direction) const {
  PoseErrors<double> errors;
  double values[kMaxBasisSupport];
  for (const FunctionGroup& group : layout_.groups) {
    const int start = group.basis->evaluate(position[index_of(group.axis)], values);
    for (int slot = 0; slot < group.count(); ++slot) {
      double sum = 0.0;
      for (int j = 0; j < group.basis->support(); ++j)
        sum += values[j] * parameters_[group.index(start + j, slot)];
      const Component component = group.symbols[static_cast<std::size_t>(slot)].component;
      errors.motion[index_of(group.axis)][index_of(component)] = sum;
    }
  }
  for (const ParameterBlock& block : layout_.blocks) {
    if (!block.location) continue;
    errors.location[index_of(block.location->axis)][index_of(block.location->component)] =
        parameters_[block.offset];
  }
  for (const Reversal& reversal : reversals_) {
    errors.motion[index_of(reversal.symbol.axis)][index_of(reversal.symbol.component)] +=
        0.5 * direction[index_of(reversal.symbol.axis)] * reversal.amplitude;
  }
  return errors;
}

ErrorField identified_error_field(const FitResult& result, const Eigen::Vector3d& tool_offset) {
  const auto errors = std::make_shared<const IdentifiedErrors>(result);
  const KinematicChain chain(result.machine);
  return [errors, chain, tool_offset](const AxisPosition& position, const ApproachDirection& direction) {
    AxisPosition linear{};
    for (const AxisName axis : kLinearAxes) linear[index_of(axis)] = position[index_of(axis)];
    PoseErrors<double> values = errors->at(linear, direction);
    for (const AxisName axis : {AxisName::A, AxisName::B, AxisName::C}) {
      values.motion[index_of(axis)] = {};
      values.location[index_of(axis)] = {};
    }
    return Eigen::Vector3d(chain.first_order(linear, tool_offset, values).displacement_w);
  };
}

std::vector<std::string> effects_not_in_tables(const FitResult& result) {
  std::vector<std::string> names;
  for (const ParameterBlock& block : result.layout.blocks) {
    const bool effect = block.kind == ParameterKind::Effect || block.kind == ParameterKind::EffectShape;
    if (effect && !reversal_symbol(block)) names.push_back(block.name);
  }
  return names;
}

}  // namespace volcal
