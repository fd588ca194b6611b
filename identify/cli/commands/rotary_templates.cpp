#include "volcal/identify/cli/commands/rotary_templates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

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
/// In the plane of X and Z, of machines that have two linear axes.
constexpr TemplateSpheres kSpheresOfATurningTableInPlane = {
    {{"S1", {120.0, 0.0, -370.0}}, {"S2", {-60.0, 0.0, -330.0}}, {"S3", {-60.0, 0.0, -450.0}}}};
constexpr TemplateSpheres kSpheresOfAFixedTableInPlane = {
    {{"S1", {150.0, 0.0, -400.0}}, {"S2", {-100.0, 0.0, -350.0}}, {"S3", {-50.0, 0.0, -480.0}}}};
constexpr std::array<const char*, 3> kTemplateTools = {"short", "long", "side"};

bool has_rotary_axes(const Structure& structure, bool workpiece_side) {
  return std::ranges::any_of(structure.joints, [&](const Joint& joint) {
    return is_rotary(joint.axis) && joint.workpiece_side == workpiece_side;
  });
}

std::string vector_text(const std::array<double, 3>& v) {
  return fmt::format("[{:.1f}, {:.1f}, {:.1f}]", v[0], v[1], v[2]);
}

std::vector<AxisName> rotary_axes(const Structure& structure) {
  std::vector<AxisName> axes;
  for (const AxisName axis : kAllAxes) {
    if (is_rotary(axis) && structure.has_axis(axis)) axes.push_back(axis);
  }
  return axes;
}

bool contains(const std::vector<AxisName>& axes, AxisName axis) {
  return std::ranges::find(axes, axis) != axes.end();
}

std::string rotary_letters(const Structure& structure) {
  std::string letters;
  for (const AxisName axis : rotary_axes(structure))
    letters += (letters.empty() ? "" : " and ") + std::string(1, letter_of(axis));
  return letters;
}

std::vector<AxisName> missing_linear_axes(const Structure& structure) {
  std::vector<AxisName> missing;
  for (const AxisName axis : kLinearAxes) {
    if (!structure.has_axis(axis)) missing.push_back(axis);
  }
  return missing;
}

/// Two linear axes keep a tool point on a sphere where a rotary axis turns about the normal of their plane.
/// Tools of different length reach one sphere where Z is one of the two.
bool is_followed(const Structure& structure, AxisName axis) {
  const std::vector<AxisName> missing = missing_linear_axes(structure);
  if (missing.empty()) return true;
  return missing.size() == 1 && missing.front() != AxisName::Z &&
         direction_of(axis) == direction_of(missing.front());
}

/// Rotary axes that are tested alone.
std::vector<AxisName> axes_alone(const Structure& structure) {
  std::vector<AxisName> alone = rotary_axes(structure);
  std::erase_if(alone, [&](AxisName axis) { return is_followed(structure, axis); });
  return alone;
}

TemplateSpheres spheres_of(const Structure& structure) {
  const bool turning = has_rotary_axes(structure, true);
  if (missing_linear_axes(structure).empty())
    return turning ? kSpheresOfATurningTable : kSpheresOfAFixedTable;
  TemplateSpheres spheres = turning ? kSpheresOfATurningTableInPlane : kSpheresOfAFixedTableInPlane;
  for (TemplateSphere& sphere : spheres) {
    if (!structure.has_axis(AxisName::X)) std::swap(sphere.position_mm[0], sphere.position_mm[1]);
  }
  return spheres;
}

/// A tool comes onto the line of a table, and of a head that turns about the tool.
bool has_line_within_reach(const Structure& structure, AxisName axis) {
  return structure.is_on_workpiece_side(axis) || axis == AxisName::C;
}

std::string listed(const std::vector<AxisName>& axes) {
  std::string text;
  for (const AxisName axis : axes) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", letter_of(axis));
  return "[" + text + "]";
}

/// How many positions of each axis make every combination of them a day's work, and how far they are moved
/// off a grid, as a share of its step: where these are few, as far as the whole travel is met.
struct TemplateGrid {
  int of_c, of_others;
  double jitter;
};

TemplateGrid grid_of(std::size_t turning) {
  if (turning <= 1) return {24, 17, 0.3};
  return turning == 2 ? TemplateGrid{12, 9, 0.3} : TemplateGrid{8, 4, 0.5};
}

/// positions = { A = 9, C = 12 }; one of an axis that stands.
std::string positions_table(const Structure& structure, const std::vector<AxisName>& standing = {}) {
  std::string inside;
  const TemplateGrid grid = grid_of(rotary_axes(structure).size() - standing.size());
  for (const AxisName axis : rotary_axes(structure)) {
    const int count = contains(standing, axis) ? 1 : axis == AxisName::C ? grid.of_c : grid.of_others;
    inside += fmt::format("{}{} = {}", inside.empty() ? "" : ", ", letter_of(axis), count);
  }
  return "{ " + inside + " }";
}

/// The first registered instrument that has a trait.
const InstrumentSchema& schema_with(bool (*trait)(const InstrumentTraits& traits)) {
  for (const Instrument* instrument : instruments()) {
    if (trait(instrument->schema().traits)) return instrument->schema();
  }
  throw std::logic_error("no registered instrument has what a template asks for");
}

bool tracks_distances(const InstrumentTraits& traits) {
  return traits.laser_length == LaserLength::Distance && traits.encoders.empty();
}

bool stays_on_sphere(const InstrumentTraits& traits) {
  return traits.sphere_reading == SphereReading::Displacement;
}

bool finds_sphere(const InstrumentTraits& traits) { return traits.sphere_reading == SphereReading::Place; }

bool reads_rotation(const InstrumentTraits& traits) { return traits.line_reading == LineReading::Rotation; }

/// Column set whose readings rest on given columns: contacts with their directions.
std::size_t set_of_contacts(const InstrumentSchema& schema) {
  std::size_t set = 0;
  while (set + 1 < schema.column_sets.size() && schema.given_of(set).empty()) ++set;
  return set;
}

std::string commented_head(const std::string& name, const InstrumentSchema& schema, std::size_t column_set,
                           const std::string& positions, const std::string& tool) {
  std::string columns = positions;
  for (const ColumnSchema& column : schema.file_columns(column_set)) columns += "," + column.column;
  return fmt::format(
      "#[[setups]]\n#name = \"{0}\"\n#instrument = \"{1}\"\n#data = \"{0}.csv\"  # columns: {2}\n#tool = "
      "\"{3}\"\n",
      name, schema.name, columns, tool);
}

/// "#radius_mm = 18.0  # nominal", of the schema's key that starts so.
std::string commented_key(const InstrumentSchema& schema, std::string_view stem, const std::string& value,
                          const std::string& comment = "") {
  const auto key =
      std::ranges::find_if(schema.keys, [&](const KeySchema& each) { return stem_of_key(each.key) == stem; });
  if (key == schema.keys.end())
    throw std::logic_error(schema.name + " has no key " + std::string(stem) + " for a template");
  return fmt::format("#{} = {}{}\n", key->key, value, comment.empty() ? "" : "  # " + comment);
}

std::string commented_noise(const InstrumentSchema& schema, const std::string& value) {
  return fmt::format("#noise = {{ {} = {} }}\n\n", schema.noise_keys.front().key, value);
}

/// Setups of a touch probe.
std::string probe_setups(const std::string& positions) {
  const InstrumentSchema& probe = schema_with(finds_sphere);
  return "# The same with a touch probe: the centres that the control records, or, better, every contact "
         "with "
         "its direction.\n"
         "# reading: centre less the machine's error there, or n.(tip + error) = n.centre + radius, n out of "
         "the sphere\n" +
         commented_head("probe_P1_short", probe, 0, positions, "short") +
         commented_key(probe, "sphere", "\"P1\"",
                       "place and session: a new name whenever the sphere was moved") +
         commented_noise(probe, "1.0") +
         commented_head("probe_P1_short_U", probe, set_of_contacts(probe), positions, "short") +
         commented_key(probe, "sphere", "\"P1\"") +
         commented_key(probe, "contact", "\"U\"", "kind of contact: setups of one kind share the radius") +
         commented_key(probe, "radius", "18.0", "sphere and ball, nominal") +
         commented_key(probe, "radius_sigma", "5.0", "0: calibrated; left out: free") +
         commented_noise(probe, "1.0");
}

/// Setups with spheres that the tool point stays on.
std::string sphere_setups(const Structure& structure, const std::string& positions) {
  const InstrumentSchema& schema = schema_with(stays_on_sphere);
  std::string text;
  for (const TemplateSphere& sphere : spheres_of(structure)) {
    for (const char* tool : kTemplateTools)
      text += commented_head(fmt::format("rtest_{}_{}", sphere.name, tool), schema, 0, positions, tool) +
              commented_key(schema, "sphere", fmt::format("\"{}\"", sphere.name),
                            "setups that name one sphere share where it is") +
              commented_key(schema, "frame", "\"workpiece\"", "axes of the readings; or tool, machine") +
              commented_noise(schema, "0.5");
  }
  return text + probe_setups(positions);
}

/// Setups of one axis that turns alone.
std::string setups_alone(const Structure& structure, AxisName axis, const std::string& positions) {
  const char letter = letter_of(axis);
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(direction_of(axis));
  std::string text = fmt::format(
      "# Axis {0}, which turns alone: two linear axes cannot keep the tool point on a sphere away from its "
      "line.\n"
      "# reading: angle of the axis about itself, actual less commanded (ISO 230-2)\n",
      letter);
  const InstrumentSchema& angle = schema_with(reads_rotation);
  text += commented_head(fmt::format("angle_{}", letter), angle, 0, positions, "short") +
          commented_key(angle, "axis", vector_text({along.x(), along.y(), along.z()})) +
          commented_noise(angle, "0.5");
  if (!has_line_within_reach(structure, axis)) return text;
  const InstrumentSchema& sphere = schema_with(stays_on_sphere);
  text += "# reading: displacement of a sphere on the line of the axis (ISO 230-7); two heights tell tilts\n";
  for (const char* height : {"low", "high"})
    text += commented_head(fmt::format("rotation_{}_{}", letter, height), sphere, 0, positions, "short") +
            commented_key(sphere, "sphere", fmt::format("\"{}_{}\"", letter, height)) +
            commented_key(sphere, "frame", "\"workpiece\"") + commented_noise(sphere, "0.3");
  return text;
}

std::string spheres_introduced(const Structure& structure) {
  const std::string letters = rotary_letters(structure);
  const bool two = letters.size() > 1;
  return fmt::format(
      "\n# Rotary axes. Three spheres on the table, not on one line, each with two tools of different length "
      "and "
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
}

/// Two tools, which tell tilts, and two places on the line of a table along which a linear axis goes.
std::string rotation_measurement(const Structure& structure, AxisName axis) {
  const AxisName along = kLinearAxes[static_cast<std::size_t>(direction_of(axis))];
  const bool moves_along = structure.is_on_workpiece_side(axis) && structure.has_axis(along);
  return fmt::format(
      "\n[[measurements]]  # axis of rotation, spheres at two places on its line (ISO 230-7)\n"
      "kind = \"axis-of-rotation\"\n"
      "axes = [\"{}\"]\n"
      "tools = [\"short\", \"long\"]\n"
      "{}"
      "points = 36\n",
      letter_of(axis), moves_along ? "heights_mm = [0.0, 100.0]  # from centre_mm along the line\n" : "");
}

/// Where a linear axis is missing: lengths to points of a plane leave its shape open, angles and a square of
/// the two others do not.
std::string plane_measurements(const Structure& structure) {
  if (missing_linear_axes(structure).empty()) return "";
  return "\n[[measurements]]  # angles of the linear axes\n"
         "kind = \"angle-lines\"\n"
         "points = 11\n"
         "\n[[measurements]]  # their squareness and straightness: lengths in one plane leave both open\n"
         "kind = \"squares\"\n"
         "points = 11\n";
}

/// Measurements of the rotary axes for a study file.
std::string rotary_measurements(const Structure& structure) {
  const std::vector<AxisName> alone = axes_alone(structure);
  std::string text;
  if (alone.size() < rotary_axes(structure).size()) {
    text += fmt::format(
        "\n[[measurements]]  # rotary axes, linear axes following\n"
        "kind = \"{}\"\n"
        "tools = [\"short\", \"long\", \"side\"]  # two lengths and a lateral offset\n"
        "positions = {}\n"
        "poses = \"grid\"  # every combination; \"singly\": one axis after another, which sees far less\n"
        "jitter = {:.1f}  # of a step: regular positions take high harmonics for low ones\n"
        "noise = {{ constant_um = 0.5, repeatability_um = 0.5 }}\n",
        schema_with(stays_on_sphere).name, positions_table(structure, alone),
        grid_of(rotary_axes(structure).size() - alone.size()).jitter);
    for (const TemplateSphere& sphere : spheres_of(structure))
      text += fmt::format("[[measurements.spheres]]\nname = \"{}\"\nposition_mm = {}\n", sphere.name,
                          vector_text(sphere.position_mm));
  }
  if (alone.empty()) return text;
  text += fmt::format(
      "\n[[measurements]]  # angular positioning, one axis after another (ISO 230-2)\n"
      "kind = \"angle-lines\"\n"
      "axes = {}\n"
      "points = 25\n"
      "runs = 2\n",
      listed(alone));
  for (const AxisName axis : alone) {
    if (has_line_within_reach(structure, axis)) text += rotation_measurement(structure, axis);
  }
  return text;
}

/// An axis on the tool's side that turns a slide, as a column on a turntable.
bool carries_linear_axes(const Structure& structure, AxisName axis) {
  const auto own = std::ranges::find(structure.joints, axis, &Joint::axis);
  return std::any_of(own, structure.joints.end(), [](const Joint& joint) { return !is_rotary(joint.axis); });
}

}  // namespace

bool has_rotary_axes(const Structure& structure) {
  return has_rotary_axes(structure, true) || has_rotary_axes(structure, false);
}

std::string axis_table_beside_rotary(AxisName axis, const Structure& structure) {
  const bool head = has_rotary_axes(structure, false);
  if (is_rotary(axis)) {
    const bool nose = !structure.is_on_workpiece_side(axis) && !carries_linear_axes(structure, axis);
    return fmt::format(
        "[axes.{}]\ntravel_deg = [{}]\nhome_deg = 0.0\ncentre_mm = [0.0, 0.0, {}]  # a point of the axis "
        "line, all axes at 0{}\n",
        letter_of(axis), axis == AxisName::C ? "-180.0, 180.0" : "-90.0, 90.0", nose ? "150.0" : "-400.0",
        nose ? ": above the spindle's nose" : "");
  }
  const std::string travel = axis == AxisName::Z ? (head ? "-700.0, 0.0" : "-500.0, 0.0")
                                                 : (head ? "-600.0, 600.0" : "-300.0, 300.0");
  return fmt::format(
      "[axes.{}]\ntravel_mm = [{}]\nhome_mm = 0.0\nreference_point_mm = [0.0, 0.0, 0.0]  # where the "
      "scale reads, all axes at 0\n",
      letter_of(axis), travel);
}

std::string rotary_tools(const Structure& structure) {
  return fmt::format(
      "[tools.short]\noffset_mm = [0.0, 0.0, -150.0]  # functional point from the spindle's reference "
      "point\n"
      "[tools.long]  # two lengths tell tilts of a rotary axis from displacements\n"
      "offset_mm = [0.0, 0.0, -250.0]\n"
      "[tools.side]  # a lateral offset makes the rolls of the last axis visible\n"
      "offset_mm = {}\n",
      structure.has_axis(AxisName::X) ? "[80.0, 0.0, -200.0]" : "[0.0, 80.0, -200.0]");
}

std::vector<std::string> rotary_instruments(const Structure& structure) {
  const std::string& stays = schema_with(stays_on_sphere).name;
  if (axes_alone(structure).size() == rotary_axes(structure).size()) return {stays};
  return {stays, schema_with(finds_sphere).name};
}

std::string rotary_setups(const Structure& structure, const std::string& positions) {
  const std::vector<AxisName> alone = axes_alone(structure);
  std::string text;
  if (alone.size() < rotary_axes(structure).size())
    text += spheres_introduced(structure) + sphere_setups(structure, positions);
  if (!alone.empty()) text += "\n";
  for (const AxisName axis : alone) text += setups_alone(structure, axis, positions);
  return text + "# Linear axes, and rotary axes by other instruments:\n";
}

std::string rotary_study(const Structure& structure) {
  if (missing_linear_axes(structure).size() > 1) return "";
  return fmt::format(
             "# A rehearsal: volcal simulate study.toml -o rehearsal measures this on a machine with random "
             "errors.\n"
             "# Its CSV files have the positions to be programmed.\n"
             "format = \"volcal-study-1\"\n"
             "machine = \"machine.toml\"\n"
             "seed = 1\n"
             "[truth]\n"
             "volumetric_rms_um = [4.0, 6.0]  # of the linear axes; rotary axes: 15 um and 40 urad of "
             "location, 3 "
             "um "
             "and 15 urad of motion\n"
             "\n"
             "[[measurements]]  # linear axes, rotary axes at home\n"
             "kind = \"{}\"\n"
             "grid = [6, 5, 4]{}\n",
             schema_with(tracks_distances).name,
             missing_linear_axes(structure).empty() ? "" : "  # one position of an axis that is not there") +
         plane_measurements(structure) + rotary_measurements(structure);
}

}  // namespace volcal::cli
