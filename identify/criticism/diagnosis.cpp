#include "volcal/identify/criticism/diagnosis.h"

#include <algorithm>
#include <iterator>

#include "volcal/identify/criticism/alternative_sets.h"
#include "volcal/identify/criticism/catalogue/not_looked_for.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/figures/diagnosis_figures.h"
#include "volcal/identify/criticism/formulas/formula_search.h"
#include "volcal/identify/criticism/proposals/confounding.h"
#include "volcal/identify/criticism/proposals/next_measurement.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/search.h"
#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/identify/criticism/surface_findings.h"
#include "volcal/identify/criticism/verdict.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/result/left_out_findings.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

SearchOptions search_options(const DiagnoseOptions& options) {
  return {.threads = thread_count(options.threads),
          .most = options.most_effects,
          .climb = options.climb,
          .leave_out = options.leave_out,
          .own = options.own,
          .rules = options.rules,
          .progress = options.progress};
}

std::vector<RemovedReading> removed_readings(const LinearModel& model) {
  std::vector<std::size_t> removed = model.removed();
  std::ranges::sort(removed);
  std::vector<RemovedReading> readings;
  for (const std::size_t observation : removed) {
    const auto& [of_setup, row, channel] = model.observations()[observation];
    const Setup& setup = model.campaign().setups[of_setup];
    readings.push_back(
        {setup.name, setup.readings.source_line[row], std::string(channel_column(setup, channel))});
  }
  return readings;
}

Remarks remarks(const Search& search) {
  Remarks remarks{.more_is_known = search.more_is_known(),
                  .rejected = {},
                  .removed_by_fit = search.given().model().removed().size()};
  for (const auto& each : search.rejected()) remarks.rejected.push_back(each.second);
  return remarks;
}

/// What the readings can separate, and what would have to be measured for the rest.
void compare_hypotheses(const ModelState& reached, const FitResult& result, const PlanningOptions& planning,
                        Diagnosis& diagnosis) {
  const SearchSetting& setting = reached.setting();
  const NoiseData data = without(reached.model().problem().data, setting.heldout);
  const CriticismState state{reached.model(),
                             result,
                             data,
                             reached.projector(),
                             reached.noise(),
                             setting.families,
                             reached.tests().families,
                             setting.log10_level(),
                             kThresholds.power,
                             setting.threads};
  add_confounding(state, diagnosis);
  add_next_measurements(state, planning, diagnosis);
}

Diagnosis diagnosis_by(Search search, const FitResult& result, const DiagnoseOptions& options) {
  const auto progress = [&](const std::string& stage, double done) {
    if (options.progress) options.progress(stage, done);
  };
  search.run();
  const ModelState& reached = search.reached();
  const Campaign& campaign = reached.model().campaign();
  Diagnosis diagnosis;
  diagnosis.removed_readings = removed_readings(reached.model());
  diagnosis.notes = campaign.notes;
  diagnosis.not_looked_for = not_looked_for(campaign, reached.setting().families);
  diagnosis.families = reached.setting().families.size();
  diagnosis.generic_tests = reached.tests().scans.size();
  diagnosis.ladder = ladder_of(reached);
  list_added(reached, diagnosis);
  diagnosis.sets = alternative_sets(reached, result);
  list_detectable(search.given(), diagnosis);
  list_ranking(reached, diagnosis);
  list_tried(reached, options.own, diagnosis);
  diagnosis.unknown = unknown_findings(reached, search.rejected());
  diagnosis.surfaces = surface_findings(reached);
  for (std::size_t i = 0; i < reached.surfaces().size(); ++i)
    diagnosis.unknown.insert(diagnosis.unknown.begin() + static_cast<std::ptrdiff_t>(i),
                             reached.surfaces()[i].finding);
  for (const EffectSpec& surface : options.asked_laws)
    diagnosis.asked_laws.push_back(asked_laws(reached, surface));
  diagnosis.noise = noise_table(reached.noise_with_uncertainty());
  diagnosis.noise_instruments = reached.model().noise_groups();
  conclude(remarks(search), diagnosis);
  std::ranges::move(left_out_findings(campaign), std::back_inserter(diagnosis.findings));
  if (options.compare) {
    progress("confounding", 0.95);
    compare_hypotheses(reached, result, options.planning, diagnosis);
  }
  conclude_tried(diagnosis);
  if (options.figures) diagnosis.figures = diagnosis_figures(search.given(), reached);
  progress("done", 1.0);
  return diagnosis;
}

}  // namespace

DiagnosedModel diagnose_model(const Campaign& campaign, const ModelSpec& model,
                              const DiagnoseOptions& options) {
  constexpr double kShareOfFit = 0.3;
  FitOptions fit_options;
  fit_options.threads = options.threads;
  fit_options.outliers = OutlierPolicy::Remove;
  fit_options.noise = NoisePolicy::White;
  DiagnoseOptions after = options;
  if (options.progress) {
    fit_options.progress = [&](const std::string& stage, double done) {
      options.progress("fit: " + stage, kShareOfFit * done);
    };
    after.progress = [&](const std::string& stage, double done) {
      options.progress(stage, kShareOfFit + (1.0 - kShareOfFit) * done);
    };
  }
  DiagnosedModel diagnosed{fit(campaign, model, fit_options), {}};
  diagnosed.diagnosis = diagnose(campaign, diagnosed.fit, after);
  return diagnosed;
}

Diagnosis diagnose(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options) {
  const LinearModel model(campaign, result);
  for (const EffectSpec& surface : options.asked_laws) check_asked_surface(model, surface);
  return diagnosis_by(Search(model, heldout_lines(model, options.heldout_share), search_options(options)),
                      result, options);
}

Diagnosis diagnose(const FitResult& result, const ModelState& given, const DiagnoseOptions& options) {
  for (const EffectSpec& surface : options.asked_laws) check_asked_surface(given.model(), surface);
  return diagnosis_by(Search(given, search_options(options)), result, options);
}

}  // namespace volcal
