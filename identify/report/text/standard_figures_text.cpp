#include "volcal/identify/report/text/standard_figures_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/standards/rotary_test_names.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using Cells = std::vector<std::string>;

std::string micrometres_or_dash(std::optional<double> value) {
  return value ? fixed_number(*value * kPerMicro, 2) : "-";
}

void append(Cells& cells, Cells more) {
  cells.insert(cells.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// One row for the readings and one per model under a common heading; the heading stands once.
class SourceRows {
 public:
  explicit SourceRows(TextTable& table) : table_(table) {}

  void add(Cells heading, const std::string& source, Cells figures) {
    if (heading == last_) {
      heading.assign(heading.size(), "");
    } else {
      last_ = heading;
    }
    heading.push_back(source);
    append(heading, std::move(figures));
    table_.add_row(std::move(heading));
  }

 private:
  TextTable& table_;
  Cells last_;
};

std::vector<TextColumn> columns(std::initializer_list<const char*> left,
                                std::initializer_list<const char*> right) {
  std::vector<TextColumn> result;
  for (const char* header : left) result.push_back({header, Align::Left});
  for (const char* header : right) result.push_back({header, Align::Right});
  return result;
}

Cells positioning_cells(const PositioningFigures& figures) {
  return {micrometres_or_dash(figures.accuracy),
          micrometres_or_dash(figures.positive.accuracy),
          micrometres_or_dash(figures.negative.accuracy),
          micrometres_or_dash(figures.systematic),
          micrometres_or_dash(figures.positive.systematic),
          micrometres_or_dash(figures.negative.systematic),
          micrometres_or_dash(figures.mean_bidirectional),
          micrometres_or_dash(figures.repeatability),
          micrometres_or_dash(figures.positive.repeatability),
          micrometres_or_dash(figures.negative.repeatability),
          micrometres_or_dash(figures.reversal),
          micrometres_or_dash(figures.mean_reversal)};
}

std::string lines_text(std::span<const NamedFigures> models) {
  TextTable table(columns({"setup", "axis", "at", "source"},
                          {"A", "A+", "A-", "E", "E+", "E-", "M", "R", "R+", "R-", "B", "mean B"}),
                  "Positioning of the axes, ISO 230-2:2014 [um]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->lines;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Cells heading = {tests[i].setup, {letter_of(tests[i].axis)}, tests[i].place};
    rows.add(heading, "readings", positioning_cells(tests[i].figures.readings));
    for (const NamedFigures& model : models) {
      rows.add(heading, model.name, positioning_cells(model.figures->lines[i].figures.model));
    }
  }
  return table.text();
}

std::string rotary_lines_text(std::span<const NamedFigures> models) {
  TextTable table(columns({"setup", "axis", "at", "source"},
                          {"A", "A+", "A-", "E", "E+", "E-", "M", "R", "R+", "R-", "B", "mean B"}),
                  "Angular positioning of rotary axes, ISO 230-2:2014 [urad]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->rotary_lines;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Cells heading = {tests[i].setup, {letter_of(tests[i].axis)}, tests[i].place};
    rows.add(heading, "readings", positioning_cells(tests[i].figures.readings));
    for (const NamedFigures& model : models)
      rows.add(heading, model.name, positioning_cells(model.figures->rotary_lines[i].figures.model));
  }
  return table.text();
}

Cells motion_cells(const ErrorMotionFigures& figures) {
  return {std::to_string(figures.angles), micrometres_or_dash(figures.total),
          micrometres_or_dash(figures.synchronous), micrometres_or_dash(figures.asynchronous),
          micrometres_or_dash(figures.fundamental)};
}

std::string error_motions_text(std::span<const NamedFigures> models) {
  TextTable table(columns({"setup", "axis", "error motion", "source"},
                          {"angles", "total", "synchronous", "asynchronous", "fundamental"}),
                  "Axes of rotation, ISO 230-7:2006 [um, tilt urad]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->error_motions;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Cells heading = {tests[i].setup, {letter_of(tests[i].axis)}, motion_name(tests[i])};
    rows.add(heading, "readings", motion_cells(tests[i].figures.readings));
    for (const NamedFigures& model : models)
      rows.add(heading, model.name, motion_cells(model.figures->error_motions[i].figures.model));
  }
  const std::string text = table.text();
  return text.empty() ? text
                      : text +
                            "  radial and tilt about the least-squares centre, axial with its one wave a "
                            "turn; values need "
                            "a full turn, asynchronous ones an angle that was met twice\n";
}

Cells drift_cells(const DriftFigures& figures) {
  constexpr double kSecondsPerHour = 3600.0;
  return {fixed_number(figures.duration / kSecondsPerHour, 1), micrometres_or_dash(figures.range),
          micrometres_or_dash(figures.first_hour), micrometres_or_dash(figures.fastest_in_an_hour),
          micrometres_or_dash(figures.change)};
}

std::string drifts_text(std::span<const NamedFigures> models) {
  TextTable table(
      columns({"setup", "drift", "source"}, {"hours", "range", "first hour", "any hour", "change"}),
      "Drift at rest, ISO 230-3:2007 [um, tilt urad]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->drifts;
  std::string temperatures;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Cells heading = {tests[i].setup, drift_name(tests[i])};
    rows.add(heading, "readings", drift_cells(tests[i].figures.readings));
    for (const NamedFigures& model : models)
      rows.add(heading, model.name, drift_cells(model.figures->drifts[i].figures.model));
    const std::string beside = temperatures_text(tests[i]);
    const std::string line = beside.empty() ? beside : fmt::format("  {}: {}\n", tests[i].setup, beside);
    if (temperatures.find(line) == std::string::npos) temperatures += line;
  }
  return table.text() + temperatures;
}

std::string diagonals_text(std::span<const NamedFigures> models) {
  TextTable table(columns({"setup", "diagonal", "source"},
                          {"A", "A+", "A-", "E", "E+", "E-", "M", "R", "R+", "R-", "B", "mean B"}),
                  "Diagonal displacement, ISO 230-6:2002 [um]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->diagonals;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Cells heading = {tests[i].setup, tests[i].figures.readings.name};
    rows.add(heading, "readings", positioning_cells(tests[i].figures.readings.positioning));
    for (const NamedFigures& model : models) {
      rows.add(heading, model.name, positioning_cells(model.figures->diagonals[i].figures.model.positioning));
    }
  }
  return table.text();
}

std::string diagonal_groups_text(std::span<const NamedFigures> models) {
  TextTable table(columns({"diagonals", "number", "source"}, {"E_d [um]", "B_d [um]"}));
  SourceRows rows(table);
  const auto& groups = models.front().figures->diagonal_groups;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Cells heading = {(groups[i].axes.size() == 3 ? "body " : "face ") + letters_of(groups[i].axes),
                           std::to_string(groups[i].summary.readings.diagonals)};
    const auto cells = [](const DiagonalSummary& summary) {
      return Cells{micrometres_or_dash(summary.systematic), micrometres_or_dash(summary.reversal)};
    };
    rows.add(heading, "readings", cells(groups[i].summary.readings));
    for (const NamedFigures& model : models) {
      rows.add(heading, model.name, cells(model.figures->diagonal_groups[i].summary.model));
    }
  }
  return table.text();
}

std::string circle_reversal(const CircleTest& test, const CircularFigures& figures, AxisName axis) {
  if (axis == test.first) return micrometres_or_dash(figures.mean_reversal(0));
  if (axis == test.second) return micrometres_or_dash(figures.mean_reversal(1));
  return "-";
}

Cells circle_cells(const CircleTest& test, const CircularFigures& figures) {
  const auto of = [](const std::optional<CircularPath>& path, double CircularPath::*figure) {
    return path ? micrometres_or_dash((*path).*figure) : std::string("-");
  };
  Cells cells = {of(figures.counter_clockwise, &CircularPath::circular_deviation),
                 of(figures.clockwise, &CircularPath::circular_deviation),
                 micrometres_or_dash(figures.bidirectional),
                 of(figures.counter_clockwise, &CircularPath::radial_max),
                 of(figures.counter_clockwise, &CircularPath::radial_min),
                 of(figures.clockwise, &CircularPath::radial_max),
                 of(figures.clockwise, &CircularPath::radial_min),
                 micrometres_or_dash(figures.mean_radial)};
  for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
    cells.push_back(circle_reversal(test, figures, axis));
  }
  return cells;
}

std::string circles_text(std::span<const NamedFigures> models) {
  TextTable table(
      columns({"setup", "plane", "R [mm]", "source"}, {"G ccw", "G cw", "G(b)", "Fmax ccw", "Fmin ccw",
                                                       "Fmax cw", "Fmin cw", "D", "B X", "B Y", "B Z"}),
      "Circular tests, ISO 230-4:2005 [um]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->circles;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Cells heading = {tests[i].setup,
                           {letter_of(tests[i].first), letter_of(tests[i].second)},
                           short_number(tests[i].radius * kPerMilli)};
    rows.add(heading, "readings", circle_cells(tests[i], tests[i].figures.readings));
    for (const NamedFigures& model : models) {
      rows.add(heading, model.name, circle_cells(tests[i], model.figures->circles[i].figures.model));
    }
  }
  return table.text();
}

Cells volumetric_cells(const VolumetricFigures& figures) {
  return {std::to_string(figures.points),         micrometres_or_dash(figures.range.x()),
          micrometres_or_dash(figures.range.y()), micrometres_or_dash(figures.range.z()),
          micrometres_or_dash(figures.rms),       micrometres_or_dash(figures.max)};
}

std::string points_text(std::span<const NamedFigures> models) {
  TextTable table(
      columns({"setup", "source"}, {"points", "range x", "range y", "range z", "rms |e|", "max |e|"}),
      "Volumetric errors [um]");
  SourceRows rows(table);
  const auto& tests = models.front().figures->points;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    rows.add({tests[i].setup}, "readings", volumetric_cells(tests[i].figures.readings));
    for (const NamedFigures& model : models) {
      const PointsTest& test = model.figures->points[i];
      rows.add({tests[i].setup}, model.name, volumetric_cells(test.figures.model));
      rows.add({tests[i].setup}, "readings - " + model.name, volumetric_cells(test.difference));
    }
  }
  return table.text();
}

/// "note (setups)" for every different note, in order of appearance.
template <class Test>
std::string notes_text(const std::vector<Test>& tests) {
  std::vector<std::pair<std::string, std::string>> notes;
  for (const Test& test : tests) {
    for (const std::string& note : sentences(test.notes)) {
      const auto same =
          std::find_if(notes.begin(), notes.end(), [&](const auto& known) { return known.first == note; });
      if (same == notes.end()) {
        notes.emplace_back(note, test.setup);
      } else {
        same->second += ", " + test.setup;
      }
    }
  }
  std::string text;
  for (const auto& [note, setups] : notes) text += fmt::format("  {} ({})\n", note, setups);
  return text;
}

}  // namespace

std::string standard_figures_text(std::span<const NamedFigures> models) {
  const StandardFigures& first = *models.front().figures;
  const std::string circles = circles_text(models);
  const std::string circle_key =
      circles.empty() ? "" : "  B: reversal at the quadrants as ISO 230-2, mean of both ends and senses\n";
  std::string text;
  for (const std::string& part :
       {lines_text(models) + notes_text(first.lines),
        rotary_lines_text(models) + notes_text(first.rotary_lines),
        error_motions_text(models) + notes_text(first.error_motions),
        drifts_text(models) + notes_text(first.drifts),
        diagonals_text(models) + diagonal_groups_text(models) + notes_text(first.diagonals),
        circles + circle_key + notes_text(first.circles), points_text(models) + notes_text(first.points)}) {
    if (!part.empty()) text += (text.empty() ? "" : "\n") + part;
  }
  for (const std::string& reason : sentences(first.not_recognised))
    text += "  no standard test: " + reason + '\n';
  return text;
}

}  // namespace volcal
