#include "volcal/identify/report/values/rotary_pictures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/statistics/even_sample.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr int kPositionsOfAMotion = 181;
constexpr std::size_t kMostTools = 4;
constexpr std::size_t kMostMeasured = 400;
constexpr double kMapStep = 10.0 * kRadianPerDegree;
constexpr double kShareOfTravel = 0.25;

bool is_determined(const FitResult& result, const MachineError& error) {
  const auto found = std::ranges::find(result.rank.errors, error, &Observability::symbol);
  return found == result.rank.errors.end() || found->visible;
}

RotaryMotion motion_of(const FitResult& result, ErrorSymbol symbol,
                       const std::map<int, std::vector<const ErrorTableRow*>>& by_direction) {
  RotaryMotion motion;
  motion.symbol = symbol;
  motion.visible = is_determined(result, symbol);
  for (const ErrorTableRow* row : by_direction.begin()->second) {
    motion.position.push_back(row->position);
    motion.extrapolated.push_back(row->extrapolated);
  }
  for (const auto& [direction, rows] : by_direction) {
    RotaryMotion::Curve& curve = motion.curves.emplace_back();
    curve.direction = direction;
    for (const ErrorTableRow* row : rows) {
      curve.value.push_back(row->value);
      curve.U95.push_back(row->U95);
    }
  }
  return motion;
}

std::vector<RotaryMotion> motions_of(const FitResult& result) {
  ErrorTableOptions options;
  options.positions = kPositionsOfAMotion;
  const std::vector<ErrorTableRow> table = error_table(result, options);
  std::map<MachineError, std::map<int, std::vector<const ErrorTableRow*>>> by_symbol;
  for (const ErrorTableRow& row : table) {
    if (row.axis && is_rotary(*row.axis)) by_symbol[row.symbol][row.direction].push_back(&row);
  }
  std::vector<RotaryMotion> motions;
  for (const AxisName axis : kAllAxes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis};
      const auto rows = by_symbol.find(symbol);
      if (rows != by_symbol.end()) motions.push_back(motion_of(result, symbol, rows->second));
    }
  }
  return motions;
}

std::vector<RotaryLine> lines_of(const FitResult& result) {
  std::vector<RotaryLine> lines;
  for (const IdentifiedLine& line : identified_lines(result)) {
    RotaryLine& drawn = lines.emplace_back();
    drawn.line = line;
    drawn.centre = result.machine.axis(line.axis).centre;
    for (const ParameterBlock& block : result.layout.blocks) {
      if (!block.location || block.location->axis != line.axis) continue;
      if (!is_determined(result, *block.location)) drawn.not_visible.push_back(*block.location);
    }
  }
  return lines;
}

/// The next of 1, 2, 5 x 10^n below.
double round_length(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= length) return step * power;
  }
  return power;
}

double reach_of(const Machine& machine) {
  double travel = 0.0;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) travel = std::max(travel, axis.travel());
  }
  constexpr double kWithoutLinearAxes = 0.1;
  return travel > 0.0 ? round_length(kShareOfTravel * travel) : kWithoutLinearAxes;
}

/// Pairs of positions, each once.
std::vector<std::vector<double>> measured_positions(const Campaign& campaign,
                                                    const std::vector<RotaryNodes>& axes) {
  constexpr double kSame = 1e3;  // per rad: positions closer than a milliradian are one
  std::map<std::vector<long long>, std::vector<double>> places;
  for (const Setup& setup : campaign.setups) {
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      std::vector<long long> key;
      std::vector<double> place;
      for (const RotaryNodes& nodes : axes) {
        const auto& column = setup.readings.position[index_of(nodes.axis)];
        place.push_back(column.empty() ? 0.0 : column[row]);
        key.push_back(std::llround(place.back() * kSame));
      }
      places.emplace(std::move(key), std::move(place));
    }
  }
  std::vector<std::vector<double>> all;
  for (auto& [key, place] : places) all.push_back(std::move(place));
  std::vector<std::vector<double>> drawn(axes.size());
  for (const std::size_t i : even_sample(all.size(), kMostMeasured)) {
    for (std::size_t k = 0; k < axes.size(); ++k) drawn[k].push_back(all[i][k]);
  }
  return drawn;
}

std::vector<CarriedDisplacement> carried_displacements(const FitResult& result) {
  std::vector<CarriedDisplacement> all;
  const Joint* carrying = nullptr;
  for (const Joint& joint : result.machine.structure.joints) {
    if (!is_rotary(joint.axis) || joint.workpiece_side) continue;
    if (carrying != nullptr && direction_of(carrying->axis) != direction_of(joint.axis)) {
      CarriedDisplacement carried{carrying->axis, joint.axis, {}};
      for (const Component component : {Component::X, Component::Y, Component::Z}) {
        const ErrorSymbol motion{component, carrying->axis};
        if (direction_of(component) != direction_of(motion.axis) && result.layout.find(motion))
          carried.motions.push_back(motion);
      }
      if (!carried.motions.empty()) all.push_back(std::move(carried));
    }
    carrying = &joint;
  }
  return all;
}

}  // namespace

double RotaryMotion::range() const {
  double low = std::nan(""), high = low;
  for (const Curve& curve : curves) {
    for (std::size_t i = 0; i < curve.value.size(); ++i) {
      if (extrapolated[i]) continue;
      low = std::fmin(low, curve.value[i]);
      high = std::fmax(high, curve.value[i]);
    }
  }
  return high - low;
}

std::optional<RotaryPictures> rotary_pictures(const FitResult& result, const Campaign& campaign) {
  if (identified_rotary_axes(result).empty() || result.machine.tools.empty()) return std::nullopt;
  RotaryPictures pictures;
  pictures.coverage_factor = result.coverage_factor;
  pictures.reach = reach_of(result.machine);
  pictures.motions = motions_of(result);
  pictures.lines = lines_of(result);
  pictures.carried = carried_displacements(result);
  const Eigen::Vector3d point_w = middle_point_w(result.machine, result.machine.tools.front());
  for (std::size_t i = 0; i < std::min(kMostTools, result.machine.tools.size()); ++i)
    pictures.maps.push_back(
        rotary_map(result, result.machine.tools[i], point_w, default_conditions(result), kMapStep));
  pictures.measured = measured_positions(campaign, pictures.maps.front().axes);
  return pictures;
}

}  // namespace volcal
