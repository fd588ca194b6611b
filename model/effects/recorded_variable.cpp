#include "volcal/model/effects/recorded_variable.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/travel_since_turning.h"

namespace volcal {
namespace {

using Kind = Variable::Kind;

/// The channel that a temperature means, by its own name before that in expressions.
const std::vector<double>* temperature(const Readings& readings, const Variable& variable) {
  const auto own = readings.temperature.find(variable.subject);
  if (own != readings.temperature.end()) return &own->second;
  for (const auto& [channel, values] : readings.temperature) {
    if (channel_variable(channel) == variable.written()) return &values;
  }
  return nullptr;
}

template <class Values>
Eigen::VectorXd scaled(const Values& values, double unit) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    out[static_cast<Eigen::Index>(i)] = static_cast<double>(values[i]) / unit;
  }
  return out;
}

/// In the variable's unit; nothing for a column that is not there.
template <class Values>
std::optional<Eigen::VectorXd> of_column(const Values& values, const Variable& variable) {
  if (values.empty()) return std::nullopt;
  return scaled(values, variable.unit().si_per_unit);
}

}  // namespace

const std::vector<Variable>& plain_variables() {
  static const std::vector<Variable> kVariables = {
      {.kind = Kind::Time},
      {.kind = Kind::Length},
      {.kind = Kind::Feed},
      {.kind = Kind::ToolLength},
      {.kind = Kind::ToolOffset, .component = 0},
      {.kind = Kind::ToolOffset, .component = 1},
      {.kind = Kind::ToolOffset, .component = 2},
  };
  return kVariables;
}

std::string listed_variables() {
  return "x y z a b c, dir_x ... dir_c, since_x ... since_c, T_<channel>, " +
         listed_names(written_names(plain_variables()));
}

std::optional<Eigen::VectorXd> recorded_variable(const SetupView& view, const Variable& variable) {
  const Readings& readings = view.setup.readings;
  const double unit = variable.unit().si_per_unit;
  const Eigen::Vector3d& tool = view.campaign.machine.tools[view.setup.tool].offset;
  const auto constant_of = [&](double value) {
    return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(view.rows()), value).eval();
  };
  switch (variable.kind) {
    case Kind::Position:
      return scaled(readings.position[index_of(variable.axis)], unit);
    case Kind::Direction:
      return of_column(readings.direction[index_of(variable.axis)], variable);
    case Kind::TravelSinceTurning:
      return scaled(finite_travel_since_turning(view.campaign.machine, view.setup, variable.axis), unit);
    case Kind::Time:
      if (readings.time.empty()) return std::nullopt;
      return times(view).array() - clock_start(view);
    case Kind::Temperature: {
      const std::vector<double>* values = temperature(readings, variable);
      if (values == nullptr) return std::nullopt;
      return scaled(*values, unit);
    }
    case Kind::Feed:
      return of_column(readings.feed, variable);
    case Kind::Length:
      return view.length / unit;
    case Kind::ToolLength:
      return constant_of((tool / unit).norm());
    case Kind::ToolOffset:
      return constant_of(tool[variable.component] / unit);
    case Kind::Speed:
    case Kind::Elevation:
    case Kind::Run:
    case Kind::Instrument:
    case Kind::Tool:
    case Kind::Station:
      break;
  }
  throw std::invalid_argument(variable.name() + " is not a variable of expressions");
}

bool has_variable(const Setup& setup, const Variable& variable) {
  const Readings& readings = setup.readings;
  switch (variable.kind) {
    case Kind::Temperature:
      return temperature(readings, variable) != nullptr;
    case Kind::Direction:
      return !readings.direction[index_of(variable.axis)].empty();
    case Kind::Time:
      return !readings.time.empty();
    case Kind::Feed:
      return !readings.feed.empty();
    default:
      return true;
  }
}

void check_variable(const Campaign& campaign, const Variable& variable,
                    const std::function<bool(const Setup&)>& acts_on, const std::string& what,
                    const std::string& user, const SourcePlace& place) {
  if (variable.has_axis()) check_axis(campaign, variable.axis, what, place);
  for (const Setup& setup : campaign.setups) {
    if (acts_on(setup) && has_variable(setup, variable)) return;
  }
  const std::string column = variable.column();
  std::string remedy = "add the column " + column + " or write another variable";
  if (variable.kind == Kind::Temperature)
    remedy += "; channels of the campaign: " + listed_names(temperature_channels(campaign));
  throw InputError(place, what + ": column " + column + " is missing, but " + user, remedy);
}

}  // namespace volcal
