#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/identify/criticism/surface_findings.h"
#include "volcal/identify/session/session_effects.h"
#include "volcal/identify/session/session_tree.h"
#include "volcal/identify/session/session_work.h"
#include "volcal/identify/statistics/normal.h"

namespace volcal {
namespace {

constexpr double kContradiction = 0.25;     // of U95: a preview that is off by more was wrong
constexpr double kShareOfSearch = 0.8;      // of the time of a climb
constexpr std::size_t kPrepared = 2;        // of the ranking
constexpr std::size_t kPreparedOfMany = 1;  // 15 s of a processor and 600 MB at 10^5 readings
constexpr std::size_t kManyReadings = 30000;

std::vector<EffectFinding> with(std::vector<EffectFinding> effects, EffectFinding more) {
  effects.push_back(std::move(more));
  return effects;
}

std::vector<EffectFinding> without(std::vector<EffectFinding> effects, std::size_t place) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(place));
  return effects;
}

/// By a full fit, which a linear preview should have foreseen; the amplitude that is off by most of its U.
std::optional<Contradiction> contradiction_of(ModelStanding of, const EffectFinding& preview,
                                              const EffectFinding& fitted) {
  std::optional<Contradiction> worst;
  double most = kContradiction * kCoverageFactor;
  for (std::size_t k = 0; k < std::min(preview.amplitudes.size(), fitted.amplitudes.size()); ++k) {
    const AmplitudeFigure& before = preview.amplitudes[k];
    const AmplitudeFigure& after = fitted.amplitudes[k];
    const double miss = std::abs(before.value - after.value);
    if (miss <= most * after.u) continue;
    most = miss / after.u;
    worst = {of, after.label, before.value, after.value, after.u, after.unit, after.si_per_unit};
  }
  return worst;
}

/// What a scan sees best as a rotation may be a displacement along its direction: both are drawn, and the
/// readings decide.
std::vector<UnknownFinding> along_and_as(const UnknownFinding& finding) {
  std::vector<UnknownFinding> both{finding};
  if (!finding.rotation) return both;
  both.push_back(finding);
  both.back().rotation.reset();
  return both;
}

/// Parameters that the readings in use determine, and no fewer readings than these and one.
void require_readings(const Session& session, const std::vector<bool>& selected) {
  const FitResult& result = session.fitted_result();
  const std::vector<double>& sigma = session.linear().problem().data.sigma;
  std::size_t before = 0, remaining = 0;
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    if (!std::isfinite(sigma[i])) continue;
    ++before;
    if (i >= selected.size() || !selected[i]) ++remaining;
  }
  const double parameters = std::max(0.0, static_cast<double>(before) - result.dof);
  if (static_cast<double>(remaining) > parameters) return;
  const std::string what = remaining == 0   ? "no reading would remain"
                           : remaining == 1 ? "1 reading would remain"
                                            : std::to_string(remaining) + " readings would remain";
  throw InputError({},
                   what + ", and this model needs more than " +
                       std::to_string(static_cast<long long>(std::ceil(parameters))),
                   "leave out fewer readings, or begin with a model of fewer errors");
}

/// Marks observations as left out. The number of those that were not yet.
std::size_t leave_out(const LinearModel& model, const std::vector<bool>& selected, const std::string& reason,
                      Campaign& campaign) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(selected.size(), model.size()); ++i) {
    if (!selected[i]) continue;
    const auto& [setup, row, channel] = model.observations()[i];
    std::vector<LeftOutReading>& known = campaign.setups[setup].left_out;
    const std::pair place{row, static_cast<std::size_t>(channel)};
    const auto at = std::ranges::lower_bound(known, place, {}, [](const LeftOutReading& each) {
      return std::pair{each.row, each.channel};
    });
    if (at != known.end() && std::pair{at->row, at->channel} == place) continue;
    known.insert(at, {place.first, place.second, reason});
    ++count;
  }
  return count;
}

}  // namespace

/// The current model with an effect more: what is prepared, or made here.
std::shared_ptr<const Session::Node> Session::node_with(const FamilyTest& test) {
  const Node& here = node();
  const SearchSetting& setting = *here.recipe.setting;
  const auto known = here.prepared.find(setting.families[test.family].name());
  if (known != here.prepared.end()) return known->second;
  return std::make_shared<const Node>(here.with(test, finding(setting, test)));
}

SessionWork Session::preparation() {
  renew_setting();
  const SearchSetting& setting = *node().recipe.setting;
  const std::size_t most = linear().size() > kManyReadings ? kPreparedOfMany : kPrepared;
  std::map<EffectName, std::shared_ptr<const Node>> ahead;
  for (const FamilyTest* test : ranked()) {
    if (ahead.size() == most || setting.family_wise_log10_p(*test) > log10_family_risk()) break;
    const Family& family = setting.families[test->family];
    if (!family.effect) continue;
    std::shared_ptr<const Node> next = node_with(*test);
    next->shared_refit(least_of(next->recipe));
    ahead.emplace(family.name(), std::move(next));
  }
  node().prepared = ahead;
  return interruptible([ahead = std::move(ahead), least = least_of(node().recipe), base = node().recipe.base,
                        setting = node().recipe.setting,
                        number = current_](const SessionProgress& progress) -> SessionChange {
    double done = 0.0;
    for (const auto& [effect, next] : ahead) {
      report_stage(progress, next->effects.back().label, done);
      next->shared_refit(least)->get(progress).tests->get_unless_stopped();
      done += 1.0 / static_cast<double>(ahead.size());
    }
    return [base, setting, number](Session& session) {
      Node& of = *session.nodes_[number];
      if (session.current_ == number && of.recipe.base == base && of.recipe.setting == setting)
        of.is_prepared = true;
    };
  });
}

bool Session::is_prepared() const { return node().is_prepared; }

const SessionModel& Session::add(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  if (test.score.dof == 0) {
    const EffectFinding hidden = finding(*node().recipe.setting, test);
    const Explanation why = why_not_visible({hidden}).front();
    throw InputError({}, hidden.label + " is not visible: " + why.reason, why.remedy);
  }
  const std::string change = "+ " + node().recipe.setting->families[test.family].label();
  return append(current_, std::make_unique<Node>(*node_with(test)), change, ModelStanding::Preview);
}

bool Session::is_preview(const EffectName& effect) const { return place_of(effect) >= node().in_base(); }

const SessionModel& Session::remove_preview(const EffectName& effect) {
  const std::size_t place = place_of(effect);
  const Node& here = node();
  if (place < here.in_base()) throw std::invalid_argument(full_name(effect) + " is part of a full fit");
  auto next = std::make_unique<Node>(here.recipe.base, without(here.effects, place));
  Recipe recipe = here.recipe;
  recipe.added.erase(recipe.added.begin() + static_cast<std::ptrdiff_t>(place - here.in_base()));
  recipe.refit = nullptr;  // its noise was found with the effect
  next->becomes(std::move(recipe));
  const auto standing = next->recipe.added.empty() ? ModelStanding::Fitted : ModelStanding::Preview;
  return append(current_, std::move(next), "- " + here.effects[place].label, standing);
}

bool Session::was_given(const EffectName& effect) const {
  return std::ranges::any_of(given_.effects, [&](const EffectSpec& spec) { return name_of(spec) == effect; });
}

/// A full fit with these effects, those of the given model among them.
SessionWork Session::fit_of(const std::shared_ptr<const Campaign>& campaign,
                            const std::vector<EffectFinding>& effects, const std::string& change) const {
  const ModelSpec model = given_model_with(given_, *campaign, effects);
  return interruptible([=, fit_it = fitting(campaign), parent = current_](const SessionProgress& progress) {
    return appending(parent, fit_it(campaign, model, progress), effects, change);
  });
}

SessionWork Session::removal(const EffectName& effect) const {
  const std::size_t place = place_of(effect);
  return fit_of(node().recipe.base->campaign(), without(node().effects, place),
                "- " + node().effects[place].label);
}

SessionWork Session::confirmation(std::size_t number) const {
  const auto campaign = nodes_.at(number)->recipe.base->campaign();
  return interruptible([fit_it = fitting(campaign), campaign,
                        model = given_model_with(given_, *campaign, models_[number].effects),
                        number](const SessionProgress& progress) -> SessionChange {
    const FittedModel found = fit_it(campaign, model, progress);
    return [found, number](Session& session) {
      SessionModel& shown = session.models_[number];
      Node& here = *session.nodes_[number];
      if (!awaits_full_fit(shown.standing)) return;
      for (std::size_t i = here.in_base(); i < here.effects.size() && !shown.contradiction; ++i)
        shown.contradiction =
            contradiction_of(shown.standing, shown.effects[i], found.fitted->fitted(here.effects[i]));
      session.put_in_place(found);
      here.becomes({found.fitted, found.fitted->setting(), {}});
      shown.standing = shown.contradiction ? ModelStanding::Contradicted : ModelStanding::Fitted;
      session.describe(here, shown);
      session.go(session.current_);
    };
  });
}

SessionWork Session::refit(std::size_t number) const {
  const Node& of = *nodes_.at(number);
  return interruptible([base = of.recipe.base, changes = !of.recipe.added.empty(),
                        refit = of.shared_refit(least_of(of.recipe)),
                        number](const SessionProgress& progress) -> SessionChange {
    if (!changes) return [](Session&) {};
    report_stage(progress, "noise with what was added", 0.1);
    const RefittedModel& found = refit->get(progress);
    report_stage(progress, "done", 1.0);
    return [found, base, number](Session& session) {
      SessionModel& shown = session.models_[number];
      Node& here = *session.nodes_[number];
      if (shown.standing != ModelStanding::Preview || here.recipe.base != base) return;
      here.becomes(found);
      shown.standing = ModelStanding::Refitted;
      session.describe(here, shown);
    };
  });
}

SessionWork Session::drawing(std::size_t which) {
  const UnknownFinding wanted = unknown().at(which);
  return interruptible(
      [wanted, state = scanned(), number = current_](const SessionProgress& progress) -> SessionChange {
        report_stage(progress, "a surface for what has no name", 0.1);
        const std::optional<SurfaceTest> test = best_surface(state, along_and_as(wanted));
        if (!test) throw std::invalid_argument("no surface explains what depends on " + wanted.dependence());
        report_stage(progress, "noise with the surface", 0.4);
        const ModelState with = state.with_surface(*test, state.added()).tested();
        report_stage(progress, "laws behind it", 0.8);
        SurfaceFinding drawn = surface_findings(with).back();
        report_stage(progress, "done", 1.0);
        return [drawn = std::move(drawn), number](Session& session) {
          std::vector<SurfaceFinding>& known = session.nodes_[number]->drawn;
          std::erase_if(known, [&](const SurfaceFinding& each) { return each.name == drawn.name; });
          known.push_back(drawn);
        };
      });
}

const std::vector<SurfaceFinding>& Session::drawn() const { return node().drawn; }

SessionWork Session::surface(const EffectName& name) const {
  const auto found = std::ranges::find(node().drawn, name, &SurfaceFinding::name);
  if (found == node().drawn.end()) throw std::invalid_argument(full_name(name) + " was not drawn");
  EffectFinding added;
  added.name = found->name;
  added.label = found->label;
  added.spec = found->spec;
  be_untested(added);
  return fit_of(node().recipe.base->campaign(), with(current().effects, std::move(added)),
                "+ " + found->label);
}

SessionWork Session::leaving_out(const std::vector<bool>& selected, const std::string& reason) const {
  auto campaign = std::make_shared<Campaign>(this->campaign());
  const std::size_t count = leave_out(linear(), selected, reason, *campaign);
  if (count == 0) throw std::invalid_argument("no reading is marked that is not left out already");
  require_readings(*this, selected);
  return fit_of(campaign, current().effects,
                "- " + std::to_string(count) + (count == 1 ? " reading: " : " readings: ") + reason);
}

DiagnosisWork Session::diagnosis(DiagnoseOptions options) const {
  options.threads = options_.threads;
  options.heldout_share = options_.heldout_share;
  return [options = std::move(options), base = node().recipe.base, model = model(),
          is_fitted = !awaits_full_fit(current().standing)](const SessionProgress& progress) {
    DiagnoseOptions told = options;
    told.progress = [&](const std::string& stage, double done) { report_stage(progress, stage, done); };
    if (!is_fitted) return diagnose_model(*base->campaign(), model, told);
    return DiagnosedModel{base->result(), diagnose(base->result(), base->state(), told)};
  };
}

SessionWork Session::climb() const {
  DiagnoseOptions options;
  options.climb = true;
  options.own = own_;
  options.figures = options.compare = false;
  return interruptible([diagnosis = diagnosis(options), fit_it = fitting(node().recipe.base->campaign()),
                        campaign = node().recipe.base->campaign(), given = given_,
                        effects = current().effects,
                        parent = current_](const SessionProgress& progress) -> SessionChange {
    const SessionProgress of_search = [&](const std::string& stage, double done) {
      return !progress || progress(stage, kShareOfSearch * done);
    };
    const std::vector<EffectFinding> found = accepted_effects(diagnosis(of_search).diagnosis);
    std::vector<SessionChange> changes;
    std::vector<EffectFinding> all = effects;
    Fitting fit_next = fit_it;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double from = kShareOfSearch +
                          (1.0 - kShareOfSearch) * static_cast<double>(i) / static_cast<double>(found.size());
      const SessionProgress part = [&](const std::string& stage, double /*done*/) {
        return !progress || progress(found[i].label + ": " + stage, from);
      };
      all.push_back(found[i]);
      const FittedModel made = fit_next(campaign, given_model_with(given, *campaign, all), part);
      fit_next.before.push_back({made.fitted, made.fitted->setting(), {}});
      fit_next.least_variance = std::min(fit_next.least_variance, made.fitted->noise_variance());
      changes.push_back(
          [made, all, change = "+ " + found[i].label, parent, first = i == 0](Session& session) {
            appending(first ? parent : session.current_, made, all, change)(session);
          });
    }
    return [changes = std::move(changes)](Session& session) {
      for (const SessionChange& change : changes) change(session);
    };
  });
}

}  // namespace volcal
