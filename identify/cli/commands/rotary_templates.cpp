#include "volcal/identify/cli/commands/rotary_templates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "volcal/sim/measurement/measurements.h"

namespace volcal::cli {
namespace {

struct TemplateSphere {
  const char* name;
  std::array<double, 3> position_mm;
};

using TemplateSpheres = std::array<TemplateSphere, 3>;

constexpr TemplateSpheres kSpheresOfATurningTable = {
    {{"S1", {120.0, 0.0, -370.0}}, {"S2", {-60.0, 100.0, -350.0}}, {"S3", {-60.0, -100.0, -330.0}}}};
constexpr TemplateSpheres kSpheresOfAFixedTable = {
    {{"S1", {150.0, 0.0, -400.0}}, {"S2", {-100.0, 150.0, -350.0}}, {"S3", {-100.0, -150.0, -450.0}}}};
constexpr std::array<const char*, 3> kTemplateTools = {"short", "long", "side"};

bool has_axis(const Structure& structure, AxisName axis) {
  return std::ranges::find(structure.joints, axis, &Joint::axis) != structure.joints.end();
}

bool has_rotary_axes(const Structure& structure, bool workpiece_side) {
  return std::ranges::any_of(structure.joints, [&](const Joint& joint) {
    return is_rotary(joint.axis) && joint.workpiece_side == workpiece_side;
  });
}

bool is_on_workpiece_side(const Structure& structure, AxisName axis) {
  return std::ranges::find(structure.joints, axis, &Joint::axis)->workpiece_side;
}

const TemplateSpheres& spheres_of(const Structure& structure) {
  return has_rotary_axes(structure, true) ? kSpheresOfATurningTable : kSpheresOfAFixedTable;
}

std::string vector_text(const std::array<double, 3>& v) {
  return fmt::format("[{:.1f}, {:.1f}, {:.1f}]", v[0], v[1], v[2]);
}

std::string rotary_letters(const Structure& structure) {
  std::string letters;
  for (const AxisName axis : kAllAxes) {
    if (!is_rotary(axis) || !has_axis(structure, axis)) continue;
    letters += (letters.empty() ? "" : " and ") + std::string(1, letter_of(axis));
  }
  return letters;
}

/// positions = { A = 9, C = 12 }
std::string positions_table(const Structure& structure) {
  std::string inside;
  for (const AxisName axis : kAllAxes) {
    if (!is_rotary(axis) || !has_axis(structure, axis)) continue;
    inside +=
        fmt::format("{}{} = {}", inside.empty() ? "" : ", ", letter_of(axis), axis == AxisName::C ? 12 : 9);
  }
  return "{ " + inside + " }";
}

std::string commented_head(const std::string& name, const std::string& instrument, const std::string& columns,
                           const std::string& tool) {
  return fmt::format(
      "#[[setups]]\n#name = \"{0}\"\n#instrument = \"{1}\"\n#data = \"{0}.csv\"  # columns: {2}\n#tool = "
      "\"{3}\"\n",
      name, instrument, columns, tool);
}

}  // namespace

bool has_rotary_axes(const Structure& structure) {
  return has_rotary_axes(structure, true) || has_rotary_axes(structure, false);
}

std::string axis_table_beside_rotary(AxisName axis, const Structure& structure) {
  const bool head = has_rotary_axes(structure, false);
  if (is_rotary(axis)) {
    const bool table = is_on_workpiece_side(structure, axis);
    return fmt::format(
        "[axes.{}]\ntravel_deg = [{}]\nhome_deg = 0.0\ncentre_mm = [0.0, 0.0, {}]  # a point of the axis "
        "line, all axes at 0{}\n",
        letter_of(axis), axis == AxisName::C ? "-180.0, 180.0" : "-90.0, 90.0", table ? "-400.0" : "150.0",
        table ? "" : ": above the spindle's nose");
  }
  const std::string travel = axis == AxisName::Z ? (head ? "-700.0, 0.0" : "-500.0, 0.0")
                                                 : (head ? "-600.0, 600.0" : "-300.0, 300.0");
  return fmt::format(
      "[axes.{}]\ntravel_mm = [{}]\nhome_mm = 0.0\nreference_point_mm = [0.0, 0.0, 0.0]  # where the "
      "scale reads, all axes at 0\n",
      letter_of(axis), travel);
}

std::string rotary_tools() {
  return "[tools.short]\noffset_mm = [0.0, 0.0, -150.0]  # functional point from the spindle's reference "
         "point\n"
         "[tools.long]  # two lengths tell tilts of a rotary axis from displacements\n"
         "offset_mm = [0.0, 0.0, -250.0]\n"
         "[tools.side]  # a lateral offset makes the rolls of the last axis visible\n"
         "offset_mm = [80.0, 0.0, -200.0]\n";
}

std::vector<std::string> rotary_instruments() { return {sim::kRTest, sim::kProbedSphere}; }

std::string rotary_setups(const Structure& structure, const std::string& positions) {
  const std::string letters = rotary_letters(structure);
  const bool two = letters.size() > 1;
  std::string text = fmt::format(
      "\n# Rotary axes. Three spheres on the table, on no line, each with two tools of different length and "
      "one with a\n"
      "# lateral offset. At every sphere {}, the linear axes following (tool centre point control):\n"
      "# {}. volcal simulate study.toml -o poses writes the positions to\n"
      "# be programmed; leave out the poses that your machine does not reach.\n"
      "# reading: tool point relative to the workpiece less its nominal place, plus the sphere's offset, in "
      "the "
      "axes of `frame`\n",
      two ? "every combination of " + letters : "every position of " + letters,
      two ? "one axis alone leaves most of the location errors invisible"
          : "a whole turn of positions tells the axis from its errors");
  for (const TemplateSphere& sphere : spheres_of(structure)) {
    for (const char* tool : kTemplateTools) {
      text += commented_head(fmt::format("rtest_{}_{}", sphere.name, tool), sim::kRTest,
                             positions + ",dx_um,dy_um,dz_um", tool);
      text += fmt::format(
          "#sphere = \"{}\"  # setups that name one sphere share where it is\n#frame = \"workpiece\"  # axes "
          "of "
          "the readings; or tool, machine\n#noise = {{ constant_um = 0.5 }}\n\n",
          sphere.name);
    }
  }
  text +=
      "# The same with a touch probe: the centres that the control records, or, better, every contact with "
      "its "
      "direction.\n"
      "# reading: centre less the machine's error there, or n.(tip + error) = n.centre + radius, n out of "
      "the "
      "sphere\n";
  text += commented_head("probe_P1_short", sim::kProbedSphere, positions + ",cx_mm,cy_mm,cz_mm", "short") +
          "#sphere = \"P1\"  # place and session: a new name whenever the sphere was moved\n"
          "#noise = { constant_um = 1.0 }\n\n";
  text += commented_head("probe_P1_short_U", sim::kProbedSphere,
                         positions + ",tip_x_mm,tip_y_mm,tip_z_mm,n_x,n_y,n_z", "short") +
          "#sphere = \"P1\"\n"
          "#contact = \"U\"  # kind of contact: setups of one kind share the radius\n"
          "#radius_mm = 18.0  # sphere and ball, nominal\n"
          "#radius_sigma_um = 5.0  # 0: calibrated; left out: free\n"
          "#noise = { constant_um = 1.0 }\n\n"
          "# Linear axes, and rotary axes by other instruments:\n";
  return text;
}

std::string rotary_study(const Structure& structure) {
  for (const AxisName axis : kLinearAxes) {
    if (!has_axis(structure, axis)) return "";
  }
  std::string spheres;
  for (const TemplateSphere& sphere : spheres_of(structure)) {
    spheres += fmt::format("[[measurements.spheres]]\nname = \"{}\"\nposition_mm = {}\n", sphere.name,
                           vector_text(sphere.position_mm));
  }
  return fmt::format(
      "# A rehearsal: volcal simulate study.toml -o rehearsal measures this on a machine with random "
      "errors.\n"
      "# Its CSV files have the positions to be programmed.\n"
      "format = \"volcal-study-1\"\n"
      "machine = \"machine.toml\"\n"
      "seed = 1\n"
      "[truth]\n"
      "volumetric_rms_um = [4.0, 6.0]  # of the linear axes; rotary axes: 15 um and 40 urad of location, 3 "
      "um "
      "and 15 urad of motion\n"
      "\n"
      "[[measurements]]  # linear axes, rotary axes at home\n"
      "kind = \"{}\"\n"
      "grid = [6, 5, 4]\n"
      "\n"
      "[[measurements]]  # rotary axes, linear axes following\n"
      "kind = \"{}\"\n"
      "tools = [\"short\", \"long\", \"side\"]  # two lengths and a lateral offset\n"
      "positions = {}\n"
      "poses = \"grid\"  # every combination; \"singly\": one axis after another, which sees far less\n"
      "noise = {{ constant_um = 0.5, repeatability_um = 0.5 }}\n"
      "{}",
      sim::kLaserTracer, sim::kRTest, positions_table(structure), spheres);
}

}  // namespace volcal::cli
