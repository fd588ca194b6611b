#include "volcal/identify/io/campaign/machine_reader.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "volcal/identify/io/campaign/tolerance_reader.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/text/toml_document.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kLargestLength_mm = 1e5;
constexpr double kLargestTravel_deg = 36000.0;

/// A position of the machine: three coordinates that lie within 100 m.
Eigen::Vector3d position_or_zero(const TomlTable& table, const std::string& key) {
  const KeySchema schema{
      .key = key, .type = KeyType::Vector3, .help = "", .plausible_max = kLargestLength_mm};
  const Options read = table.options({schema});
  return read.vector(std::string(stem_of_key(key))).value_or(Eigen::Vector3d::Zero());
}

std::string axis_remedy(bool rotary) {
  return rotary ? "rotary axes take travel_deg, home_deg, centre_mm and endless"
                : "linear axes take travel_mm, home_mm and reference_point_mm";
}

class MachineReader {
 public:
  explicit MachineReader(TomlDocument document, const std::string& file)
      : document_(std::move(document)), root_(document_.root()) {
    machine_.file = file;
  }

  Machine read() {
    document_.require_format(kMachineFormat);
    machine_.name = root_.text("name").value_or("");
    root_.require_no_formula("name", machine_.name);
    const std::string code = root_.required_text("structure");
    machine_.structure = Structure::parse(code, machine_.file, root_.place("structure").line);
    read_axes();
    read_datum();
    read_tools();
    if (const auto table = root_.table("tolerances")) read_tolerances(*table, machine_.file, machine_);
    document_.reject_unknown();
    return std::move(machine_);
  }

 private:
  void read_axes() {
    const TomlTable axes = root_.required_table("axes");
    for (const Joint& joint : machine_.structure.joints) {
      const std::string name(1, letter_of(joint.axis));
      const auto table = axes.table(name);
      if (!table) {
        axes.fail("", "the structure names axis " + name + " but [axes." + name + "] is missing",
                  "add [axes." + name + "]; " + axis_remedy(is_rotary(joint.axis)));
      }
      machine_.axes.push_back(read_axis(*table, joint.axis));
    }
    for (const std::string& name : axes.keys()) {
      if (name.size() == 1 && axis_from_letter(name[0]) && machine_.has_axis(*axis_from_letter(name[0])))
        continue;
      axes.fail(name,
                "[axes." + printable(name) + "] is not an axis of the structure \"" +
                    machine_.structure.code + "\"",
                "add the axis to the structure or remove the table");
    }
  }

  Axis read_axis(const TomlTable& table, AxisName name) {
    const bool rotary = is_rotary(name);
    const std::string unit(position_unit(name).suffix);
    Axis axis;
    axis.name = name;
    reject_other_family(table, rotary);
    read_travel(table, "travel_" + unit, rotary, axis);
    const std::string home = "home_" + unit;
    axis.home = table.required_number(home);
    if (axis.home < axis.travel_min || axis.home > axis.travel_max) {
      table.fail(home, table.path() + "." + home + " lies outside the travel",
                 "home is a position within travel_" + unit);
    }
    if (rotary) {
      axis.centre = position_or_zero(table, "centre_mm");
      axis.centre_is_assumed = !table.has("centre_mm");
      read_endless(table, axis);
    } else {
      axis.reference_point = position_or_zero(table, "reference_point_mm");
    }
    axis.expansion = read_expansion(table);
    return axis;
  }

  static void reject_other_family(const TomlTable& table, bool rotary) {
    for (const std::string& key : table.keys()) {
      const bool linear_key = key == "travel_mm" || key == "home_mm" || key == "reference_point_mm";
      const bool rotary_key =
          key == "travel_deg" || key == "home_deg" || key == "centre_mm" || key == "endless";
      if (rotary ? linear_key : rotary_key) {
        table.fail(key, "unknown key " + table.path() + "." + key, axis_remedy(rotary));
      }
    }
  }

  static void read_travel(const TomlTable& table, const std::string& key, bool rotary, Axis& axis) {
    const double largest = rotary ? kLargestTravel_deg : kLargestLength_mm;
    const auto travel = table.required_numbers(key, {-largest, largest});
    if (travel.size() != 2) {
      table.fail(key,
                 table.path() + "." + key + " has " + std::to_string(travel.size()) + " numbers, expected 2",
                 "give [lowest, highest]");
    }
    axis.travel_min = travel[0];
    axis.travel_max = travel[1];
    const std::string name = table.path() + "." + key;
    if (travel[0] > travel[1]) table.fail(key, name + " is not ascending", "give [lowest, highest]");
    if (travel[0] == travel[1]) table.fail(key, name + " has no length", "give [lowest, highest]");
    constexpr double kShortestTravel = 2e-3;
    if (!rotary && axis.travel() < kShortestTravel) {
      table.fail(key, name + " is shorter than 2 mm", "wrong unit by 1000? travel_mm is stated in mm");
    }
  }

  static void read_endless(const TomlTable& table, Axis& axis) {
    axis.endless = table.boolean("endless");
    if (!axis.endless.value_or(false) || axis.travels_a_turn()) return;
    table.fail("endless", table.path() + ".endless is true and travel_deg less than a turn",
               "give travel_deg = [-180.0, 180.0], or leave endless out");
  }

  static std::optional<ScaleExpansion> read_expansion(const TomlTable& table) {
    const std::string key = "expansion_um_per_m_K";
    const NumberLimits limits{-kLargestExpansion_um_per_m_K, kLargestExpansion_um_per_m_K};
    const auto coefficient = table.number(key, limits);
    const auto sigma = table.number("expansion_sigma_um_per_m_K", {0.0, kLargestExpansion_um_per_m_K});
    const auto channel = table.text("temperature");
    if (!coefficient && !sigma && !channel) return std::nullopt;
    if (!coefficient || !channel) {
      table.fail(coefficient ? key
                 : channel   ? "temperature"
                             : "expansion_sigma_um_per_m_K",
                 table.path() + ": the scale's expansion is half described",
                 "give " + key + " and temperature = \"CHANNEL\" together, or neither");
    }
    if (channel->empty())
      table.fail("temperature", "temperature names no channel",
                 "name the <channel> of a column T_<channel>_degC");
    return ScaleExpansion{*coefficient, sigma.value_or(0.0), *channel};
  }

  /// The first two linear axes; of a machine with fewer the others stand in for those that it lacks.
  void use_default_datum() {
    std::vector<AxisName> order;
    for (const bool wanted : {true, false}) {
      for (const AxisName axis : kLinearAxes) {
        if (machine_.has_axis(axis) == wanted) order.push_back(axis);
      }
    }
    machine_.datum = {order[0], order[1]};
  }

  void read_datum() {
    const auto table = root_.table("datum");
    const std::size_t linear = machine_.main_linear_axes().size();
    use_default_datum();
    if (table) {
      if (linear >= 1 || table->has("primary")) machine_.datum.primary = datum_axis(*table, "primary");
      if (linear >= 2 || table->has("secondary")) machine_.datum.secondary = datum_axis(*table, "secondary");
      if (machine_.datum.primary == machine_.datum.secondary) {
        table->fail("secondary", "datum: primary and secondary are both " + table->required_text("primary"),
                    "choose two different linear axes");
      }
    }
    const std::array<AxisName, 2> datum = {machine_.datum.primary, machine_.datum.secondary};
    for (std::size_t i = 0; i < datum.size() && i < linear; ++i) {
      const AxisName axis = datum[i];
      if (machine_.has_axis(axis)) continue;
      root_.fail("datum",
                 std::string("the datum axis ") + letter_of(axis) + " is not an axis of the structure",
                 "choose primary and secondary among the structure's linear axes in [datum]");
    }
  }

  static AxisName datum_axis(const TomlTable& table, const std::string& key) {
    const std::string name = table.required_text(key);
    const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
    if (!axis || is_rotary(*axis) || is_parallel(*axis)) {
      table.fail(key, "datum." + key + " = \"" + printable(name) + "\" is not one of X, Y, Z",
                 "the machine frame follows linear axes: \"X\", \"Y\" or \"Z\"");
    }
    return *axis;
  }

  void read_tools() {
    const auto tools = root_.table("tools");
    if (!tools) return;
    for (const std::string& name : tools->keys()) {
      if (name.find_first_not_of(" \t") == std::string::npos)
        tools->fail(name, "the name of a tool is empty", "give it a name, as in [tools.long]");
      tools->require_no_formula(name, name);
      const TomlTable table = tools->required_table(name);
      table.know("offset_mm");
      if (!table.has("offset_mm")) table.fail_missing("offset_mm");
      const NumberLimits sigma_limits{0.0, 1e4};
      machine_.tools.push_back({name, position_or_zero(table, "offset_mm"),
                                table.number("offset_sigma_um", sigma_limits).value_or(0.0)});
    }
  }

  TomlDocument document_;
  TomlTable root_;
  Machine machine_;
};

}  // namespace

Machine read_machine(const std::string& path, const SourcePlace& named_at) {
  return MachineReader(TomlDocument::read(path, named_at), path).read();
}

Machine parse_machine(const std::string& text, const std::string& file) {
  return MachineReader(TomlDocument::parse(text, file), file).read();
}

std::vector<std::string> tool_names(const Machine& machine) {
  std::vector<std::string> names;
  for (const Tool& tool : machine.tools) names.push_back(tool.name);
  return names;
}

}  // namespace volcal
