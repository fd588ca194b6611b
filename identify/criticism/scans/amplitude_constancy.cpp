#include "volcal/identify/criticism/scans/amplitude_constancy.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/travel_since_turning.h"

namespace volcal {
namespace {

constexpr int kWaves = 8;
constexpr double kTests = 4.0;  // groups of variables, smooth and rough

bool is_since_turning(const ScanVariable& variable) {
  return variable.variable.kind == Variable::Kind::TravelSinceTurning;
}

std::set<Variable> own_variables(const Family& family) {
  std::set<Variable> own;
  for (const Variable& variable : scan_variables_of(family.name())) {
    own.insert(variable);
    if (variable.kind == Variable::Kind::Direction)
      own.insert({Variable::Kind::TravelSinceTurning, variable.axis});
  }
  for (const EffectTerm& term : family.effect->terms()) {
    if (term.target.kind == TargetKind::Motion)
      own.insert({Variable::Kind::Position, term.target.symbol.axis});
  }
  return own;
}

/// The machine does not know from which station it is read.
bool may_vary_with(const Family& family, const ScanVariable& variable) {
  if (variable.variable.kind != Variable::Kind::Station) return true;
  return std::ranges::any_of(family.effect->amplitudes(), [](const EffectAmplitude& amplitude) {
    return amplitude.target.kind == TargetKind::Station || amplitude.target.kind == TargetKind::Reading;
  });
}

/// log10 p of a smooth or of a rough variation, whichever is less probable.
double log10_p_of(const ScanVariable& variable, const Eigen::VectorXd& moved, const Projector& projector) {
  const Eigen::MatrixXd powers = moved.asDiagonal() * scan_powers(variable);
  const double smooth = score_test(projector.project(powers), 0, powers.cols()).log10_p;
  if (variable.two_valued) return smooth;
  const Eigen::MatrixXd waves = moved.asDiagonal() * scan_waves(variable, kWaves);
  return std::min(smooth, kernel_test(projector.project(waves), 0, waves.cols()).log10_p);
}

}  // namespace

std::vector<ScanVariable> travel_since_turning(const LinearModel& model) {
  const Campaign& campaign = model.campaign();
  std::vector<ScanVariable> variables;
  for (const Axis& axis : campaign.machine.axes) {
    std::vector<std::vector<double>> travelled;
    for (const Setup& setup : campaign.setups)
      travelled.push_back(finite_travel_since_turning(campaign.machine, setup, axis.name));
    Eigen::VectorXd value(static_cast<Eigen::Index>(model.size()));
    for (std::size_t i = 0; i < model.size(); ++i) {
      const auto& place = model.observations()[i];
      value[static_cast<Eigen::Index>(i)] = travelled[place.setup][place.row];
    }
    add_scan_variable(variables, {Variable::Kind::TravelSinceTurning, axis.name}, std::move(value));
  }
  return variables;
}

ConstancyTest least_constant(const Family& family, const Eigen::VectorXd& moved,
                             const std::vector<ScanVariable>& variables, const Projector& projector) {
  const std::set<Variable> own = own_variables(family);
  const auto count = static_cast<double>(std::ranges::count_if(variables, [&](const ScanVariable& variable) {
    return !is_since_turning(variable) && may_vary_with(family, variable);
  }));
  const double own_count = std::max(1.0, static_cast<double>(own.size()));
  ConstancyTest least;
  for (const ScanVariable& variable : variables) {
    const bool is_own = own.contains(variable.variable);
    if (!may_vary_with(family, variable) || (is_since_turning(variable) && !is_own)) continue;
    const double tried = kTests * (is_own ? own_count : count);
    const double log10_p = std::min(0.0, log10_p_of(variable, moved, projector) + std::log10(tried));
    if (log10_p < least.log10_p) least = {variable.name(), log10_p};
  }
  return least;
}

bool acts_in_several_places(const Family& family) {
  return family.effect && family.effect->terms().size() > family.effect->amplitudes().size();
}

double log10_p_of_one_amplitude(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                                const Projector& projector) {
  const auto score_of = [&projector](const Eigen::MatrixXd& columns) {
    return score_test(projector.project(columns), 0, columns.cols());
  };
  const auto places = single_terms(family.effect);
  Eigen::MatrixXd apart(static_cast<Eigen::Index>(model.size()), static_cast<Eigen::Index>(places.size()));
  for (std::size_t place = 0; place < places.size(); ++place) {
    Family alone = family;
    alone.effect = places[place];
    apart.col(static_cast<Eigen::Index>(place)) = family_columns(model, alone, shape).col(0);
  }
  const ScoreTest each = score_of(apart), together = score_of(family_columns(model, family, shape));
  if (each.dof <= together.dof) return 0.0;
  return log10_chi_squared_exceedance(std::max(0.0, each.lm - together.lm), each.dof - together.dof);
}

}  // namespace volcal
