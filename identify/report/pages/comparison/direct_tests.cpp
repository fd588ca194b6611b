/// Direct tests of rotary axes and drift at rest: error motions over a turn, measured and predicted, and the
/// figures of ISO 230-7 and ISO 230-3.

#include <algorithm>
#include <cmath>
#include <optional>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/standards/rotary_test_names.h"
#include "volcal/identify/statistics/even_sample.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

constexpr std::size_t kPlotsShown = 24;
constexpr std::size_t kPlacesDrawn = 360;

Json micro_or_null(const std::optional<double>& value) {
  return value ? rounded_micrometres(*value) : Json();
}

Json motion_figures(const std::string& name, const ErrorMotionFigures& figures) {
  return {{"name", name},
          {"total", micro_or_null(figures.total)},
          {"synchronous", micro_or_null(figures.synchronous)},
          {"asynchronous", micro_or_null(figures.asynchronous)},
          {"fundamental", micro_or_null(figures.fundamental)}};
}

Json drawn_values(const std::vector<RotationReading>& plot, const std::vector<std::size_t>& drawn) {
  Json values = Json::array();
  for (const std::size_t i : drawn) values.push_back(rounded(plot[i].value * kPerMicro, 4));
  return values;
}

Json motion_test_json(std::span<const ComparedModel> models, std::size_t test_index) {
  const ErrorMotionTest& test = models.front().figures.error_motions[test_index];
  const std::vector<std::size_t> drawn = even_sample(test.plots.readings.size(), kPlacesDrawn);
  Json angle = Json::array(), sources = Json::array();
  for (const std::size_t i : drawn)
    angle.push_back(rounded(test.plots.readings[i].angle * position_factor(test.axis), 6));
  sources.push_back(motion_figures("measured", test.figures.readings));
  sources.back()["value"] = drawn_values(test.plots.readings, drawn);
  for (const ComparedModel& model : models) {
    const ErrorMotionTest& own = model.figures.error_motions[test_index];
    sources.push_back(motion_figures(model.name, own.figures.model));
    sources.back()["value"] = drawn_values(own.plots.model, drawn);
  }
  return {{"setup", test.setup},           {"axis", axis_letter(test.axis)},
          {"motion", motion_name(test)},   {"unit", test.is_angle() ? "µrad" : "µm"},
          {"angle", std::move(angle)},     {"sources", std::move(sources)},
          {"notes", sentences(test.notes)}};
}

Json drift_figures_json(const std::string& name, const DriftFigures& figures) {
  constexpr double kHours = 1.0 / 3600.0;
  return {{"name", name},
          {"hours", rounded(figures.duration * kHours, 3)},
          {"range", micro_or_null(figures.range)},
          {"first_hour", micro_or_null(figures.first_hour)},
          {"any_hour", micro_or_null(figures.fastest_in_an_hour)},
          {"change", micro_or_null(figures.change)}};
}

/// Less the first reading, at the times drawn.
Json drift_curve(const std::vector<DriftReading>& plot, const std::vector<std::size_t>& drawn) {
  Json values = Json::array();
  for (const std::size_t i : drawn)
    values.push_back(rounded((plot[i].value - plot.front().value) * kPerMicro, 4));
  return values;
}

Json drift_test_json(std::span<const ComparedModel> models, std::size_t test_index) {
  const DriftTest& test = models.front().figures.drifts[test_index];
  const std::vector<std::size_t> drawn = even_sample(test.plots.readings.size(), kPlacesDrawn);
  Json hours = Json::array();
  for (const std::size_t i : drawn)
    hours.push_back(
        rounded((test.plots.readings[i].time - test.plots.readings.front().time) / kSecondsPerHour, 5));
  Json sources = Json::array({drift_figures_json("measured", test.figures.readings)});
  sources.back()["value"] = drift_curve(test.plots.readings, drawn);
  for (const ComparedModel& model : models) {
    const DriftTest& own = model.figures.drifts[test_index];
    sources.push_back(drift_figures_json(model.name, own.figures.model));
    sources.back()["value"] = drift_curve(own.plots.model, drawn);
  }
  return {{"setup", test.setup},
          {"time", std::move(hours)},
          {"drift", drift_name(test)},
          {"unit", test.angle ? "µrad" : "µm"},
          {"temperatures", temperatures_text(test)},
          {"sources", std::move(sources)},
          {"notes", sentences(test.notes)}};
}

}  // namespace

Json direct_tests_page(const ComparisonInput& input) {
  const StandardFigures& first = input.models.front().figures;
  if (first.error_motions.empty() && first.drifts.empty()) return nullptr;
  Json motions = Json::array(), drifts = Json::array();
  for (std::size_t i = 0; i < std::min(kPlotsShown, first.error_motions.size()); ++i)
    motions.push_back(motion_test_json(input.models, i));
  for (std::size_t i = 0; i < first.drifts.size(); ++i) drifts.push_back(drift_test_json(input.models, i));
  return {
      {"total", first.error_motions.size()}, {"motions", std::move(motions)}, {"drifts", std::move(drifts)}};
}

}  // namespace volcal::report
