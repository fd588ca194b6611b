#include "volcal/identify/criticism/search/surface_search.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/solve/priors/evidence.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/kinds/open/empirical.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr std::size_t kMostFindings = 4;

/// What variables of a scan are in the table of an empirical effect.
struct Table {
  std::vector<Variable> drivers;
  std::vector<Variable> factors;
  std::string only;
  std::string station;   ///< that moves
  bool complete = true;  ///< every variable has its place

  /// The station itself moves, and not what is measured from it.
  bool moves_station(const UnknownFinding& finding) const {
    return !station.empty() && !finding.rotation && finding.direction != ScanDirection::Beam;
  }
  void add(const Variable& variable) {
    switch (variable.kind) {
      case Variable::Kind::Position:
      case Variable::Kind::Length:
      case Variable::Kind::Feed:
      case Variable::Kind::Time:
      case Variable::Kind::Temperature:
      case Variable::Kind::TravelSinceTurning:
      case Variable::Kind::ToolLength:
      case Variable::Kind::ToolOffset:
        return drivers.push_back(variable);
      case Variable::Kind::Direction:
        return factors.push_back(variable);
      case Variable::Kind::Tool:
        only = variable.name();
        return;
      case Variable::Kind::Station:
        only = variable.name();
        station = variable.subject;
        return;
      case Variable::Kind::Speed:
      case Variable::Kind::Elevation:
      case Variable::Kind::Run:
      case Variable::Kind::Instrument:
        complete = false;
    }
  }
};

/// First column of an instrument that measures distances.
std::string beam_column(const Campaign& campaign) {
  for (const Setup& setup : campaign.setups) {
    if (traits_of(setup).laser_length != LaserLength::Distance) continue;
    return find_instrument(setup.instrument)->schema().column_sets[setup.readings.column_set].front().column;
  }
  return {};
}

/// What moves along the direction of a finding: the error motion along it of the axis of that name, a station
/// against it, or the reading itself.
std::string target_of(const Campaign& campaign, const UnknownFinding& finding, const Table& table) {
  if (finding.rotation) return finding.rotation->name();
  if (finding.direction == ScanDirection::Beam) return beam_column(campaign);
  const AxisName axis = kLinearAxes[index_of(finding.direction)];
  if (table.moves_station(finding)) return "station " + table.station + " " + lower_letter_of(axis);
  if (!campaign.machine.has_axis(axis)) return {};
  return ErrorSymbol{positioning_component(axis), axis}.name();
}

std::optional<EffectSpec> spec_for(const LinearModel& model, const UnknownFinding& finding,
                                   const std::vector<Variable>& variables) {
  Table table;
  for (const Variable& variable : variables) table.add(variable);
  const std::string target = target_of(model.campaign(), finding, table);
  if (target.empty() || table.drivers.empty() || !table.complete) return std::nullopt;
  EffectSpec spec = surface_spec(target, written_list(table.drivers));
  if (!table.factors.empty()) spec.options.set("factor", written_list(table.factors));
  if (!table.only.empty() && !table.moves_station(finding)) spec.options.set("only", table.only);
  try {
    return empirical_effect().resolved(spec, model.views(), {});
  } catch (const InputError&) {
    return std::nullopt;  // a driver that does not change where the effect acts
  }
}

}  // namespace

std::vector<EffectSpec> surfaces_for(const LinearModel& model, const UnknownFinding& finding) {
  std::vector<std::vector<Variable>> sets;
  if (finding.with_one_of.empty()) {
    sets.push_back(finding.variables);
    if (finding.variables.size() > 1) {
      for (const Variable& variable : finding.variables) sets.push_back({variable});
    }
  } else {
    sets.push_back(finding.variables);
    for (const Variable& other : finding.with_one_of) {
      sets.push_back(finding.variables);
      sets.back().push_back(other);
    }
  }
  for (const Variable& variable : finding.variables) {
    // What a direction drives may follow the travel since the axis turned, which no scan goes through.
    if (variable.kind == Variable::Kind::Direction)
      sets.push_back({variable, {.kind = Variable::Kind::TravelSinceTurning, .axis = variable.axis}});
  }
  std::vector<EffectSpec> specs;
  for (const auto& variables : sets) {
    if (auto spec = spec_for(model, finding, variables)) specs.push_back(*std::move(spec));
  }
  return specs;
}

ProjectedColumns projected_effect(const LinearModel& model, const Projector& projector,
                                  const Effect& effect) {
  const auto count = static_cast<Eigen::Index>(effect.amplitudes().size());
  return projector.project({count, {count}, [&](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
                              model.columns(effect, effect.shape_values(), part, rows);
                            }});
}

double surface_evidence(const LinearModel& model, const Projector& projector, const Effect& surface) {
  const auto count = static_cast<Eigen::Index>(surface.amplitudes().size());
  const ProjectedColumns projected = projected_effect(model, projector, surface);
  const NoiseGroupEquations equations{projected.gram(0, count), -projected.score, 0.0,
                                      static_cast<double>(projector.observations())};
  std::vector<SmoothingTerm> terms = {surface_term(*surface.surface(), 0)};
  return maximise_evidence({equations}, Eigen::VectorXd::Zero(count),
                           GaussianPrior::none(static_cast<int>(count)), {.variance_components = false},
                           {1.0}, terms)
      .log_evidence;
}

namespace {

/// The variables of every leading finding on the target of every other: a scan may see an effect best through
/// another target than its own.
std::vector<UnknownFinding> combinations(const SearchRules& rules,
                                         const std::vector<UnknownFinding>& findings) {
  const std::span leading(findings.data(), std::min(findings.size(), kMostFindings));
  std::vector<UnknownFinding> all(leading.begin(), leading.end());
  if (!rules.follows(SearchRule::CrossedFindings)) return all;
  for (const UnknownFinding& of_target : leading) {
    for (const UnknownFinding& of_variables : leading) {
      UnknownFinding combined = of_target;
      combined.variables = of_variables.variables;
      combined.with_one_of = of_variables.with_one_of;
      all.push_back(std::move(combined));
    }
  }
  return all;
}

}  // namespace

bool is_error_left_out(const ModelState& state, const Effect& surface) {
  const EffectName name = surface.name();
  return std::ranges::any_of(state.setting().families, [&](const Family& family) {
    return family.is_left_out() && family.name().target == name.target && family.name().driver == name.driver;
  });
}

std::optional<SurfaceTest> best_surface(const ModelState& state,
                                        const std::vector<UnknownFinding>& findings) {
  std::optional<SurfaceTest> best;
  std::vector<EffectName> tried;
  const SearchRules& rules = state.setting().rules;
  const std::vector<UnknownFinding> all = combinations(rules, findings);
  std::size_t best_of = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const UnknownFinding& finding = all[k];
    for (EffectSpec& spec : surfaces_for(state.model(), finding)) {
      std::shared_ptr<const Effect> effect = empirical_effect().make(spec, {});
      if (std::ranges::find(tried, effect->name()) != tried.end() || state.has_surface(effect->name()))
        continue;
      tried.push_back(effect->name());
      if (is_error_left_out(state, *effect)) continue;
      const double evidence = surface_evidence(state.model(), state.projector(), *effect);
      if (evidence < kThresholds.surface_evidence || (best && evidence <= best->log_evidence)) continue;
      best = SurfaceTest{std::move(spec), std::move(effect), finding, evidence};
      best_of = k;
    }
  }
  if (best_of >= std::min(findings.size(), kMostFindings)) rules.tell(SearchRule::CrossedFindings);
  return best;
}

}  // namespace volcal
