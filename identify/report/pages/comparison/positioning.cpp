/// Positioning along the axes and along diagonals: deviations at the targets from both sides, measured and
/// predicted, and the figures of ISO 230-2.

#include <algorithm>
#include <limits>
#include <optional>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/statistics/even_sample.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

constexpr std::size_t kCardsShown = 36;
constexpr std::size_t kTargetsDrawn = 240;  // per card

double number_or_nan(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

Json micrometre_json(const std::optional<double>& value) { return rounded_micrometres(number_or_nan(value)); }

Json approach_json(const PositioningFigures& figures, const std::vector<std::size_t>& drawn,
                   ApproachStatistics PositioningTarget::*side) {
  Json mean = Json::array(), s = Json::array(), count = Json::array();
  for (const std::size_t i : drawn) {
    const ApproachStatistics& at = figures.targets[i].*side;
    mean.push_back(at.count > 0 ? rounded(at.mean * kPerMicro, 4) : Json());
    s.push_back(micrometre_json(at.deviation_s));
    count.push_back(at.count);
  }
  return {{"mean", std::move(mean)}, {"s", std::move(s)}, {"count", std::move(count)}};
}

Json side_figures(const UnidirectionalFigures& figures) {
  return {{"A", micrometre_json(figures.accuracy)},
          {"E", micrometre_json(figures.systematic)},
          {"R", micrometre_json(figures.repeatability)}};
}

/// Of readings or of a model; both have the same targets.
Json source_json(const std::string& name, const PositioningFigures& figures,
                 const std::vector<std::size_t>& drawn) {
  return {{"name", name},
          {"positive", approach_json(figures, drawn, &PositioningTarget::positive)},
          {"negative", approach_json(figures, drawn, &PositioningTarget::negative)},
          {"both",
           {{"A", micrometre_json(figures.accuracy)},
            {"E", micrometre_json(figures.systematic)},
            {"R", micrometre_json(figures.repeatability)},
            {"M", micrometre_json(figures.mean_bidirectional)},
            {"B", micrometre_json(figures.reversal)},
            {"mean_B", micrometre_json(figures.mean_reversal)}}},
          {"forward", side_figures(figures.positive)},
          {"reverse", side_figures(figures.negative)}};
}

struct Source {
  std::string name;
  const PositioningFigures* figures;
};

/// What a card is about; positions are multiplied by `factor`.
struct CardWords {
  std::string title;
  std::string setup;
  std::string abscissa;
  double factor = kPerMilli;
  std::string unit = "µm";
};

Json card_json(const CardWords& words, const std::vector<Source>& sources,
               const std::vector<Finding>& notes) {
  const std::vector<PositioningTarget>& targets = sources.front().figures->targets;
  const std::vector<std::size_t> drawn = even_sample(targets.size(), kTargetsDrawn);
  Json position = Json::array(), list = Json::array();
  for (const std::size_t i : drawn) position.push_back(rounded(targets[i].position * words.factor, 6));
  for (const Source& source : sources) list.push_back(source_json(source.name, *source.figures, drawn));
  return {{"title", words.title},       {"setup", words.setup},      {"abscissa", words.abscissa},
          {"unit", words.unit},         {"targets", targets.size()}, {"position", std::move(position)},
          {"sources", std::move(list)}, {"notes", sentences(notes)}};
}

/// Readings first, then the models. `figures_of(model)`: the test's figures of that model.
template <class FiguresOf>
std::vector<Source> sources_of(std::span<const ComparedModel> models, FiguresOf figures_of) {
  std::vector<Source> sources = {{"measured", &figures_of(models.front()).readings}};
  for (const ComparedModel& model : models) sources.push_back({model.name, &figures_of(model).model});
  return sources;
}

SideBySide<const PositioningFigures*> diagonal_pair(const DiagonalTest& test) {
  return {&test.figures.readings.positioning, &test.figures.model.positioning};
}

Json groups_json(std::span<const ComparedModel> models) {
  const auto summary = [](const std::string& name, const DiagonalSummary& of) {
    return Json{{"name", name}, {"E", micrometre_json(of.systematic)}, {"B", micrometre_json(of.reversal)}};
  };
  Json groups = Json::array();
  const auto& first = models.front().figures.diagonal_groups;
  for (std::size_t g = 0; g < first.size(); ++g) {
    Json sources = Json::array();
    sources.push_back(summary("measured", first[g].summary.readings));
    for (const ComparedModel& model : models)
      sources.push_back(summary(model.name, model.figures.diagonal_groups[g].summary.model));
    groups.push_back({{"axes", (first[g].axes.size() == 3 ? "body " : "face ") + letters_of(first[g].axes)},
                      {"number", first[g].summary.readings.diagonals},
                      {"sources", std::move(sources)}});
  }
  return groups;
}

std::string titled(const std::string& axis, const std::string& place) {
  return axis + (place.empty() ? "" : " at " + place);
}

Json rotary_cards(const ComparisonInput& input) {
  Json cards = Json::array();
  const auto& tests = input.models.front().figures.rotary_lines;
  for (std::size_t i = 0; i < std::min(kCardsShown, tests.size()); ++i) {
    const auto sources =
        sources_of(input.models, [&](const ComparedModel& model) -> const SideBySide<PositioningFigures>& {
          return model.figures.rotary_lines[i].figures;
        });
    const std::string axis = axis_letter(tests[i].axis);
    cards.push_back(card_json({.title = titled(axis, tests[i].place),
                               .setup = tests[i].setup,
                               .abscissa = axis + " [°]",
                               .factor = position_factor(tests[i].axis),
                               .unit = "µrad"},
                              sources, tests[i].notes));
    cards.back()["axis"] = axis;
  }
  return cards;
}

}  // namespace

Json positioning_page(const ComparisonInput& input) {
  const auto& tests = input.models.front().figures.lines;
  const auto& rotary = input.models.front().figures.rotary_lines;
  if (tests.empty() && rotary.empty()) return nullptr;
  Json cards = rotary_cards(input);
  for (std::size_t i = 0; i < std::min(kCardsShown, tests.size()); ++i) {
    const AxisLineTest& test = tests[i];
    const auto sources =
        sources_of(input.models, [&](const ComparedModel& model) -> const SideBySide<PositioningFigures>& {
          return model.figures.lines[i].figures;
        });
    const std::string axis(1, letter_of(test.axis));
    cards.push_back(
        card_json({.title = titled(axis, test.place), .setup = test.setup, .abscissa = axis + " [mm]"},
                  sources, test.notes));
    cards.back()["axis"] = axis;
  }
  return {{"total", tests.size() + rotary.size()}, {"cards", std::move(cards)}};
}

Json diagonals_page(const ComparisonInput& input) {
  const auto& tests = input.models.front().figures.diagonals;
  if (tests.empty()) return nullptr;
  Json cards = Json::array();
  for (std::size_t i = 0; i < std::min(kCardsShown, tests.size()); ++i) {
    std::vector<Source> sources = {{"measured", diagonal_pair(tests[i]).readings}};
    for (const ComparedModel& model : input.models)
      sources.push_back({model.name, diagonal_pair(model.figures.diagonals[i]).model});
    const std::string& name = tests[i].figures.readings.name;
    cards.push_back(card_json(
        {.title = "Diagonal " + name, .setup = tests[i].setup, .abscissa = "along " + name + " [mm]"},
        sources, tests[i].notes));
  }
  return {{"total", tests.size()}, {"groups", groups_json(input.models)}, {"cards", std::move(cards)}};
}

}  // namespace volcal::report
