#include "volcal/identify/compensation/formats/isg_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/rotary/rotary_grid.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kIsgTurn = 360.0;  // deg

/// "X", "Y", "Z", "A", "B", "C" of a component.
char letter_of_component(Component component) { return letter_of(kAllAxes[index_of(component)]); }

/// mm of a displacement, as it is of a rotation, rad.
double isg_unit(Component component) { return is_rotation(component) ? 1.0 : kMetrePerMillimetre; }

bool holds_component(CompensationType type, AxisName axis, Component component) {
  const bool own = is_rotation(component) && direction_of(component) == direction_of(axis);
  return type.has(own ? CompensationPart::RotaryPositioning : CompensationPart::RotaryAngular);
}

/// Along its own direction a line has no displacement, but where it carries the error at home.
bool holds_location(CompensationType type, AxisName axis, Component component, double value) {
  const bool same = direction_of(component) == direction_of(axis);
  if (same && is_rotation(component)) return type.has(CompensationPart::RotaryPositioning);
  return type.has(CompensationPart::RotaryLocation) && (!same || value != 0.0);
}

std::string isg_number(double value, int decimals) {
  // adding 0.0 takes the sign of -0.0
  return fmt::format(" {:.{}f}", value + 0.0, decimals);
}

/// Names in one line, values in the next: the centre, and of an axis with errors its location errors.
std::string constants_block(const Axis& axis, const PoseErrors<double>* errors, CompensationType type) {
  std::string names, values;
  const Eigen::Vector3d centre = axis.centre / kMetrePerMillimetre;
  for (int k = 0; k < 3; ++k) {
    names += fmt::format(" P{}{}", letter_of(kLinearAxes[static_cast<std::size_t>(k)]), letter_of(axis.name));
    values += isg_number(centre[k], 6);
  }
  for (const Component component : kAllComponents) {
    if (errors == nullptr) break;
    const double value = errors->location[index_of(axis.name)][index_of(component)];
    if (!holds_location(type, axis.name, component, value)) continue;
    names += fmt::format(" {}0{}", letter_of_component(component), letter_of(axis.name));
    values += isg_number(value / isg_unit(component), 12);
  }
  return names.substr(1) + "\n" + values.substr(1) + "\n";
}

std::string tool_block(const Tool& tool) {
  std::string values;
  for (const double coordinate : tool.offset) values += isg_number(coordinate / kMetrePerMillimetre, 6);
  return "P0X P0Y P0Z\n" + values.substr(1) + "\n";
}

/// Positions as the control counts them: a turn from 0 to 360, its end as its beginning.
std::vector<double> counted_positions(const RotaryNodes& nodes) {
  if (!nodes.full_turn) return nodes.positions;
  std::vector<double> positions;
  const auto last = static_cast<double>(nodes.positions.size() - 1);
  for (std::size_t i = 0; i < nodes.positions.size(); ++i)
    positions.push_back(static_cast<double>(i) / last * kIsgTurn * kRadianPerDegree);
  return positions;
}

/// Within the travel at which it was identified.
double identified_position(const RotaryNodes& nodes, double position) {
  if (!nodes.full_turn) return position;
  const double turn = kIsgTurn * kRadianPerDegree;
  return position - turn * std::floor((position - nodes.positions.front()) / turn + 1e-9);
}

std::string motions_block(const JointErrorSource& errors, const RotaryNodes& nodes, CompensationType type,
                          double sign) {
  std::string text(1, letter_of(nodes.axis));
  std::vector<Component> columns;
  for (const Component component : kAllComponents) {
    if (!holds_component(type, nodes.axis, component)) continue;
    columns.push_back(component);
    text += " " + ErrorSymbol{component, nodes.axis}.name();
  }
  if (columns.empty()) return {};
  text += '\n';
  for (const double position : counted_positions(nodes)) {
    AxisPosition at{};
    at[index_of(nodes.axis)] = identified_position(nodes, position);
    const auto& motion = errors(at, {}).motion[index_of(nodes.axis)];
    text += isg_number(position / kRadianPerDegree, 6).substr(1);
    for (const Component component : columns)
      text += isg_number(sign * motion[index_of(component)] / isg_unit(component), 12);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string isg_chain_lines(const Machine& machine) {
  std::string letters;
  int on_workpiece_side = 0;
  for (const Joint& joint : machine.structure.joints) {
    letters += letter_of(joint.axis);
    on_workpiece_side += joint.workpiece_side ? 1 : 0;
  }
  return fmt::format("workpiece_axes {}\nchain {}\n", on_workpiece_side, letters);
}

std::vector<std::string> isg_rotary_blocks(const TableFormat& format, const FitResult& result,
                                           const TableFormatOptions& options, bool component) {
  const CompensationType type = options.type;
  if (type.has(CompensationPart::RotaryRadialAxial) != type.has(CompensationPart::RotaryAngular))
    throw InputError({}, std::string(format.name) + " holds R-RAX and R-ANG together alone",
                     "give both, or R-VOL");
  const JointErrorSource errors = rotary_errors_to_correct(result, options);
  std::vector<std::string> blocks = {tool_block(tool_of(result.machine, options))};
  const PoseErrors<double> at_home = errors(home_of(result.machine), {});
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  for (const AxisName axis : kAllAxes) {
    if (!is_rotary(axis) || !result.machine.has_axis(axis)) continue;
    const bool is_known = std::ranges::find(identified, axis) != identified.end();
    blocks.push_back(constants_block(result.machine.axis(axis), is_known ? &at_home : nullptr, type));
    if (!is_known) continue;
    const RotaryNodes nodes = rotary_nodes(result, axis, rotary_table_step(options));
    const bool workpiece = result.machine.structure.is_on_workpiece_side(axis);
    const std::string motions = motions_block(errors, nodes, type, component && workpiece ? -1.0 : 1.0);
    if (!motions.empty()) blocks.push_back(motions);
  }
  return blocks;
}

IsgChainReader::IsgChainReader(const std::string& chain, int workpiece_axes, bool component,
                               const SourcePlace& place)
    : component_(component) {
  std::string code = "w";
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const auto axis = axis_from_letter(chain[i]);
    const bool again = chain.find(chain[i]) != i;
    if (!axis || is_parallel(*axis) || letter_of(*axis) != chain[i] || again)
      throw InputError(
          place, "chain is \"" + chain.substr(0, 40) + "\"",
          "write the letters X Y Z A B C of the axes, each once, from the workpiece to the tool");
    const bool workpiece = static_cast<int>(i) < workpiece_axes;
    if (static_cast<int>(i) == workpiece_axes) code += " b";
    code += std::string(" ") + chain[i] + (workpiece ? "'" : "");
    Axis described;
    described.name = *axis;
    machine_.axes.push_back(described);
  }
  if (static_cast<int>(chain.size()) <= workpiece_axes) code += " b";
  machine_.structure = Structure::parse(code + " t", place.file, place.line);
}

bool IsgChainReader::is_on_workpiece_side(AxisName axis) const {
  return machine_.structure.is_on_workpiece_side(axis);
}

bool IsgChainReader::opens(const TableLines& lines) {
  const auto words = words_of(lines.current());
  const auto first = words[0].size() == 1 ? axis_from_letter(words[0][0]) : std::nullopt;
  const bool constants = words[0].size() == 3;
  const bool motions = first && is_rotary(*first);
  if (!motions && (!constants || ErrorSymbol::parse(words[0]))) return false;
  argument_ = motions ? first : std::nullopt;
  if (motions && !machine_.has_axis(*first))
    lines.fail("axis " + std::string(words[0]) + " is not in the chain", "name it in chain");
  columns_.clear();
  positions_.clear();
  for (std::size_t i = motions ? 1 : 0; i < words.size(); ++i) {
    const std::string name(words[i]);
    const auto symbol = ErrorSymbol::parse(name);
    const auto axis = name.size() == 3 ? axis_from_letter(name[2]) : std::nullopt;
    const bool of_tool = name == "P0X" || name == "P0Y" || name == "P0Z";
    const bool of_axis = axis && machine_.has_axis(*axis) && is_rotary(*axis);
    const bool centre = of_axis && name[0] == 'P' && std::string_view("XYZ").find(name[1]) < 3;
    const bool location = of_axis && name[1] == '0' && std::string_view("XYZABC").find(name[0]) < 6;
    const bool right = motions ? symbol && symbol->axis == *first : of_tool || centre || location;
    if (!right || std::ranges::find(columns_, name) != columns_.end())
      lines.fail("column " + name.substr(0, 20) + " is not read here",
                 "write each once: P0X P0Y P0Z, PXC PYC PZC, X0C ... C0C without argument, EXC ... ECC "
                 "behind C");
    columns_.push_back(name);
  }
  if (columns_.empty()) lines.fail("the header names no error", "write EXC ... ECC behind C");
  values_.assign(columns_.size(), {});
  return true;
}

void IsgChainReader::set_constant(const std::string& name, double value) {
  if (name[0] == 'P' && name[1] == '0') {
    tool_[name[2] - 'X'] = value * kMetrePerMillimetre;
    return;
  }
  const AxisName axis = *axis_from_letter(name[2]);
  if (name[0] == 'P') {
    const auto described = std::ranges::find(machine_.axes, axis, &Axis::name);
    described->centre[name[1] - 'X'] = value * kMetrePerMillimetre;
    return;
  }
  const std::size_t component = index_of(*axis_from_letter(name[0]));
  locations_[index_of(axis)][component] = value * isg_unit(kAllComponents[component]);
  holds_errors_ = true;
}

void IsgChainReader::add_row(const TableLines& lines) {
  const auto words = words_of(lines.current());
  const std::size_t before = argument_ ? 1 : 0;
  if (words.size() != columns_.size() + before)
    lines.fail(
        fmt::format("the row has {} numbers, the header {} names", words.size(), columns_.size() + before),
        "complete or delete the row");
  if (!argument_ && !values_.front().empty())
    lines.fail("a second row stands under constants", "delete one of the rows");
  if (argument_) {
    const double position = lines.number(words[0], "the position") * kRadianPerDegree;
    require_ascending(positions_, position, lines.place());
    positions_.push_back(position);
  }
  for (std::size_t i = 0; i < columns_.size(); ++i)
    values_[i].push_back(lines.number(words[i + before], "the value"));
}

void IsgChainReader::close(const TableLines& lines) {
  if (values_.front().empty()) lines.fail("the block has no row", "write the tables again");
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (!argument_) {
      set_constant(columns_[i], values_[i].front());
      continue;
    }
    const ErrorSymbol symbol = *ErrorSymbol::parse(columns_[i]);
    const double sign = component_ && is_on_workpiece_side(symbol.axis) ? -1.0 : 1.0;
    AxisTable table{.input = *argument_, .position = positions_, .forward = {}, .backward = {}};
    for (const double value : values_[i]) table.forward.push_back(sign * value * isg_unit(symbol.component));
    table.backward = table.forward;
    const double length = positions_.back() - positions_.front();
    if (std::abs(length - kIsgTurn * kRadianPerDegree) < 1e-9) table.beyond = BeyondEnds::Repeat;
    if (!motions_[symbol.axis].emplace(symbol.component, std::move(table)).second)
      lines.fail(columns_[i] + " is given twice", "delete one of the blocks");
    holds_errors_ = true;
  }
}

std::optional<CorrectionTerm> IsgChainReader::term() const {
  if (!holds_errors_) return std::nullopt;
  FiveAxisSettings settings;
  settings.tool_offset = tool_;
  settings.turns_axes = false;
  const FiveAxisCompensation compensation(
      machine_, settings,
      [motions = motions_, locations = locations_](const AxisPosition& position,
                                                   const ApproachDirection& direction) {
        PoseErrors<double> errors;
        for (const auto& [axis, tables] : motions) {
          for (const auto& [component, table] : tables)
            errors.motion[index_of(axis)][index_of(component)] = table.value(position, direction);
        }
        for (const AxisName axis : kAllAxes) {
          if (is_rotary(axis)) errors.location[index_of(axis)] = locations[index_of(axis)];
        }
        return errors;
      });
  return [compensation](const AxisPosition& position, const ApproachDirection& direction) {
    return compensation.correction(position, direction);
  };
}

}  // namespace volcal
