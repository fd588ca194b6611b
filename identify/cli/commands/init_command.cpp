#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/commands/rotary_templates.h"
#include "volcal/identify/compensation/measurement_record.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/instruments/registry.h"

namespace volcal::cli {
namespace {

struct InitArguments {
  std::string structure;
  std::string output;
  bool force = false;
  bool json = false;
};

std::string axis_table(AxisName axis) {
  if (is_parallel(axis))
    return fmt::format(
        "[axes.{0}]  # beside {1}, as a quill: it stands at home where {1} moves over the volume\n"
        "travel_mm = [0.0, 300.0]\nhome_mm = 0.0\nreference_point_mm = [0.0, 0.0, 0.0]  # where the scale "
        "reads, all axes at 0\n",
        letter_of(axis), letter_of(main_axis_of(axis)));
  return fmt::format(
      "[axes.{}]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\nreference_point_mm = [0.0, 0.0, 0.0]  # where the "
      "scale reads, all axes at 0\n",
      letter_of(axis));
}

/// Of the first two linear axes; a machine with one has no frame to choose.
std::string datum_table(const Structure& structure) {
  std::vector<char> linear;
  for (const AxisName axis : kLinearAxes) {
    if (structure.has_axis(axis)) linear.push_back(letter_of(axis));
  }
  if (linear.size() < 2) return "";
  return fmt::format(
      "[datum]  # {0} gives the direction of the frame, {1} its plane\nprimary = \"{0}\"\nsecondary = "
      "\"{1}\"\n",
      linear[0], linear[1]);
}

std::string machine_toml(const Structure& structure) {
  std::string text = fmt::format(
      "# The machine: structure, axes, tools. Lengths in mm; every key ends in its unit.\n"
      "format = \"volcal-machine-1\"\n"
      "name = \"my machine\"\n"
      "structure = \"{}\"  # workpiece to tool; a prime marks an axis that moves the workpiece\n",
      structure.code);
  text += datum_table(structure);
  const bool rotary = has_rotary_axes(structure);
  for (const Joint& joint : structure.joints)
    text += rotary ? axis_table_beside_rotary(joint.axis, structure) : axis_table(joint.axis);
  if (rotary) return text + rotary_tools(structure);
  return text +
         "[tools.short]\noffset_mm = [0.0, 0.0, -150.0]  # functional point from the spindle's reference "
         "point\n"
         "[tools.side]  # sideways offsets make the rolls of the last axis visible: three tips, not on one "
         "line\n"
         "offset_mm = [100.0, 0.0, -200.0]\n"
         "[tools.front]\noffset_mm = [0.0, 100.0, -200.0]\n";
}

/// Columns of the commanded positions, in the order X Y Z A B C U V W.
std::string position_columns(const Structure& structure) {
  std::string text;
  for (const AxisName axis : kAllAxes) {
    if (!structure.has_axis(axis)) continue;
    text += (text.empty() ? "" : ",") + axis_column(axis);
  }
  return text;
}

std::string commented_setup(const InstrumentSchema& schema, const std::string& positions) {
  std::string text = fmt::format(
      "\n# {}\n# reading: {}\n#[[setups]]\n#name = \"{}-1\"\n#instrument = \"{}\"\n#data = \"{}-1.csv\"  # "
      "columns: {}",
      schema.summary, schema.equation, schema.name, schema.name, schema.name, positions);
  for (const ColumnSchema& column : schema.file_columns(0)) text += "," + column.column;
  text += "\n#tool = \"short\"\n";
  for (const KeySchema& key : schema.keys) {
    const std::string value = key.type == KeyType::Vector3   ? "[0.0, 0.0, 0.0]"
                              : key.type == KeyType::Numbers ? "[0.0, 1.0]"
                              : key.type == KeyType::Text
                                  ? (key.choices.empty() ? "\"name\"" : "\"" + key.choices.front() + "\"")
                              : key.type == KeyType::Boolean ? "false"
                                                             : "1.0";
    text += fmt::format("#{} = {}  # {}{}\n", key.key, value, key.required ? "" : "optional: ", key.help);
  }
  text += "#noise = { ";
  for (std::size_t i = 0; i < schema.noise_keys.size(); ++i) {
    text += fmt::format("{}{} = 0.3", i == 0 ? "" : ", ", schema.noise_keys[i].key);
  }
  return text + " }\n";
}

/// What no reading says, for the certificate of the tables.
std::string commented_record() {
  std::string text =
      "#[record]  # what no reading says, for volcal tables --certificate; leave out what is not known\n";
  for (const RecordItem& item : record_items()) {
    if (item.key != "active_compensations") text += fmt::format("#{} = \"\"  # {}\n", item.key, item.title);
  }
  return text;
}

std::string campaign_toml(const Structure& structure) {
  std::string text =
      "# The campaign: what was measured. Take the comment marks off a setup and name its CSV file.\n"
      "format = \"volcal-campaign-1\"\n"
      "machine = \"machine.toml\"\n"
      "[noise]\n"
      "repeatability_um = 0.5  # of the machine, k = 1, per component along the reading\n" +
      commented_record();
  std::vector<std::string> shown;
  if (has_rotary_axes(structure)) {
    text += rotary_setups(structure, position_columns(structure));
    shown = rotary_instruments(structure);
  }
  for (const Instrument* instrument : instruments()) {
    if (std::ranges::find(shown, instrument->schema().name) != shown.end()) continue;
    text += commented_setup(instrument->schema(), position_columns(structure));
  }
  return text;
}

const char* const kModelToml =
    "# The model: what we assume of the machine.\n"
    "format = \"volcal-model-1\"\n"
    "machine = \"machine.toml\"\n"
    "[functions]\n"
    "default = { basis = \"bspline\", degree = 3, knots = \"auto\" }\n"
    "#EAX = { basis = \"zero\" }  # any function can be left out\n"
    "#[[effects]]  # half of it is added in the + direction, half taken off in the - direction\n"
    "#kind = \"reversal\"\n"
    "#symbol = \"EXX\"\n";

std::string model_toml(const Structure& structure) {
  if (!has_rotary_axes(structure)) return kModelToml;
  const auto rotary =
      std::ranges::find_if(structure.joints, [](const Joint& joint) { return is_rotary(joint.axis); });
  const char letter = letter_of(rotary->axis);
  return kModelToml + fmt::format(
                          "#[locations]\n"
                          "#EA0{0}_urad = 12.0  # a location error that is known; \"zero\" leaves one out\n",
                          letter);
}

int run_init(const InitArguments& arguments) {
  const Structure structure = Structure::parse(arguments.structure);
  AtomicFolder folder(arguments.output, arguments.force ? Replaceable::Anything : Replaceable::Unedited);
  folder.write("machine.toml", machine_toml(structure));
  folder.write("model.toml", model_toml(structure));
  folder.write("campaign.toml", campaign_toml(structure));
  std::vector<std::string> files = {"machine.toml", "model.toml", "campaign.toml"};
  if (has_rotary_axes(structure)) {
    if (const std::string study = rotary_study(structure); !study.empty()) {
      folder.write("study.toml", study);
      files.emplace_back("study.toml");
    }
  }
  folder.commit_to_be_edited();
  if (arguments.json) {
    const nlohmann::ordered_json json = {
        {"folder", arguments.output}, {"structure", structure.code}, {"files", files}};
    fmt::print("{}\n", json_text(json, 2));
    return kDone;
  }
  std::string written;
  for (const std::string& file : files)
    written += (written.empty() ? "" : ", ") + arguments.output + "/" + file;
  fmt::print(
      "written: {1}\n"
      "next: enter travel and tools in machine.toml, a setup per measurement in campaign.toml, then\n"
      "      volcal fit {0}/campaign.toml --model {0}/model.toml -o result\n",
      arguments.output, written);
  if (files.size() > 3)
    fmt::print("or rehearse it: volcal simulate {}/study.toml -o rehearsal\n", arguments.output);
  return kDone;
}

std::function<int()> define_init(CLI::App& app) {
  auto arguments = std::make_shared<InitArguments>();
  app.add_option("STRUCTURE", arguments->structure, "structural code, workpiece to tool (ISO 10791-6)")
      ->required();
  app.add_option("-o,--output", arguments->output, "folder, new or empty")->required();
  app.add_flag("--force", arguments->force, "overwrite files that were edited, and those of other origin");
  app.add_flag("--json", arguments->json, "print one JSON document on standard output and nothing else");
  return [arguments] { return run_init(*arguments); };
}

}  // namespace

const Command& init_command() {
  static const Command command = {"init", "write a commented machine, model and campaign to start from",
                                  "  volcal init \"w X' b Y Z t\" -o my-machine\n"
                                  "  volcal init \"w C' A' b X Y Z t\" -o five-axis\n"
                                  "  volcal init \"w X' b Y Z W t\" -o boring-mill\n",
                                  define_init};
  return command;
}

}  // namespace volcal::cli
