#include "volcal/model/description/machine.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>
#include <span>
#include <stdexcept>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr double kTurnOfTravel = 2.0 * std::numbers::pi - 1e-6;  // rad

class StructureReader {
 public:
  StructureReader(const std::string& code, SourcePlace place) : code_(code), place_(std::move(place)) {}

  Structure read() {
    Structure structure{code_, {}};
    for (std::size_t i = 0; i < code_.size(); ++i) {
      const char c = code_[i];
      if (std::isspace(static_cast<unsigned char>(c))) continue;
      if (c == '(') {
        i = skip_spindle(i);
      } else if (c == '\'') {
        if (seen_bed_ || structure.joints.empty()) fail("a prime marks an axis between w and b");
      } else {
        letter(c, structure);
      }
    }
    if (!seen_tool_) fail("the code must end with t (tool)");
    if (structure.joints.empty()) fail("the code names no axis");
    for (const Joint& joint : structure.joints) check_parallel(joint.axis, structure);
    return structure;
  }

 private:
  void letter(char c, Structure& structure) {
    if (seen_tool_) fail("nothing may follow t");
    if (c == 'w') {
      if (seen_workpiece_) fail("w appears twice");
      seen_workpiece_ = true;
      return;
    }
    if (!seen_workpiece_) fail("the code must start with w (workpiece)");
    if (c == 'b') {
      if (seen_bed_) fail("b appears twice");
      seen_bed_ = true;
    } else if (c == 't') {
      if (!seen_bed_) fail("b (bed) is missing");
      seen_tool_ = true;
    } else {
      const auto axis = axis_from_letter(c);
      if (static_cast<unsigned char>(c) >= 0x80)
        fail("a character is not ASCII; the prime is the apostrophe '");
      if (!axis) fail(std::string("'") + c + "' is not one of w b t X Y Z A B C U V W");
      const auto same = [&](const Joint& joint) { return joint.axis == *axis; };
      if (std::ranges::any_of(structure.joints, same)) fail(std::string("axis ") + c + " appears twice");
      structure.joints.push_back({*axis, !seen_bed_});
    }
  }

  /// Of two linear axes with one direction the first is X, Y or Z.
  void check_parallel(AxisName axis, const Structure& structure) const {
    const char main = letter_of(main_axis_of(axis));
    const auto is_main = [&](const Joint& joint) { return letter_of(joint.axis) == main; };
    if (!is_parallel(axis) || std::ranges::any_of(structure.joints, is_main)) return;
    throw InputError(place_,
                     "structure \"" + code_ + "\": axis " + letter_of(axis) + " is parallel to " + main +
                         ", which the structure has not",
                     std::string("name the axis ") + main + ": U, V, W stand beside X, Y, Z (ISO 841)");
  }

  std::size_t skip_spindle(std::size_t open) {
    const auto close = code_.find(')', open);
    if (close == std::string::npos) fail("a bracket is not closed");
    const std::string inside = code_.substr(open + 1, close - open - 1);
    if (inside.size() != 1 || !axis_from_letter(inside[0])) fail("brackets hold one spindle axis, as in (C)");
    return close;
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(place_, "structure \"" + code_ + "\": " + why,
                     "write it workpiece to tool, as in \"w X' b Y Z t\"");
  }

  const std::string& code_;
  SourcePlace place_;
  bool seen_workpiece_ = false;
  bool seen_bed_ = false;
  bool seen_tool_ = false;
};

std::vector<AxisName> axes_among(std::span<const AxisName> names, const Machine& machine) {
  std::vector<AxisName> found;
  for (const AxisName name : names) {
    if (machine.has_axis(name)) found.push_back(name);
  }
  return found;
}

}  // namespace

Structure Structure::parse(const std::string& code, const std::string& file, int line) {
  return StructureReader(code, {file, line}).read();
}

bool Structure::has_axis(AxisName axis) const {
  return std::ranges::find(joints, axis, &Joint::axis) != joints.end();
}

bool Structure::is_on_workpiece_side(AxisName axis) const {
  const auto joint = std::ranges::find(joints, axis, &Joint::axis);
  return joint != joints.end() && joint->workpiece_side;
}

AxisName Datum::third() const {
  for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
    if (axis != primary && axis != secondary) return axis;
  }
  return AxisName::Z;
}

std::array<LocationSymbol, 3> Datum::squareness() const {
  const auto rotation_about = [](AxisName axis) { return kAllComponents[3 + index_of(axis)]; };
  return {{{rotation_about(third()), secondary},
           {rotation_about(primary), third()},
           {rotation_about(secondary), third()}}};
}

bool Axis::travels_a_turn() const { return is_rotary(name) && travel() > kTurnOfTravel; }

bool Machine::is_endless(AxisName wanted) const {
  const Axis& own = axis(wanted);
  return own.travels_a_turn() && own.endless.value_or(structure.is_on_workpiece_side(wanted));
}

const Axis& Machine::axis(AxisName wanted) const {
  for (const Axis& axis : axes) {
    if (axis.name == wanted) return axis;
  }
  throw std::out_of_range(std::string("machine has no axis ") + letter_of(wanted));
}

bool Machine::has_axis(AxisName wanted) const {
  return std::ranges::any_of(axes, [&](const Axis& axis) { return axis.name == wanted; });
}

std::vector<AxisName> Machine::main_linear_axes() const { return axes_among(kLinearAxes, *this); }

std::vector<AxisName> Machine::parallel_axes() const { return axes_among(kParallelAxes, *this); }

std::vector<AxisName> Machine::linear_axes() const {
  std::vector<AxisName> found = main_linear_axes();
  for (const AxisName axis : parallel_axes()) found.push_back(axis);
  return found;
}

std::vector<AxisName> Machine::rotary_axes() const {
  std::vector<AxisName> found;
  for (const Axis& axis : axes) {
    if (is_rotary(axis.name)) found.push_back(axis.name);
  }
  return found;
}

std::vector<Tool> Machine::functional_tools() const { return tools.empty() ? std::vector{Tool{}} : tools; }

std::optional<std::size_t> Machine::tool_index(const std::string& wanted) const {
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (tools[i].name == wanted) return i;
  }
  return std::nullopt;
}

}  // namespace volcal
