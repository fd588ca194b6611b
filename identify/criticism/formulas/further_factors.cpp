#include "volcal/identify/criticism/formulas/further_factors.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/recorded_variable.h"

namespace volcal {
namespace {

using Kind = Variable::Kind;

constexpr std::size_t kBestOfVariable = 2;

/// Variables of a campaign that a law may have beside its own.
std::vector<Variable> variables_of_campaign(const Campaign& campaign) {
  std::vector<Variable> variables;
  for (const Axis& axis : campaign.machine.axes) {
    for (const Kind kind : {Kind::Position, Kind::Direction, Kind::TravelSinceTurning})
      variables.push_back({.kind = kind, .axis = axis.name});
  }
  for (const std::string& channel : temperature_channels(campaign))
    variables.push_back(temperature_of(channel));
  for (const Kind kind : {Kind::Time, Kind::Feed, Kind::ToolLength}) variables.push_back({.kind = kind});
  return variables;
}

/// 0 where it was not recorded; nothing where it does not change.
std::optional<Eigen::VectorXd> per_observation(const LinearModel& model, const Variable& variable) {
  Eigen::VectorXd value = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.size()));
  std::vector<std::optional<Eigen::VectorXd>> of_setups;
  for (const SetupView& view : model.views()) {
    of_setups.push_back(recorded_variable(view, variable));
    if (!of_setups.back()) return std::nullopt;
  }
  for (std::size_t i = 0; i < model.size(); ++i) {
    const auto& place = model.observations()[i];
    value[static_cast<Eigen::Index>(i)] = (*of_setups[place.setup])[static_cast<Eigen::Index>(place.row)];
  }
  if (!(value.maxCoeff() > value.minCoeff())) return std::nullopt;
  return value;
}

/// The travel since turning says nothing without the direction.
bool lacks_direction(const Variable& variable, const std::vector<Variable>& factors) {
  return variable.kind == Kind::TravelSinceTurning &&
         std::ranges::find(factors, direction_of_approach(variable.axis)) == factors.end();
}

}  // namespace

double zero_of(const Machine& machine, const Variable& variable) {
  if (variable.kind == Kind::Temperature) return kReferenceTemperature_degC;
  if (variable.kind != Kind::Position || !machine.has_axis(variable.axis)) return 0.0;
  return machine.axis(variable.axis).home / variable.unit().si_per_unit;
}

FurtherFactors::FurtherFactors(const LinearModel& model, const Projector& projector,
                               const EffectSpec& surface)
    : model_(model), projector_(projector) {
  std::vector<Variable> own = variables_in(*surface.options.text("drivers"));
  const std::vector<Variable> factors = variables_in(surface.options.text("factor").value_or(""));
  own.insert(own.end(), factors.begin(), factors.end());
  const auto is_own = [&own](const Variable& variable) {
    return std::ranges::find(own, variable.written(), &Variable::written) != own.end();
  };
  for (const Variable& variable : variables_of_campaign(model.campaign())) {
    if (!is_own(variable) && !lacks_direction(variable, factors)) add(variable);
  }
}

void FurtherFactors::add(const Variable& variable) {
  std::optional<Eigen::VectorXd> value = per_observation(model_, variable);
  if (!value) return;
  Further& further = further_.emplace_back();
  further.range = {variable, value->minCoeff(), value->maxCoeff()};
  further.value = *std::move(value);
  further.functions = variable.kind == Kind::Direction
                          ? std::vector{power_of(variable, 0.0, 1)}
                          : elementary_functions(further.range, zero_of(model_.campaign().machine, variable));
}

std::size_t FurtherFactors::tried() const {
  std::size_t count = 0;
  for (const Further& each : further_) count += each.functions.size();
  return count;
}

std::vector<Law> FurtherFactors::times(const Law& law, const Effect& effect) const {
  const Eigen::VectorXd column = [&] {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(model_.size()), 1);
    for (std::size_t setup = 0; setup + 1 < model_.parts().size(); ++setup) {
      const Eigen::Index first = model_.parts()[setup];
      model_.columns(effect, effect.shape_values(), setup,
                     all.middleRows(first, model_.parts()[setup + 1] - first));
    }
    return Eigen::VectorXd(all.col(0));
  }();
  std::vector<Law> best;
  for (const Further& further : further_) {
    std::vector<Law> longer;
    for (const ElementaryFunction& function : further.functions) {
      if (law.shapes() + function.shapes() > kMostLawShapes) continue;
      for (const std::vector<double>& start : function.starts) {
        Law next = law;
        next.factors.push_back({&function, &further.range});
        next.shape.insert(next.shape.end(), start.begin(), start.end());
        longer.push_back(std::move(next));
      }
    }
    Eigen::MatrixXd columns(column.size(), static_cast<Eigen::Index>(longer.size()));
    for (std::size_t k = 0; k < longer.size(); ++k) {
      const std::vector<double> shape = longer[k].shape_of(longer[k].factors.size() - 1);
      const ElementaryFunction& function = *longer[k].factors.back().function;
      columns.col(static_cast<Eigen::Index>(k)) = column.cwiseProduct(
          further.value.unaryExpr([&](double value) { return function.at(value, shape); }));
    }
    const ProjectedColumns projected = projector_.project(columns);
    for (std::size_t k = 0; k < longer.size(); ++k)
      longer[k].lm = score_test(projected, static_cast<Eigen::Index>(k), 1).lm;
    const double price = std::log(static_cast<double>(projector_.observations()));
    std::ranges::stable_sort(longer, std::greater{}, [price](const Law& each) {
      return each.lm - static_cast<double>(each.shapes()) * price;
    });
    longer.resize(std::min(longer.size(), kBestOfVariable));
    std::ranges::move(longer, std::back_inserter(best));
  }
  return best;
}

}  // namespace volcal
