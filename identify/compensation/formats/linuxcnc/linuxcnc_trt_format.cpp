#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/formats/linuxcnc/linuxcnc_units.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/errors/rotary/identified_lines.h"
#include "volcal/model/description/errors.h"

namespace volcal {

const TableFormat& linuxcnc_format();

namespace {

constexpr std::string_view kTrtFile = "pivots.hal";
constexpr double kAlongSpindle = 1e-6;  // m, of a tool's offset to the side
const std::string kTrtRewrite = "write the tables again";

/// Pivots of xyzac-trt-kins (xyzbc: Y becomes X), m: the axis of C at `rot_point`, that of A at `offset` from
/// it. Of the three coordinates of an axis the one along it means nothing.
struct TrtPivots {
  Eigen::Vector3d rot_point = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// The module of LinuxCNC that this machine runs under.
struct TrtModule {
  AxisName tilt = AxisName::A;  ///< A or B, which carries C

  std::string name() const { return tilt == AxisName::A ? "xyzac-trt-kins" : "xyzbc-trt-kins"; }
  /// Coordinate of the pin of the offset across the tilting axis, beside z: 1 of A, 0 of B.
  int across() const { return tilt == AxisName::A ? 1 : 0; }
  std::array<std::string, 5> pins() const {
    return {"x-rot-point", "y-rot-point", "z-rot-point", std::string(1, "xy"[across()]) + "-offset",
            "z-offset"};
  }
  std::array<double, 5> values(const TrtPivots& pivots) const {
    return {pivots.rot_point.x(), pivots.rot_point.y(), pivots.rot_point.z(), pivots.offset[across()],
            pivots.offset.z()};
  }
  TrtPivots pivots(const std::array<double, 5>& values) const {
    TrtPivots pivots;
    pivots.rot_point = {values[0], values[1], values[2]};
    pivots.offset[across()] = values[3];
    pivots.offset.z() = values[4];
    return pivots;
  }
};

/// C on A or B, both on the workpiece's side of X, Y and Z.
std::optional<TrtModule> trt_module(const Structure& structure) {
  const auto& joints = structure.joints;
  if (joints.size() != 5 || joints[0].axis != AxisName::C || !joints[1].workpiece_side) return std::nullopt;
  if (joints[1].axis != AxisName::A && joints[1].axis != AxisName::B) return std::nullopt;
  const bool linear = std::all_of(joints.begin() + 2, joints.end(),
                                  [](const Joint& joint) { return !is_rotary(joint.axis); });
  return linear ? std::optional(TrtModule{joints[1].axis}) : std::nullopt;
}

TrtModule required_trt_module(const Machine& machine) {
  const auto module = trt_module(machine.structure);
  if (!module)
    throw InputError(
        {},
        "linuxcnc-trt: xyzac-trt-kins and xyzbc-trt-kins are of a table C on a tilting A or B before "
        "X, Y and Z, " +
            machine.structure.code + " is another",
        "leave out the types of rotary axes, or give --format linuxcnc-grid");
  return *module;
}

void require_tool_along_spindle(const Tool& tool) {
  if (tool.offset.head<2>().norm() <= kAlongSpindle && tool.offset.z() <= 0.0) return;
  throw InputError(
      {}, "linuxcnc-trt: tool " + tool.name + " is not along the spindle, and the module knows a length",
      "give --tool of one that is");
}

/// As drawn, and where the average lines lie with all axes at 0.
struct TrtMachine {
  TrtModule module;
  TrtPivots nominal;
  TrtPivots actual;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();  ///< the table at machine zero, and what is clamped on it
};

TrtMachine trt_machine(const FitResult& result, const TableFormatOptions& options) {
  TrtMachine trt{required_trt_module(result.machine), {}, {}, {}};
  const Eigen::Vector3d centre_c = result.machine.axis(AxisName::C).centre;
  const Eigen::Vector3d centre_tilt = result.machine.axis(trt.module.tilt).centre;
  Eigen::Vector3d moved_tilt = Eigen::Vector3d::Zero();
  for (const IdentifiedLine& line : identified_lines(result)) {
    if (line.axis == AxisName::C) trt.moved = line.value.displacement;
    if (line.axis == trt.module.tilt) moved_tilt = line.value.displacement;
  }
  const Eigen::Vector3d at_home = displacement_at_home(result, options);
  trt.moved -= at_home;
  moved_tilt -= at_home;
  trt.nominal = {centre_c, centre_tilt - centre_c};
  trt.actual = {centre_c + trt.moved, centre_tilt + moved_tilt - centre_c - trt.moved};
  return trt;
}

std::string trt_numbers(const std::array<double, 5>& values, double unit) {
  std::string text;
  for (const double value : values) text += fmt::format(" {:.6f}", value / unit + 0.0);
  return text;
}

std::string trt_hal(const TrtMachine& trt, const Tool& tool, const std::string& units) {
  const double unit = linear_unit(units);
  const std::array<std::string, 5> pins = trt.module.pins();
  const std::array<double, 5> actual = trt.module.values(trt.actual);
  std::string text = fmt::format(
      "# {} units {}\n# nominal{}\n# table moved {:.6f} {:.6f} {:.6f}\n# tool length {:.6f}\n# Touch the "
      "work off "
      "again: it moved with the table. The pivots are the same whatever conventional-directions says.\n",
      trt.module.name(), units, trt_numbers(trt.module.values(trt.nominal), unit), trt.moved.x() / unit + 0.0,
      trt.moved.y() / unit + 0.0, trt.moved.z() / unit + 0.0, -tool.offset.z() / unit + 0.0);
  for (std::size_t i = 0; i < pins.size(); ++i)
    text += fmt::format("setp {}.{} {:.6f}\n", trt.module.name(), pins[i], actual[i] / unit + 0.0);
  return text;
}

std::vector<TableFile> write_trt(const FitResult& result, const TableFormatOptions& options) {
  std::vector<TableFile> files;
  if (!options.type.linear().empty()) files = linuxcnc_format().write(result, options);
  if (!options.type.has(CompensationPart::RotaryLocation)) return files;
  const Tool& tool = tool_of(result.machine, options);
  require_tool_along_spindle(tool);
  files.push_back(
      {std::string(kTrtFile), trt_hal(trt_machine(result, options), tool, linear_units_of(options))});
  return files;
}

// ---- What the module makes of it

/// Joints at a position of the controlled point, with T the tool's length along z:
///   joints = rot + offset + T + Rtilt (Rc (point - rot) - offset - T)
/// (trtfuncs.c). Angles are in its own sense, in which a table turns with its sign: minus ISO 841.
struct TrtKinematics {
  TrtModule module;
  TrtPivots pivots;
  double tool = 0.0;  ///< m

  static Eigen::AngleAxisd turn(int direction, double angle) {
    return {angle, Eigen::Vector3d::Unit(direction)};
  }
  Eigen::Vector3d pivot() const { return pivots.offset + tool * Eigen::Vector3d::UnitZ(); }
  Eigen::Vector3d joints(const Eigen::Vector3d& point, double tilt, double c) const {
    const Eigen::Vector3d turned = turn(2, c) * (point - pivots.rot_point) - pivot();
    return pivots.rot_point + pivot() + turn(direction_of(module.tilt), tilt) * turned;
  }
  Eigen::Vector3d point(const Eigen::Vector3d& joints, double tilt, double c) const {
    const Eigen::Vector3d upright =
        turn(direction_of(module.tilt), -tilt) * (joints - pivots.rot_point - pivot());
    return pivots.rot_point + turn(2, -c) * (upright + pivot());
  }
};

/// pivots.hal line by line.
class TrtReader {
 public:
  explicit TrtReader(const TableFile& file) : lines_(file) {}

  CorrectionTerm read() {
    while (lines_.advance_to_content()) read_line(words_of(lines_.current()));
    require_complete();
    std::array<double, 5> actual{};
    for (std::size_t i = 0; i < actual.size(); ++i) actual[i] = pins_.at(module_->pins()[i]);
    const TrtKinematics before{*module_, module_->pivots(*nominal_), *tool_};
    const TrtKinematics after{*module_, module_->pivots(actual), *tool_};
    return [before, after, moved = *moved_](const AxisPosition& position, const ApproachDirection&) {
      const double tilt = -position[index_of(before.module.tilt)], c = -position[index_of(AxisName::C)];
      const Eigen::Vector3d joints(position[0], position[1], position[2]);
      Correction correction;
      correction.linear = after.joints(before.point(joints, tilt, c) + moved, tilt, c) - joints;
      return correction;
    };
  }

 private:
  using Words = std::vector<std::string_view>;

  void read_line(const Words& words) {
    if (words[0] == "#") {
      read_comment(words);
    } else if (words[0] == "setp") {
      read_pin(words);
    } else {
      lines_.fail("the line is neither a comment nor setp", kTrtRewrite);
    }
  }

  void read_comment(const Words& words) {
    if (words.size() == 4 && words[2] == "units") {
      if (words[1] == "xyzac-trt-kins") module_ = TrtModule{AxisName::A};
      if (words[1] == "xyzbc-trt-kins") module_ = TrtModule{AxisName::B};
      unit_ = linear_unit(words[3]);
      if (!module_ || unit_ == 0.0) lines_.fail("module or unit is not known", kTrtRewrite);
    } else if (words.size() == 7 && words[1] == "nominal") {
      nominal_.emplace();
      for (std::size_t i = 0; i < 5; ++i) (*nominal_)[i] = number(words[2 + i]);
    } else if (words.size() == 6 && words[1] == "table" && words[2] == "moved") {
      moved_ = Eigen::Vector3d(number(words[3]), number(words[4]), number(words[5]));
    } else if (words.size() == 4 && words[1] == "tool" && words[2] == "length") {
      tool_ = number(words[3]);
    }
  }

  void read_pin(const Words& words) {
    const std::string prefix = module_ ? module_->name() + "." : "";
    if (words.size() != 3 || prefix.empty() || !words[1].starts_with(prefix))
      lines_.fail("the line sets no pin of the module that the first line names", kTrtRewrite);
    const std::string pin(words[1].substr(prefix.size()));
    const auto known = module_->pins();
    if (std::ranges::find(known, pin) == known.end())
      lines_.fail("pin " + pin.substr(0, 20) + " is not a pivot", kTrtRewrite);
    if (!pins_.emplace(pin, number(words[2])).second)
      lines_.fail("the pin is set twice", "delete one of them");
  }

  double number(std::string_view word) const {
    if (unit_ == 0.0) lines_.fail("module and unit are missing", kTrtRewrite);
    return lines_.number(word, "the value") * unit_;
  }

  void require_complete() const {
    if (!module_ || !nominal_ || !moved_ || !tool_) lines_.fail("a comment line is missing", kTrtRewrite);
    if (pins_.size() != module_->pins().size()) lines_.fail("a pin is missing", kTrtRewrite);
  }

  TableLines lines_;
  std::optional<TrtModule> module_;
  double unit_ = 0.0;  ///< m
  std::optional<std::array<double, 5>> nominal_;
  std::optional<Eigen::Vector3d> moved_;
  std::optional<double> tool_;
  std::map<std::string, double> pins_;
};

CompensationTables read_trt(std::span<const TableFile> files) {
  CompensationTables tables;
  std::vector<TableFile> of_joints;
  for (const TableFile& file : files) {
    if (file.name == kTrtFile) {
      tables.terms.push_back(TrtReader(file).read());
    } else {
      of_joints.push_back(file);
    }
  }
  if (of_joints.empty() && !tables.terms.empty()) return tables;
  CompensationTables linear = linuxcnc_format().read(of_joints);
  std::ranges::move(linear.terms, std::back_inserter(tables.terms));
  return tables;
}

}  // namespace

const TableFormat& linuxcnc_trt_format() {
  static const TableFormat format = {
      .name = "linuxcnc-trt",
      .summary =
          "LinuxCNC with xyzac-trt-kins or xyzbc-trt-kins: the pivots of table and cradle as lines of a HAL "
          "file, "
          "and screw compensation as linuxcnc writes it",
      .source =
          "LinuxCNC, src/emc/kinematics/trtfuncs.c: pins x-rot-point, y-rot-point, z-rot-point, y-offset "
          "(xyzac) or "
          "x-offset (xyzbc), z-offset, and the equations of the joints",
      .verified =
          "against the equations of its source, by its own reader; not by LinuxCNC in simulation, not on a "
          "machine",
      .supported = CompensationPart::Positioning,
      .rotary = CompensationPart::RotaryLocation,
      .refusal =
          "pivots hold where the lines of the rotary axes pass; their tilts, error motions and errors of "
          "other axes "
          "take the module of linuxcnc-grid",
      .limits = {.points_per_table = 256, .resolution = 1e-9, .both_directions = true},
      .settings = kLinuxCncSettings,
      .write = write_trt,
      .read = read_trt};
  return format;
}

}  // namespace volcal
