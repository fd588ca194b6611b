#include <fmt/format.h>

#include <cctype>
#include <iterator>
#include <map>
#include <utility>

#include "volcal/identify/compensation/formats/linuxcnc/linuxcnc_units.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal {

const TableFormat& linuxcnc_format();

namespace {

constexpr int kMostRows = 256;
constexpr std::size_t kLongestLine = 254;
constexpr std::string_view kIniFile = "compensation.ini";

constexpr std::string_view kIniCoordinates = "# coordinates = ";
constexpr std::string_view kAllCoordinates = "XYZ";

/// Letters of the linear axes by the number of their joint, as `trivkins coordinates=XZ` counts them.
std::string coordinates_of(const Machine& machine) {
  std::string letters;
  for (const AxisName axis : machine.main_linear_axes()) letters += letter_of(axis);
  return letters;
}

std::string comp_file_name(AxisName axis) { return std::string(1, lower_letter_of(axis)) + ".comp"; }

/// Trims: three numbers a line and nothing else, since the loader stops at the first other line.
std::string comp_file(const AxisTable& table, double unit) {
  fmt::memory_buffer text;
  for (std::size_t i = 0; i < table.position.size(); ++i) {
    fmt::format_to(
        std::back_inserter(text), "{:.6f} {:.8f} {:.8f}\n", without_negative_zero(table.position[i] / unit),
        without_negative_zero(table.forward[i] / unit), without_negative_zero(table.backward[i] / unit));
  }
  return fmt::to_string(text);
}

std::vector<TableFile> write_linuxcnc(const FitResult& result, const TableFormatOptions& options) {
  const std::string units = linear_units_of(options);
  const double unit = linear_unit(units);
  const std::string coordinates = coordinates_of(result.machine);
  std::string ini = coordinates == kAllCoordinates ? "" : fmt::format("{}{}\n", kIniCoordinates, coordinates);
  ini += fmt::format("[TRAJ]\nLINEAR_UNITS = {}\n", units);
  std::vector<TableFile> files;
  for (const SampledTable& sampled : sample_axis_tables(linuxcnc_format(), result, options)) {
    files.push_back({comp_file_name(sampled.output), comp_file(sampled.table, unit)});
    ini += fmt::format("\n[JOINT_{}]\nCOMP_FILE = {}\nCOMP_FILE_TYPE = 1\n",
                       coordinates.find(letter_of(sampled.output)), files.back().name);
  }
  files.push_back({std::string(kIniFile), ini});
  return files;
}

struct CompFile {
  std::string name;
  int type = 0;
  SourcePlace place;
};

struct JointFiles {
  double unit = 0.0;  ///< m
  std::string coordinates{kAllCoordinates};
  std::map<int, CompFile> joints;
};

std::string joints_text(const std::string& coordinates) {
  std::string numbers, axes;
  for (std::size_t joint = 0; joint < coordinates.size(); ++joint) {
    numbers += (joint > 0 ? ", " : "") + std::to_string(joint);
    axes += (joint > 0 ? ", " : "") + std::string(1, coordinates[joint]);
  }
  return "joints " + numbers + " are " + axes + "; rename the section or give kinematics with these joints";
}

/// The part of an INI file that compensation is about; other sections and keys are for others.
class IniReader {
 public:
  explicit IniReader(const TableFile& file) : lines_(file) {}

  JointFiles read() {
    while (lines_.advance_to_content()) {
      const std::string_view line = trimmed_text(lines_.current());
      if (line.starts_with(kIniCoordinates)) read_coordinates(line.substr(kIniCoordinates.size()));
      if (line.front() == '#' || line.front() == ';') continue;
      if (line.front() == '[') {
        open_section(line);
      } else {
        read_key(line);
      }
    }
    if (files_.unit == 0.0)
      lines_.fail("[TRAJ] LINEAR_UNITS is missing", "write LINEAR_UNITS = mm or inch under [TRAJ]");
    for (const auto& [joint, comp] : files_.joints) {
      if (comp.name.empty())
        throw InputError(comp.place, fmt::format("[JOINT_{}] has no COMP_FILE", joint), "name the file");
    }
    return files_;
  }

 private:
  void read_coordinates(std::string_view letters) {
    std::string_view rest = kAllCoordinates;
    for (const char letter : letters) {
      const std::size_t at = rest.find(letter);
      if (at == std::string_view::npos)
        lines_.fail("the coordinates are \"" + std::string(letters.substr(0, 20)) + "\"",
                    "write the linear axes of the machine in the order X Y Z, as XZ");
      rest.remove_prefix(at + 1);
    }
    files_.coordinates = std::string(letters);
  }

  void open_section(std::string_view line) {
    section_ = std::string(line);
    joint_ = -1;
    constexpr std::string_view kPrefix = "[JOINT_";
    if (!line.starts_with(kPrefix)) return;
    joint_ = line.size() == kPrefix.size() + 2 && line.back() == ']' ? line[kPrefix.size()] - '0' : -1;
    if (joint_ < 0 || joint_ >= static_cast<int>(files_.coordinates.size()))
      lines_.fail("the section is " + section_.substr(0, 40), joints_text(files_.coordinates));
  }

  void read_key(std::string_view line) {
    const auto equals = line.find('=');
    if (equals == std::string_view::npos) lines_.fail("the line is not KEY = VALUE", "write KEY = VALUE");
    const std::string_view key = trimmed_text(line.substr(0, equals));
    const std::string_view value = trimmed_text(line.substr(equals + 1));
    if (section_ == "[TRAJ]" && key == "LINEAR_UNITS") {
      files_.unit = linear_unit(value);
      if (files_.unit == 0.0) lines_.fail("LINEAR_UNITS is neither mm nor inch", "write mm or inch");
    }
    if (joint_ < 0) return;
    CompFile& comp = files_.joints[joint_];
    comp.place = lines_.place();
    if (key == "COMP_FILE") comp.name = std::string(value);
    if (key == "COMP_FILE_TYPE") {
      comp.type = lines_.integer(value, "COMP_FILE_TYPE");
      if (comp.type != 0 && comp.type != 1)
        lines_.fail("COMP_FILE_TYPE is neither 0 nor 1", "0 = actual positions, 1 = trims");
    }
  }

  TableLines lines_;
  std::string section_;
  int joint_ = -1;
  JointFiles files_;
};

AxisTable read_comp_file(const TableFile& file, AxisName axis, int type, double unit) {
  AxisTable table{.input = axis, .position = {}, .forward = {}, .backward = {}};
  TableLines lines(file);
  while (lines.advance()) {
    const auto words = words_of(lines.current());
    if (words.size() != 3)
      lines.fail(
          fmt::format("the line has {} numbers; LinuxCNC stops reading here without a word", words.size()),
          "write three numbers and nothing else: no header, no comment, no blank line");
    if (lines.current().size() > kLongestLine)
      lines.fail("the line is longer than LinuxCNC reads", "write fewer digits");
    const double nominal = lines.number(words[0], "the nominal position") * unit;
    require_ascending(table.position, nominal, lines.place());
    if (table.position.size() == kMostRows)
      lines.fail(fmt::format("LinuxCNC keeps {} rows and drops this one", kMostRows), "write fewer rows");
    const auto trim = [&](std::string_view word) {
      const double value = lines.number(word, "the value") * unit;
      return type == 1 ? value : nominal - value;
    };
    table.position.push_back(nominal);
    table.forward.push_back(trim(words[1]));
    table.backward.push_back(trim(words[2]));
  }
  if (table.position.size() < 2) lines.fail("the table has less than two rows", "write the tables again");
  return table;
}

CompensationTables read_linuxcnc(std::span<const TableFile> files) {
  const JointFiles ini = IniReader(file_named(files, kIniFile)).read();
  CompensationTables result;
  for (const auto& [joint, comp] : ini.joints) {
    const AxisName axis = *axis_from_letter(ini.coordinates[static_cast<std::size_t>(joint)]);
    result.terms.push_back(
        axis_term(axis, read_comp_file(file_named(files, comp.name), axis, comp.type, ini.unit)));
  }
  return result;
}

}  // namespace

const TableFormat& linuxcnc_format() {
  static const TableFormat format = {
      .name = "linuxcnc",
      .summary =
          "LinuxCNC screw compensation: x.comp, y.comp, z.comp with trims towards + and towards -, and "
          "the lines of the INI file that name them",
      .source =
          "LinuxCNC, INI configuration, [JOINT_n] COMP_FILE and COMP_FILE_TYPE = 1: trim added to the "
          "command, linear between rows, end values held; joints are numbered by the axes that the machine "
          "has, in the order "
          "X Y Z (kins(9): trivkins coordinates=xz assigns x==joint0, z==joint1)",
      .verified =
          "applied by LinuxCNC 2.9.0~pre1 in simulation as predicted, in both directions "
          "(scripts/linuxcnc-loop); not on a machine",
      .supported = CompensationPart::Positioning,
      .refusal =
          "a screw compensation table acts on its own joint only; errors that need other axes or the "
          "tool length take a kinematics module",
      .limits = {.points_per_table = kMostRows, .resolution = 1e-11, .both_directions = true},
      .settings = kLinuxCncSettings,
      .write = write_linuxcnc,
      .read = read_linuxcnc};
  return format;
}

}  // namespace volcal
