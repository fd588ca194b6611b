#include "volcal/identify/criticism/scans/scan_variables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

using Kind = Variable::Kind;

/// Scans go through it, or through the direction that it starts from.
bool is_scanned(Kind kind) { return kind != Kind::ToolLength && kind != Kind::ToolOffset; }

/// Share of the path that an axis moves along, with its sign, from the neighbouring readings of the run; 0 at
/// rest.
double share_of_path(const Setup& setup, std::size_t axis, std::size_t row) {
  if (!traits_of(setup).reads_in_motion) return 0.0;
  const auto& readings = setup.readings;
  const auto same_run = [&](std::size_t other) {
    return readings.run.empty() || readings.run[other] == readings.run[row];
  };
  const std::size_t before = row > 0 && same_run(row - 1) ? row - 1 : row;
  const std::size_t after = row + 1 < readings.size() && same_run(row + 1) ? row + 1 : row;
  double squares = 0.0, own = 0.0;
  for (std::size_t k = 0; k < readings.position.size(); ++k) {
    if (is_rotary(static_cast<AxisName>(k)) || readings.position[k].empty()) continue;
    const double moved = readings.position[k][after] - readings.position[k][before];
    squares += moved * moved;
    if (k == axis) own = moved;
  }
  return squares > 0.0 ? own / std::sqrt(squares) : 0.0;
}

/// Variables in the order in which they are added, without those that are constant over the observations.
class ScanVariables {
 public:
  explicit ScanVariables(const LinearModel& model) : model_(model), campaign_(model.campaign()) {}

  void add_positions_and_directions() {
    for (const Axis& axis : campaign_.machine.axes) {
      const std::size_t k = index_of(axis.name);
      add({Kind::Position, axis.name},
          [k](const Setup& setup, std::size_t, std::size_t row) { return setup.readings.position[k][row]; });
      add({Kind::Direction, axis.name}, [k](const Setup& setup, std::size_t, std::size_t row) {
        const auto& direction = setup.readings.direction[k];
        return direction.empty() ? 0.0 : static_cast<double>(direction[row]);
      });
    }
  }

  void add_time_and_temperatures() {
    const double start = time_span(campaign_).first;
    add({Kind::Time}, [start](const Setup& setup, std::size_t, std::size_t row) {
      return setup.readings.time.empty() ? start : setup.readings.time[row];
    });
    for (const std::string& channel : temperature_channels(campaign_)) {
      add({.kind = Kind::Temperature, .subject = channel}, [&channel](const Setup& setup, std::size_t,
                                                                      std::size_t row) {
        const auto found = setup.readings.temperature.find(channel);
        return found == setup.readings.temperature.end() ? kReferenceTemperature_degC : found->second[row];
      });
    }
  }

  void add_motion() {
    for (const Axis& axis : campaign_.machine.axes) {
      if (is_rotary(axis.name)) continue;
      add({Kind::Speed, axis.name},
          [k = index_of(axis.name)](const Setup& setup, std::size_t, std::size_t row) {
            return share_of_path(setup, k, row);
          });
    }
  }

  void add_instruments() {
    std::map<std::string, std::size_t> readings;
    for (const Setup& setup : campaign_.setups) readings[setup.instrument] += setup.readings.size();
    const auto most = std::ranges::max_element(readings, {}, [](const auto& each) { return each.second; });
    for (const auto& each : readings) {
      const std::string& instrument = each.first;
      if (instrument == most->first) continue;
      add({.kind = Kind::Instrument, .subject = instrument},
          [&instrument](const Setup& setup, std::size_t, std::size_t) {
            return setup.instrument == instrument ? 1.0 : 0.0;
          });
    }
  }

  void add_beam_geometry() {
    add({Kind::Length}, [this](const Setup&, std::size_t setup, std::size_t row) {
      return model_.views()[setup].length[static_cast<Eigen::Index>(row)];
    });
    add({Kind::Elevation}, [this](const Setup& setup, std::size_t of, std::size_t row) {
      const auto station = setup.options.vector("station");
      if (!station) return 0.0;
      const Eigen::Vector3d beam = model_.views()[of].nominal_point_w[row] - *station;
      return std::atan2(beam.z(), beam.head<2>().norm());
    });
  }

  void add_run_and_feed() {
    add({Kind::Run}, [](const Setup& setup, std::size_t, std::size_t row) {
      return setup.readings.run.empty() ? 0.0 : static_cast<double>(setup.readings.run[row]);
    });
    add({Kind::Feed}, [](const Setup& setup, std::size_t, std::size_t row) {
      return setup.readings.feed.empty() ? 0.0 : setup.readings.feed[row];
    });
  }

  void add_tools_and_stations() {
    for (const std::string& tool : tools_in_use(campaign_)) {
      add({.kind = Kind::Tool, .subject = tool}, [&](const Setup& setup, std::size_t, std::size_t) {
        return campaign_.machine.tools[setup.tool].name == tool ? 1.0 : 0.0;
      });
    }
    for (const std::string& station : station_names(campaign_)) {
      add({.kind = Kind::Station, .subject = station},
          [&station](const Setup& setup, std::size_t, std::size_t) {
            return station_of(setup) == station ? 1.0 : 0.0;
          });
    }
  }

  std::vector<ScanVariable> take() { return std::move(variables_); }

 private:
  /// `of_reading(setup, its number, row)` is the value.
  template <class OfReading>
  void add(const Variable& variable, const OfReading& of_reading) {
    Eigen::VectorXd value(static_cast<Eigen::Index>(model_.size()));
    for (std::size_t i = 0; i < model_.size(); ++i) {
      const auto& [setup, row, channel] = model_.observations()[i];
      value[static_cast<Eigen::Index>(i)] = of_reading(campaign_.setups[setup], setup, row);
    }
    add_scan_variable(variables_, variable, std::move(value));
  }

  const LinearModel& model_;
  const Campaign& campaign_;
  std::vector<ScanVariable> variables_;
};

}  // namespace

void add_scan_variable(std::vector<ScanVariable>& variables, const Variable& variable,
                       Eigen::VectorXd value) {
  const double low = value.minCoeff(), high = value.maxCoeff();
  if (!(high - low > 1e-9 * std::max(1.0, std::abs(high)))) return;
  value = ((value.array() - low) * (2.0 / (high - low)) - 1.0).matrix();
  const bool two_valued = (value.array().abs() > 1.0 - 1e-9).all();
  const double shift = two_valued ? value.mean() : 0.0;
  value.array() -= shift;
  const double scale = 0.5 * (high - low);
  variables.push_back({variable, std::move(value), two_valued, low + scale * (1.0 + shift), scale});
}

std::vector<ScanVariable> scan_variables(const LinearModel& model) {
  ScanVariables variables(model);
  variables.add_positions_and_directions();
  variables.add_motion();
  variables.add_time_and_temperatures();
  variables.add_beam_geometry();
  variables.add_run_and_feed();
  variables.add_instruments();
  variables.add_tools_and_stations();
  return variables.take();
}

Eigen::MatrixXd scan_powers(const ScanVariable& variable) {
  if (variable.two_valued) return variable.value;
  const Eigen::ArrayXd v = variable.value.array();
  Eigen::MatrixXd powers(v.size(), 3);
  powers << v, v.square(), v.cube();
  return powers;
}

Eigen::MatrixXd scan_waves(const ScanVariable& variable, int count) {
  if (variable.two_valued) return variable.value;
  Eigen::MatrixXd waves(variable.value.size(), count);
  for (int k = 1; k <= count; ++k) {
    waves.col(k - 1) = ((variable.value.array() + 1.0) * (0.5 * k * std::numbers::pi)).cos() / k;
  }
  return waves;
}

std::vector<Variable> scan_variables_of(const EffectName& name) {
  std::vector<Variable> variables = name.driver.where();
  if (name.target.owner()) variables.push_back(*name.target.owner());
  for (const Variable& variable : name.driver.variables()) {
    if (is_scanned(variable.kind)) variables.push_back(variable);
  }
  return variables;
}

}  // namespace volcal
