/// Where a model fails, in a sentence; its figures; the places, directions and times that are worst.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/text/comparison_report.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

constexpr std::size_t kPlacesShown = 14;

double nan_without(const ResidualSize& size, double ResidualSize::*figure) {
  return size.count == 0 ? std::numeric_limits<double>::quiet_NaN() : size.*figure;
}

Json size_json(const ResidualSize& size) {
  return {{"count", size.count},
          {"mean", rounded(nan_without(size, &ResidualSize::mean) * kPerMicro, 3)},
          {"rms", rounded(nan_without(size, &ResidualSize::rms) * kPerMicro, 4)},
          {"max", rounded(nan_without(size, &ResidualSize::max) * kPerMicro, 4)}};
}

Json cell_json(const ComparisonCell& cell) {
  return {{"lengths", size_json(cell.lengths)},
          {"angles", size_json(cell.angles)},
          {"reduced_chi2", cell.dof > 0.0 ? rounded(cell.reduced_chi2(), 4) : Json()},
          {"mark", cell.stands_out    ? "much worse than the rest"
                   : cell.significant ? "worse than chance"
                                      : ""}};
}

/// Worst of the last model first, of what is worse than chance.
Json places_json(std::span<const ComparedModel> models) {
  std::vector<std::pair<Grouping, const ComparisonCell*>> places;
  for (const Breakdown& breakdown : models.back().comparison.breakdowns) {
    for (const ComparisonCell& cell : breakdown.cells) {
      if (cell.significant) places.emplace_back(breakdown.by, &cell);
    }
  }
  std::ranges::stable_sort(places, std::greater<>(),
                           [](const auto& place) { return place.second->reduced_chi2(); });
  const std::size_t found = places.size();
  if (found > kPlacesShown) places.resize(kPlacesShown);
  Json rows = Json::array();
  for (const auto& [by, cell] : places) {
    Json of_models = Json::array();
    for (const ComparedModel& model : models) {
      const ComparisonCell* own = model.comparison.find_cell(by, cell->label);
      of_models.push_back(cell_json(own == nullptr ? ComparisonCell{} : *own));
    }
    rows.push_back({{"by", by.name()},
                    {"where", cell->label},
                    {"observations", cell->observations},
                    {"models", std::move(of_models)}});
  }
  return {{"found", found}, {"rows", std::move(rows)}};
}

Json heldout_json(std::span<const HeldOutModel> models) {
  Json rows = Json::array();
  for (const HeldOutModel& model : models) {
    rows.push_back({{"name", model.name},
                    {"fitted", model.fitted},
                    {"observations", model.comparison.total.observations},
                    {"total", cell_json(model.comparison.total)}});
  }
  return rows;
}

}  // namespace

Json comparison_page(const ComparisonInput& input) {
  const ComparedModel& last = input.models.back();
  const bool failing = fails(last);
  Json words = Json::array(), models = Json::array();
  for (std::size_t m = 0; m < input.models.size(); ++m) {
    const ComparedModel& model = input.models[m];
    const std::string prefix = input.models.size() > 1 ? std::string(1, "AB"[m]) + " = " : std::string();
    words.push_back(prefix + failure_sentence(model));
    models.push_back({{"name", model.name},
                      {"observations", model.comparison.total.observations},
                      {"removed", model.comparison.removed},
                      {"total", cell_json(model.comparison.total)}});
  }
  return {{"level", failing ? "bad" : "good"},
          {"headline", failing ? "The model does not explain the readings" : "No failure found"},
          {"model", last.name},
          {"words", std::move(words)},
          {"notes", sentences(input.campaign.notes)},
          {"no_tests", sentences(last.figures.not_recognised)},
          {"models", std::move(models)},
          {"cells", last.comparison.cells},
          {"places", places_json(input.models)},
          {"held_out", heldout_json(input.heldout)}};
}

}  // namespace volcal::report
