#include "volcal/identify/io/campaign/campaign_checks.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

constexpr double kPriorSigmas = 5.0;
constexpr double kGuessSpread = 1.0;    // m, between guesses of one station
constexpr double kStationMargin = 0.1;  // share of the box on each side
constexpr double kLeastLength = 5e-3;   // m, variation of a prediction worth judging
constexpr double kLeastAngle = 0.1;     // rad
constexpr double kLeastCorrelation = 0.99;
constexpr int kDigits = 4;  // of estimates from noisy readings

std::string shown_mm(const Eigen::Vector3d& point) {
  return "[" + number_text(point.x() / kMetrePerMillimetre, kDigits) + ", " +
         number_text(point.y() / kMetrePerMillimetre, kDigits) + ", " +
         number_text(point.z() / kMetrePerMillimetre, kDigits) + "] mm";
}

[[noreturn]] void fail(const Campaign& campaign, const Setup& setup, const std::string& problem,
                       const std::string& remedy) {
  throw InputError({campaign.file, setup.source_line}, "setup \"" + setup.name + "\": " + problem, remedy);
}

void check_noise(const Campaign& campaign, const Setup& setup) {
  if (!setup.readings.sigma.empty()) return;
  if (!setup.has_noise) {
    std::string keys;
    for (const KeySchema& key : find_instrument(setup.instrument)->schema().noise_keys) {
      keys += (keys.empty() ? "" : ", ") + key.key + " = ...";
    }
    fail(campaign, setup,
         std::string("states no noise of its instrument, neither by a noise table nor by a sigma column") +
             (setup.repeatability > 0.0 ? "; repeatability_um is that of the machine" : ""),
         "add noise = { " + keys + " } or a column " +
             sigma_column(find_instrument(setup.instrument)->schema()));
  }
  double total = setup.repeatability;
  for (const auto& [key, value] : setup.noise.all()) {
    if (const double* sigma = std::get_if<double>(&value)) total += *sigma;
  }
  if (total == 0.0) {
    fail(campaign, setup, "its noise and repeatability are all 0, every reading would be exact",
         "state the instrument's standard uncertainty, k = 1");
  }
}

void check_channels(const Campaign& campaign, const Setup& setup) {
  for (const Axis& axis : campaign.machine.axes) {
    if (!axis.expansion || setup.readings.temperature.contains(axis.expansion->channel)) continue;
    const std::string name(1, letter_of(axis.name));
    fail(campaign, setup,
         "axis " + name + " of the machine names the temperature channel \"" + axis.expansion->channel +
             "\", but " + setup.data + " has no column T_" + axis.expansion->channel + "_degC",
         "add the column, map it with columns, or remove temperature and expansion from [axes." + name + "]");
  }
}

std::vector<Eigen::Vector3d> nominal_points_w(const Campaign& campaign, const Setup& setup) {
  const KinematicChain chain(campaign.machine);
  const Eigen::Vector3d& offset = campaign.machine.tools[setup.tool].offset;
  std::vector<Eigen::Vector3d> points(setup.readings.size());
  for (std::size_t row = 0; row < points.size(); ++row) {
    AxisPosition position{};
    for (const Axis& axis : campaign.machine.axes) {
      const std::size_t i = index_of(axis.name);
      position[i] = setup.readings.position[i][row];
    }
    points[row] = chain.nominal_point_w(position, offset);
  }
  return points;
}

/// Points then go round a station that stands on the table, as seen from there.
bool table_turns(const Machine& machine, const Setup& setup) {
  return std::ranges::any_of(machine.structure.joints, [&](const Joint& joint) {
    const std::vector<double>& position = setup.readings.position[index_of(joint.axis)];
    return joint.workpiece_side && is_rotary(joint.axis) &&
           std::ranges::any_of(position, [&](double value) { return value != position.front(); });
  });
}

void check_station(const Campaign& campaign, const Setup& setup,
                   const std::vector<Eigen::Vector3d>& points_w) {
  const auto station_w = setup.options.vector("station");
  if (!station_w || table_turns(campaign.machine, setup)) return;
  Eigen::Vector3d lowest = points_w.front();
  Eigen::Vector3d highest = points_w.front();
  for (const Eigen::Vector3d& point : points_w) {
    lowest = lowest.cwiseMin(point);
    highest = highest.cwiseMax(point);
  }
  const Eigen::Vector3d margin = kStationMargin * (highest - lowest);
  const bool inside = (station_w->array() > (lowest + margin).array()).all() &&
                      (station_w->array() < (highest - margin).array()).all();
  if (!inside) return;
  fail(campaign, setup,
       "station_mm lies inside the volume of its own measured points, " + shown_mm(lowest) + " to " +
           shown_mm(highest),
       "a station stands outside, in workpiece coordinates with all axes at 0; check signs and the tool "
       "offset");
}

/// Straight-line relation reading = factor * predicted + constant.
struct Relation {
  double factor = 1.0;
  double correlation = 0.0;
  double predicted_range = 0.0;
};

Relation relate(const std::vector<double>& predicted, const std::vector<double>& reading) {
  const Eigen::Map<const Eigen::ArrayXd> x_all(predicted.data(), static_cast<Eigen::Index>(predicted.size()));
  const Eigen::Map<const Eigen::ArrayXd> y_all(reading.data(), static_cast<Eigen::Index>(reading.size()));
  const Eigen::ArrayXd x = x_all - x_all.mean();
  const Eigen::ArrayXd y = y_all - y_all.mean();
  const double xx = x.square().sum();
  const double yy = y.square().sum();
  const double xy = (x * y).sum();
  Relation relation;
  relation.predicted_range = x.maxCoeff() - x.minCoeff();
  if (xx > 0.0 && yy > 0.0) {
    relation.factor = xy / xx;
    relation.correlation = xy / std::sqrt(xx * yy);
  }
  return relation;
}

std::string factor_remedy(double factor, const std::string& column) {
  const auto near = [&](double value) {
    return std::abs(std::log(std::abs(factor) / value)) < std::log(1.3);
  };
  const std::string scale = "scale = { " + column + " = ";
  if (factor < 0.0 && near(1.0)) return "the sign is reversed: add " + scale + "-1 } or turn `direction`";
  if (near(1e-3))
    return "wrong unit by 1000? the column is in m, or positions are in um: add " + scale +
           "1000 } to the setup";
  if (near(1e3))
    return "wrong unit by 1000? the column is in um, or positions are in m: add " + scale +
           "0.001 } to the setup";
  if (near(1.0 / 25.4)) return "the column seems to be in inches: add " + scale + "25.4 } to the setup";
  if (near(kRadianPerDegree))
    return "the column seems to be in rad: add " + scale + "57.29577951308232 } to the setup";
  return "check the unit of the column, and station, direction and tool of the setup";
}

void check_units(const Campaign& campaign, const Setup& setup, std::vector<Eigen::Vector3d> points_w) {
  const Instrument& instrument = *find_instrument(setup.instrument);
  const std::vector<Eigen::Vector3d> points = points_w;
  const auto bound = instrument.bind({setup, campaign.machine, campaign.file, std::move(points_w)});
  std::vector<double> nuisance;
  for (const NuisanceBlock& block : bound->nuisance()) {
    nuisance.insert(nuisance.end(), block.guess.begin(), block.guess.end());
  }
  const auto local_size = static_cast<std::size_t>(bound->local_nuisance_size());
  std::vector<int> index(local_size);
  std::vector<double> local(local_size);
  std::vector<std::vector<double>> predicted(static_cast<std::size_t>(bound->channels()));
  for (std::size_t row = 0; row < points.size(); ++row) {
    bound->local_nuisance(row, index.data());
    for (std::size_t i = 0; i < local_size; ++i) local[i] = nuisance[static_cast<std::size_t>(index[i])];
    ToolState<double> state;
    state.point_w = points[row];
    double values[kMaxChannels];
    bound->predict(row, state, local.data(), values);
    for (std::size_t channel = 0; channel < predicted.size(); ++channel)
      predicted[channel].push_back(values[channel]);
  }
  const auto& columns = instrument.schema().column_sets[setup.readings.column_set];
  for (std::size_t channel = 0; channel < predicted.size(); ++channel) {
    if (!bound->is_foreseen(static_cast<int>(channel))) continue;
    const std::string& column = columns[channel].column;
    const std::string_view unit = unit_of_key(column).suffix;
    const double least = unit == "mm" || unit == "um" || unit == "m" ? kLeastLength : kLeastAngle;
    const Relation relation = relate(predicted[channel], setup.readings.value[channel]);
    const bool judged =
        relation.predicted_range > least && std::abs(relation.correlation) > kLeastCorrelation;
    if (!judged || (relation.factor > 0.5 && relation.factor < 2.0)) continue;
    throw InputError({setup.data, static_cast<int>(setup.readings.source_line.front())},
                     column + " changes by " + number_text(relation.factor, kDigits) +
                         " of what the commanded positions predict",
                     factor_remedy(relation.factor, column));
  }
}

}  // namespace

void check_shared_stations(const Campaign& campaign) {
  for (auto setup = campaign.setups.begin(); setup != campaign.setups.end(); ++setup) {
    const auto name = setup->options.text("station");
    const auto guess = setup->options.vector("station");
    if (!name || !guess) continue;
    for (auto other = campaign.setups.begin(); other != setup; ++other) {
      const auto other_guess = other->options.vector("station");
      if (other->options.text("station") != name || !other_guess) continue;
      const double apart = (*guess - *other_guess).norm();
      const double sigma = setup->options.number("station_sigma").value_or(0.0);
      const double other_sigma = other->options.number("station_sigma").value_or(0.0);
      const double allowed = kPriorSigmas * std::hypot(sigma, other_sigma);
      const bool both_known = sigma > 0.0 && other_sigma > 0.0;
      if (both_known && apart > allowed) {
        fail(campaign, *setup,
             "station \"" + *name + "\" is " + number_text(apart / kMetrePerMillimetre, kDigits) +
                 " mm from where setup \"" + other->name + "\" (line " + std::to_string(other->source_line) +
                 ") puts it, over 5 sigma",
             "correct station_mm or station_sigma_mm, or give the station another name if it was moved");
      }
      if (!both_known && apart > kGuessSpread) {
        fail(campaign, *setup,
             "station \"" + *name + "\" is " + number_text(apart, kDigits) + " m from where setup \"" +
                 other->name + "\" (line " + std::to_string(other->source_line) + ") puts it",
             "correct station_mm, or give the station another name if it was moved");
      }
    }
  }
}

void check_setup(const Campaign& campaign, const Setup& setup) {
  check_noise(campaign, setup);
  check_channels(campaign, setup);
  auto points_w = nominal_points_w(campaign, setup);
  check_station(campaign, setup, points_w);
  check_units(campaign, setup, std::move(points_w));
}

}  // namespace volcal
