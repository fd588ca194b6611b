#include "volcal/identify/io/campaign/doubtful_angles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

constexpr double kDoubtfulMiss = 5e-3;       // m
constexpr double kBetter = 0.2;              // of the miss
constexpr double kClearlyBetter = 0.5;       // of the miss, for another change of an axis
constexpr double kMoves = 1e-6;              // rad
constexpr double kOutside = 0.01;            // of the travel
constexpr std::size_t kMostRows = 100;       // that are looked at
constexpr std::size_t kFewestPositions = 5;  // of an axis whose positions are judged alone
constexpr double kRoundedRadian = 5e-4;      // rad: three decimals
constexpr double kLargestRadian_deg = 6.4;   // a turn
constexpr double kRoundDegree = 0.5;         // deg
constexpr double kExactDegree = 1e-6;        // deg

/// How the positions of an axis are taken, other than they are read.
struct Reinterpretation {
  bool radians = false;
  bool reversed = false;

  double factor() const { return (radians ? 1.0 / kRadianPerDegree : 1.0) * (reversed ? -1.0 : 1.0); }
  int changes() const { return static_cast<int>(radians) + static_cast<int>(reversed); }
};
using Reinterpretations = std::array<Reinterpretation, kAxisCount>;

constexpr std::array<Reinterpretation, 4> kReinterpretations = {
    {{false, false}, {false, true}, {true, false}, {true, true}}};

/// Rows spread over a setup.
std::vector<std::size_t> rows_looked_at(const Readings& readings) {
  const std::size_t count = std::min(readings.size(), kMostRows);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < count; ++i) rows.push_back(i * readings.size() / count);
  return rows;
}

/// What the readings of a setup say of nominal tool points.
class NominalGeometry {
 public:
  NominalGeometry(const Setup& setup, const Machine& machine)
      : setup_(setup), machine_(machine), chain_(machine), rows_(rows_looked_at(setup.readings)) {
    const Instrument* instrument = find_instrument(setup.instrument);
    if (instrument == nullptr || setup.tool >= machine.tools.size()) return;
    const InstrumentSchema& schema = instrument->schema();
    const bool names_sphere = std::ranges::find(schema.keys, "sphere", &KeySchema::key) != schema.keys.end();
    const auto centre = setup.options.vector("centre");
    const auto station = setup.options.vector("station");
    if (names_sphere) {
      miss_ = &NominalGeometry::about_one_place;
    } else if (schema.traits.has_bar && centre) {
      from_w_ = *centre;
      miss_ = &NominalGeometry::about_one_distance;
    } else if (schema.traits.length_from_zero && station) {
      from_w_ = *station;
      reads_distance_ = true;
      miss_ = &NominalGeometry::about_one_distance;
    }
  }

  bool says_something() const { return miss_ != nullptr && rows_.size() > 2; }
  /// Whether the nominal tool point stands at one place in all readings, wherever that is.
  bool is_of_one_place() const {
    return miss_ == &NominalGeometry::about_one_place && setup_.readings.given.empty() &&
           setup_.readings.value.size() == 3;
  }
  /// Root mean square, m.
  double miss(const Reinterpretations& taken) const { return (this->*miss_)(points_w(taken)); }

 private:
  std::vector<Eigen::Vector3d> points_w(const Reinterpretations& taken) const {
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t row : rows_) {
      AxisPosition position{};
      for (const Axis& axis : machine_.axes) {
        const std::size_t k = index_of(axis.name);
        const auto& column = setup_.readings.position[k];
        if (!column.empty()) position[k] = taken[k].factor() * column[row];
      }
      points.push_back(chain_.nominal_point_w(position, machine_.tools[setup_.tool].offset));
    }
    return points;
  }

  double about_one_place(const std::vector<Eigen::Vector3d>& points_w) const {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points_w) mean += point / static_cast<double>(points_w.size());
    double squares = 0.0;
    for (const Eigen::Vector3d& point : points_w) squares += (point - mean).squaredNorm();
    return std::sqrt(squares / static_cast<double>(points_w.size()));
  }

  double about_one_distance(const std::vector<Eigen::Vector3d>& points_w) const {
    std::vector<double> left;
    double mean = 0.0;
    for (std::size_t i = 0; i < points_w.size(); ++i) {
      const double read = reads_distance_ ? setup_.readings.value.front()[rows_[i]] : 0.0;
      left.push_back((points_w[i] - from_w_).norm() - read);
      mean += left.back() / static_cast<double>(points_w.size());
    }
    double squares = 0.0;
    for (const double each : left) squares += (each - mean) * (each - mean);
    return std::sqrt(squares / static_cast<double>(left.size()));
  }

  const Setup& setup_;
  const Machine& machine_;
  KinematicChain chain_;
  std::vector<std::size_t> rows_;
  Eigen::Vector3d from_w_ = Eigen::Vector3d::Zero();
  bool reads_distance_ = false;
  double (NominalGeometry::*miss_)(const std::vector<Eigen::Vector3d>&) const = nullptr;
};

std::vector<AxisName> turning_axes(const Setup& setup, const Machine& machine) {
  std::vector<AxisName> turning;
  for (const Axis& axis : machine.axes) {
    const auto& column = setup.readings.position[index_of(axis.name)];
    if (!is_rotary(axis.name) || column.empty()) continue;
    const auto [least, most] = std::ranges::minmax(column);
    if (most - least > kMoves) turning.push_back(axis.name);
  }
  return turning;
}

bool is_within_travel(const std::vector<double>& column, double factor, const Axis& axis) {
  const double margin = kOutside * axis.travel();
  return std::ranges::all_of(column, [&](double q) {
    return factor * q >= axis.travel_min - margin && factor * q <= axis.travel_max + margin;
  });
}

int changes_of(const Reinterpretations& taken) {
  int changes = 0;
  for (const Reinterpretation& each : taken) changes += each.changes();
  return changes;
}

/// Every way of taking the positions that stays within the travel, fewest changes first.
std::vector<Reinterpretations> all_ways(const Setup& setup, const Machine& machine,
                                        const std::vector<AxisName>& turning) {
  std::vector<Reinterpretations> ways(1);
  for (const AxisName axis : turning) {
    std::vector<Reinterpretations> more;
    for (const Reinterpretations& way : ways) {
      for (const Reinterpretation& own : kReinterpretations) {
        const auto& column = setup.readings.position[index_of(axis)];
        if (own.changes() > 0 && !is_within_travel(column, own.factor(), machine.axis(axis))) continue;
        more.push_back(way);
        more.back()[index_of(axis)] = own;
      }
    }
    ways = std::move(more);
  }
  std::ranges::stable_sort(ways, {}, changes_of);
  return ways;
}

Finding angles_misread(const Reinterpretations& taken, double miss, double better) {
  std::vector<std::string> columns;
  std::vector<FindingNumber> factors;
  for (const AxisName axis : kAllAxes) {
    const Reinterpretation& own = taken[index_of(axis)];
    if (own.changes() == 0) continue;
    columns.push_back(axis_column(axis));
    factors.push_back({own.factor()});
  }
  return {FindingCode::ReadingsAnglesMisread,
          {{"columns", columns},
           {"factors", factors},
           {"miss", FindingNumber{miss, "mm", kMetrePerMillimetre}},
           {"better", FindingNumber{better, "mm", kMetrePerMillimetre}}}};
}

std::optional<Finding> against_geometry(const NominalGeometry& geometry,
                                        const std::vector<Reinterpretations>& ways) {
  const double as_read = geometry.miss(ways.front());
  if (as_read <= kDoubtfulMiss) return std::nullopt;
  const Reinterpretations* best = nullptr;
  double least = as_read;
  for (const Reinterpretations& way : ways) {
    const double miss = geometry.miss(way);
    if (miss >= kClearlyBetter * least) continue;
    least = miss;
    best = &way;
  }
  if (best != nullptr && least <= kBetter * as_read) return angles_misread(*best, as_read, least);
  if (!geometry.is_of_one_place()) return std::nullopt;
  return Finding{FindingCode::ReadingsPositionsMisread,
                 {{"miss", FindingNumber{as_read, "mm", kMetrePerMillimetre}}}};
}

/// Positions of up to a turn in radians that are whole or half degrees, and no round numbers as degrees.
bool looks_like_radians(const std::vector<double>& column) {
  std::set<double> positions;
  for (const double q : column) {
    const double read_deg = q / kRadianPerDegree;
    if (std::abs(read_deg) > kLargestRadian_deg) return false;
    const double meant_deg = read_deg / kRadianPerDegree;
    const double nearest_deg = std::round(meant_deg / kRoundDegree) * kRoundDegree;
    if (std::abs(meant_deg - nearest_deg) > kRoundedRadian / kRadianPerDegree) return false;
    const double hundredths = read_deg * 100.0;
    if (std::abs(hundredths - std::round(hundredths)) > 100.0 * kExactDegree) positions.insert(q);
  }
  return positions.size() >= kFewestPositions;
}

}  // namespace

std::optional<Finding> doubtful_angles(const Setup& setup, const Machine& machine) {
  const std::vector<AxisName> turning = turning_axes(setup, machine);
  if (turning.empty() || turning.size() > 3) return std::nullopt;
  const NominalGeometry geometry(setup, machine);
  if (geometry.says_something()) {
    if (auto doubt = against_geometry(geometry, all_ways(setup, machine, turning))) return doubt;
  }
  std::vector<std::string> columns;
  for (const AxisName axis : turning) {
    const auto& column = setup.readings.position[index_of(axis)];
    if (looks_like_radians(column) && is_within_travel(column, 1.0 / kRadianPerDegree, machine.axis(axis)))
      columns.push_back(axis_column(axis));
  }
  if (columns.empty()) return std::nullopt;
  return Finding{FindingCode::ReadingsAnglesInRadians, {{"columns", columns}}};
}

}  // namespace volcal
