#include "volcal/identify/io/import/laser_runs.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>
#include <utility>

#include "volcal/identify/io/import/import_lines.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

std::string said_by_line(int line) { return "line " + std::to_string(line); }

/// The axis letters that stand alone in a text: "X", "X axis", "Achse Y".
std::vector<AxisName> axes_in(const std::string& text) {
  std::vector<AxisName> axes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto is_word = [&](std::size_t k) {
      const auto byte = static_cast<unsigned char>(text[k]);
      return std::isalnum(byte) != 0 || byte >= 0x80;
    };
    if (!is_word(i) || (i > 0 && is_word(i - 1)) || (i + 1 < text.size() && is_word(i + 1))) continue;
    if (const auto axis = axis_from_letter(text[i])) axes.push_back(*axis);
  }
  return axes;
}

const InstrumentSchema& instrument_of(LineReading reading) {
  for (const Instrument* instrument : instruments()) {
    if (instrument->schema().traits.line_reading == reading) return instrument->schema();
  }
  throw InputError({}, "no instrument of this program reads such lines",
                   "use a program with all its instruments");
}

/// What the words of a header say of the kind of test.
std::optional<LineReading> kind_in_words(const std::string& text) {
  const std::string words = lower_case(text);
  const auto says = [&](const char* word) { return words.find(word) != std::string::npos; };
  if (says("angular") || says("rta")) return LineReading::Rotation;
  if (says("straight") || says("rts")) return LineReading::Across;
  if (says("linear") || says("rtl")) return LineReading::Along;
  return std::nullopt;
}

const char* kind_name(LineReading kind) {
  return kind == LineReading::Along ? "linear" : kind == LineReading::Across ? "straightness" : "angular";
}

LineReading kind_of(const ErrorSymbol& symbol) {
  return symbol.is_positioning()         ? LineReading::Along
         : is_rotation(symbol.component) ? LineReading::Rotation
                                         : LineReading::Across;
}

std::string unit_vector_toml(int direction) {
  std::string text = "[";
  for (int k = 0; k < 3; ++k) text += std::string(k > 0 ? ", " : "") + (k == direction ? "1.0" : "0.0");
  return text + "]";
}

class LaserReadings {
 public:
  LaserReadings(const LaserFile& laser, const ImportSource& source, const ImportAnswers& answers,
                const Machine& machine)
      : laser_(laser), source_(source), answers_(answers), machine_(machine) {}

  ImportedReadings read() {
    const ErrorSymbol symbol = what_is_read();
    axis_ = symbol.axis;
    const LineReading kind = kind_of(symbol);
    readings_.instrument = &instrument_of(kind);
    const char* key = kind == LineReading::Rotation ? "axis" : "direction";
    readings_.keys[key] = unit_vector_toml(direction_of(symbol.component));
    add_fact("test", std::string(kind_name(kind)) + ", " + symbol.name(), kind_said_by_);
    const double factor = unit_factor(kind);
    take_passes(factor, kind == LineReading::Rotation ? "angle_urad" : "deviation_um");
    add_standing_axes(source_, answers_, machine_, {axis_}, readings_);
    add_temperatures();
    if (laser_.decimal_comma)
      add_fact("decimal sign", "comma", source_.decimal ? "--decimal" : "the numbers");
    add_words();
    return std::move(readings_);
  }

 private:
  void add_fact(const std::string& what, const std::string& value, const std::string& said_by) {
    readings_.facts.push_back({what, printable(value), said_by});
  }

  ErrorSymbol what_is_read() {
    const auto stated = stated_kind();
    if (answers_.measures) return answered_symbol(stated);
    if (!stated)
      ask_for(source_, "what the laser measured",
              "--measures EXX (positioning of X), EYX (straightness), ECX (rotation)");
    const AxisName axis = stated_axis();
    if (*stated != LineReading::Along) {
      ask_for(source_,
              std::string("along or about which direction the ") + kind_name(*stated) + " test reads",
              std::string("--measures E?") + letter_of(axis) +
                  ", as EYX (straightness of X along y) or ECX (rotation of X about z)");
    }
    return {positioning_component(axis), axis};
  }

  std::optional<LineReading> stated_kind() {
    for (const char* key : {"owner", "file type"}) {
      const LaserEntry* entry = laser_.find({key});
      const auto kind = entry ? kind_in_words(entry->value) : std::nullopt;
      if (kind) kind_said_by_ = said_by_line(entry->line);
      if (kind) return kind;
    }
    return std::nullopt;
  }

  ErrorSymbol answered_symbol(const std::optional<LineReading>& stated) {
    const auto symbol = ErrorSymbol::parse(*answers_.measures);
    if (!symbol || is_rotary(symbol->axis))
      throw InputError(
          {}, "--measures " + printable(*answers_.measures) + " is not an error motion of a linear axis",
          "as EXX, EYX or ECX: the component first, the axis that moves last");
    if (stated && *stated != kind_of(*symbol))
      throw InputError({source_.path, 0},
                       "--measures " + symbol->name() + " asks for a test of the kind " +
                           kind_name(kind_of(*symbol)) + "; by " + kind_said_by_ +
                           " the file is of the kind " + kind_name(*stated),
                       "give the error that the file holds");
    kind_said_by_ = "--measures";
    require_axis(symbol->axis);
    return *symbol;
  }

  AxisName stated_axis() {
    if (answers_.axis) {
      const auto axes = axes_in(*answers_.axis);
      if (axes.size() != 1)
        throw InputError({}, "--axis is \"" + printable(*answers_.axis) + "\"",
                         "give one letter, as --axis X");
      add_fact("axis", std::string(1, letter_of(axes[0])), "--axis");
      return require_axis(axes[0]);
    }
    const LaserEntry* entry = laser_.find({"axis", "achse", "axe", "eje", "asse"});
    const auto axes = entry ? axes_in(entry->value) : std::vector<AxisName>();
    if (axes.size() != 1) ask_for(source_, "which axis moves", "--axis X");
    add_fact("axis", std::string(1, letter_of(axes[0])), said_by_line(entry->line));
    return require_axis(axes[0]);
  }

  AxisName require_axis(AxisName axis) const {
    if (is_rotary(axis))
      throw InputError({source_.path, 0},
                       std::string("axis ") + letter_of(axis) + " is rotary; targets of an .rtl file are mm",
                       "runs of linear axes are read");
    if (!machine_.has_axis(axis))
      throw InputError({source_.path, 0}, std::string("axis ") + letter_of(axis) + " is none of the machine",
                       "its structure is \"" + machine_.structure.code + "\"; say another with --axis");
    return axis;
  }

  /// From the unit of the file to that of the column.
  double unit_factor(LineReading kind) {
    const bool angle = kind == LineReading::Rotation;
    const std::string choices = angle ? "--unit arcsec, urad or deg" : "--unit um, mm or nm";
    if (!answers_.unit) ask_for(source_, "the unit of the deviations", choices);
    const auto si = angle ? angle_unit(*answers_.unit) : length_unit(*answers_.unit);
    if (!si)
      throw InputError(
          {},
          "--unit " + printable(*answers_.unit) + " is not a unit of " + (angle ? "an angle" : "a length"),
          "give " + choices);
    add_fact("unit of the deviations", *answers_.unit, "--unit");
    return *si / kMicro;
  }

  /// Of each pass, whether it went from the first target to the last.
  std::vector<bool> forward_passes() {
    const bool listed =
        std::ranges::any_of(laser_.passes, [](const LaserPass& pass) { return !pass.ascending; });
    std::vector<bool> forward;
    if (listed || answers_.runs) {
      if (answers_.runs)
        require_choice("--runs", *answers_.runs, {"forward", "backward", "alternating", "bidirectional"});
      for (std::size_t k = 0; k < laser_.passes.size(); ++k)
        forward.push_back(listed ? laser_.passes[k].ascending : answered_forward(k));
    } else {
      ask_for(source_, "in which direction the runs went: each lists its targets from the first to the last",
              "--runs forward, backward or alternating (run 1 forward, 2 backward, 3 forward ...)");
    }
    for (std::size_t k = 0; listed && answers_.runs && k < forward.size(); ++k) {
      if (forward[k] == answered_forward(k)) continue;
      const LaserDeviation& first = laser_.passes[k].readings.front();
      throw InputError({source_.path, first.line},
                       "run " + std::to_string(first.run) + " lists its targets " +
                           (forward[k] ? "from the first to the last" : "from the last to the first") +
                           ", against --runs " + *answers_.runs,
                       "leave --runs out: the file says the order itself");
    }
    add_fact("order of the runs", order_text(forward), listed ? "order of the rows" : "--runs");
    return forward;
  }

  bool answered_forward(std::size_t pass) const {
    if (*answers_.runs == "forward") return true;
    return *answers_.runs != "backward" && pass % 2 == 0;
  }

  static std::string order_text(const std::vector<bool>& forward) {
    std::string text;
    constexpr std::size_t kShown = 12;
    for (std::size_t k = 0; k < std::min(kShown, forward.size()); ++k) text += forward[k] ? "+" : "-";
    return std::to_string(forward.size()) + " passes, " + text + (forward.size() > kShown ? "..." : "");
  }

  void take_passes(double factor, const char* reading_column) {
    const std::vector<bool> forward = forward_passes();
    const double shift = answers_.at.contains(axis_) ? answers_.at.at(axis_) : 0.0;
    const bool rising = laser_.targets_mm.back() > laser_.targets_mm.front();
    std::vector<double> position, direction, line, run, value;
    for (std::size_t k = 0; k < laser_.passes.size(); ++k) {
      std::vector<LaserDeviation> rows = laser_.passes[k].readings;
      if (forward[k] != laser_.passes[k].ascending) std::ranges::reverse(rows);
      for (const LaserDeviation& row : rows) {
        position.push_back(laser_.targets_mm[static_cast<std::size_t>(row.target) - 1] + shift);
        direction.push_back(forward[k] == rising ? 1.0 : -1.0);
        line.push_back(static_cast<double>(k + 1));
        run.push_back(row.run);
        value.push_back(row.value * factor);
        readings_.source_line.push_back(row.line);
      }
    }
    add_fact("targets",
             std::to_string(laser_.targets_mm.size()) + " from " +
                 number_text(laser_.targets_mm.front() + shift) + " to " +
                 number_text(laser_.targets_mm.back() + shift) + " mm of the axis",
             shift == 0.0 ? "the file, as machine coordinates" : "the file, shifted by --at");
    readings_.columns = {{"line", line},
                         {"run", run},
                         {position_column(axis_), position},
                         {direction_of_approach(axis_).column(), direction},
                         {reading_column, value}};
  }

  void add_temperatures() {
    constexpr auto kSensors =
        std::to_array<std::pair<const char*, const char*>>({{"air temp", "air"},
                                                            {"mat temp 1", "material_1"},
                                                            {"mat temp 2", "material_2"},
                                                            {"mat temp 3", "material_3"}});
    for (const auto& [key, channel] : kSensors) {
      const LaserEntry* entry = laser_.find({key});
      if (!entry) continue;
      const auto words = words_between_blanks(entry->value);
      const auto value = words.empty() ? std::nullopt : foreign_number(words[0]);
      const bool celsius =
          words.size() == 1 ||
          (words.size() == 2 && (words[1] == "C" || words[1] == "degC" || words[1] == "\u00B0C"));
      if (!value || !celsius)
        throw InputError({source_.path, entry->line},
                         "the temperature \"" + printable(entry->value) + "\" is not a number of degC",
                         "write it in degC, or remove its value");
      if (*value == 0.0) {
        add_fact(entry->key, "0, no sensor: not taken", said_by_line(entry->line));
        continue;
      }
      readings_.columns.push_back(
          {temperature_of(channel).column(), std::vector<double>(readings_.source_line.size(), *value)});
      add_fact(entry->key, number_text(*value) + " degC", said_by_line(entry->line));
    }
  }

  /// What the file says beside: kept as comments of the campaign.
  void add_words() {
    std::set<std::string> known;
    for (const ImportFact& fact : readings_.facts) known.insert(fact.what);
    for (const LaserEntry& entry : laser_.entries) {
      if (entry.value.empty() || known.contains(entry.key)) continue;
      add_fact(entry.key.empty() ? lower_case(entry.section) : printable(entry.key), entry.value,
               said_by_line(entry.line));
    }
  }

  const LaserFile& laser_;
  const ImportSource& source_;
  const ImportAnswers& answers_;
  const Machine& machine_;
  AxisName axis_ = AxisName::X;
  std::string kind_said_by_;
  ImportedReadings readings_;
};

class RtlFormat final : public ImportFormat {
 public:
  std::string_view name() const override { return "rtl"; }
  std::string_view summary() const override { return "laser files .rtl: runs over the targets of an axis"; }
  bool recognises(const ImportSource& source) const override {
    const auto lines = lines_with_text(source.text);
    const auto begins = [&](std::string_view section) {
      return std::ranges::any_of(lines,
                                 [&](const TextLine& line) { return lower_case(line.text) == section; });
    };
    return begins("header::") || begins("deviations::") || begins("target data::");
  }
  ImportedReadings read(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
                        std::size_t /*tool*/) const override {
    return laser_readings(parse_rtl(source), source, answers, machine);
  }
};

}  // namespace

ImportedReadings laser_readings(const LaserFile& laser, const ImportSource& source,
                                const ImportAnswers& answers, const Machine& machine) {
  return LaserReadings(laser, source, answers, machine).read();
}

const ImportFormat& rtl_format() {
  static const RtlFormat format;
  return format;
}

}  // namespace volcal
