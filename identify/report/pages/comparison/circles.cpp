/// Circles of the ball-bar: radial deviations measured and predicted, both ways round, the figures of ISO
/// 230-4, and which error of the model makes how much of each.

#include <algorithm>
#include <cmath>
#include <limits>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

constexpr std::size_t kCirclesShown = 24;
constexpr std::size_t kReadingsDrawn = 1200;  // per circle
constexpr std::size_t kCausesShown = 8;

/// All readings, or where there are more than can be drawn those with the largest and the smallest measured
/// deviation of every piece of the path, so that spikes stay.
std::vector<std::size_t> drawn_readings(const std::vector<CircleReading>& readings) {
  std::vector<std::size_t> drawn;
  const std::size_t pieces = kReadingsDrawn / 2;
  const auto smaller = [](const CircleReading& a, const CircleReading& b) {
    return a.deviation < b.deviation;
  };
  const bool all = readings.size() <= kReadingsDrawn;
  for (std::size_t piece = 0; !all && piece < pieces; ++piece) {
    const auto from = readings.begin() + static_cast<std::ptrdiff_t>(piece * readings.size() / pieces);
    const auto to = readings.begin() + static_cast<std::ptrdiff_t>((piece + 1) * readings.size() / pieces);
    const auto [low, high] = std::minmax_element(from, to, smaller);
    for (const auto& at : {std::min(low, high), std::max(low, high)})
      drawn.push_back(static_cast<std::size_t>(at - readings.begin()));
  }
  for (std::size_t i = 0; all && i < readings.size(); ++i) drawn.push_back(i);
  drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
  return drawn;
}

Json deviations_json(const std::vector<CircleReading>& readings, const std::vector<std::size_t>& drawn) {
  Json json = Json::array();
  for (const std::size_t i : drawn) json.push_back(rounded(readings[i].deviation * kPerMicro, 4));
  return json;
}

Json optional_json(const std::optional<double>& value) {
  return rounded_micrometres(value.value_or(std::numeric_limits<double>::quiet_NaN()));
}

Json path_figures(const std::optional<CircularPath>& path) {
  if (!path) return nullptr;
  return {{"G", rounded_micrometres(path->circular_deviation)},
          {"F_max", rounded_micrometres(path->radial_max)},
          {"F_min", rounded_micrometres(path->radial_min)}};
}

Json circular_figures_json(const CircularFigures& figures) {
  return {{"ccw", path_figures(figures.counter_clockwise)},
          {"cw", path_figures(figures.clockwise)},
          {"G_both", optional_json(figures.bidirectional)},
          {"D", optional_json(figures.mean_radial)},
          {"B_first", optional_json(figures.mean_reversal(0))},
          {"B_second", optional_json(figures.mean_reversal(1))}};
}

/// Root mean square of readings less predictions.
double residual_rms(const CircleTest& test) {
  double squares = 0.0;
  for (std::size_t i = 0; i < test.rows.size(); ++i)
    squares += std::pow(test.radial.readings[i].deviation - test.radial.model[i].deviation, 2);
  return test.rows.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(test.rows.size()));
}

Json causes_json(const ComparedModel& model, std::size_t circle) {
  Json rows = Json::array();
  if (circle >= model.circle_causes.size()) return {{"others", 0}, {"rows", std::move(rows)}};
  const std::vector<CircleCause>& causes = model.circle_causes[circle];
  double shown = 0.0;
  for (std::size_t i = 0; i < std::min(kCausesShown, causes.size()); ++i) {
    const CircleCause& cause = causes[i];
    shown += cause.share;
    rows.push_back(
        {{"name", cause.name},
         {"range", rounded(cause.range * kPerMicro, 3)},
         {"U95", cause.range_u ? rounded(kCoverageFactor * *cause.range_u * kPerMicro, 2) : Json()},
         {"share", rounded(cause.share, 4)}});
  }
  const std::size_t others = causes.size() - std::min(kCausesShown, causes.size());
  return {{"others", others}, {"others_share", rounded(1.0 - shown, 3)}, {"rows", std::move(rows)}};
}

Json circle_json(std::span<const ComparedModel> models, std::size_t circle) {
  const CircleTest& test = models.front().figures.circles[circle];
  const std::vector<std::size_t> drawn = drawn_readings(test.radial.readings);
  Json angle = Json::array(), sense = Json::array(), list = Json::array();
  for (const std::size_t i : drawn) {
    angle.push_back(rounded(test.radial.readings[i].angle / kRadianPerDegree, 5));
    sense.push_back(test.radial.readings[i].sense);
  }
  for (const ComparedModel& model : models) {
    const CircleTest& own = model.figures.circles[circle];
    list.push_back({{"name", model.name},
                    {"predicted", deviations_json(own.radial.model, drawn)},
                    {"figures", circular_figures_json(own.figures.model)},
                    {"residual_rms", rounded(residual_rms(own) * kPerMicro, 3)},
                    {"causes", causes_json(model, circle)}});
  }
  return {{"setup", test.setup},
          {"first", std::string(1, letter_of(test.first))},
          {"second", std::string(1, letter_of(test.second))},
          {"radius_mm", rounded(test.radius * kPerMilli, 5)},
          {"readings", test.rows.size()},
          {"drawn", drawn.size()},
          {"least_squares_centre", test.figures.readings.centring == Centring::LeastSquares},
          {"angle", std::move(angle)},
          {"sense", std::move(sense)},
          {"measured", deviations_json(test.radial.readings, drawn)},
          {"figures", circular_figures_json(test.figures.readings)},
          {"models", std::move(list)},
          {"notes", sentences(test.notes)}};
}

}  // namespace

Json circles_page(const ComparisonInput& input) {
  const auto& tests = input.models.front().figures.circles;
  if (tests.empty()) return nullptr;
  Json circles = Json::array();
  for (std::size_t i = 0; i < std::min(kCirclesShown, tests.size()); ++i)
    circles.push_back(circle_json(input.models, i));
  return {{"total", tests.size()}, {"circles", std::move(circles)}};
}

}  // namespace volcal::report
