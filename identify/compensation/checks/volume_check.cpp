#include "volcal/identify/compensation/checks/volume_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "volcal/identify/compensation/checks/rotary_check.h"
#include "volcal/identify/errors/volume/volume_uncertainty.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr int kStepCells = 11;                                   // per axis, when a step is chosen
constexpr double kCoarsestDecade = 10.0, kFinestStep = 0.99e-4;  // m

/// The error that is left where a compensation acts.
DisplacementField corrected(const DisplacementField& errors, const DisplacementField& correction) {
  return [errors, correction](const AxisPosition& position, const ApproachDirection& direction) {
    return Eigen::Vector3d(errors(position, direction) + correction(position, direction));
  };
}

DisplacementField corrected(const DisplacementField& errors, const Compensation& ideal) {
  return [errors, &ideal](const AxisPosition& position, const ApproachDirection& direction) {
    return Eigen::Vector3d(errors(position, direction) + ideal.correction(position, direction));
  };
}

/// The part of a field that a type is about.
DisplacementField part_of(const Compensation& type) {
  return [&type](const AxisPosition& position, const ApproachDirection& direction) {
    return type.error_of_type(position, direction);
  };
}

/// What an ideal correction of every component that an axis moves would leave.
std::optional<FixedLeft> fixed_left(const Machine& machine, const std::vector<VolumePoint>& points,
                                    const DisplacementField& errors) {
  const Eigen::Vector3d fixed = Eigen::Vector3d::Ones() - movable_directions(machine);
  if (fixed.isZero()) return std::nullopt;
  FixedLeft left;
  for (const AxisName axis : kLinearAxes) {
    if (fixed[direction_of(axis)] != 0.0) left.axes.push_back(axis);
  }
  left.error =
      error_left(machine, points, [&](const AxisPosition& position, const ApproachDirection& direction) {
        return Eigen::Vector3d(errors(position, direction).cwiseProduct(fixed));
      });
  return left;
}

/// 5, 2 and 1 x 10^n up to `longest`, coarse to fine, m.
std::vector<double> round_steps(double longest) {
  std::vector<double> steps;
  for (double decade = kCoarsestDecade; decade >= kFinestStep; decade /= 10.0) {
    for (const double factor : {5.0, 2.0, 1.0}) {
      if (factor * decade <= longest) steps.push_back(factor * decade);
    }
  }
  return steps;
}

/// Largest difference of a component; home approached towards + is the zero of both.
double largest_deviation(const Machine& machine, const Compensation& ideal,
                         const DisplacementField& correction, bool both_directions) {
  const auto difference = [&](const AxisPosition& position, const ApproachDirection& direction) {
    return Eigen::Vector3d(correction(position, direction) - ideal.correction(position, direction));
  };
  const std::vector<ApproachDirection> directions =
      both_directions ? std::vector<ApproachDirection>{{1, 1, 1, 0, 0, 0}, {-1, -1, -1, 0, 0, 0}}
                      : std::vector<ApproachDirection>{{}};
  const Eigen::Vector3d zero = difference(home_of(machine), directions.front());
  double largest = 0.0;
  for (const AxisPosition& position : spread_places(machine, machine.main_linear_axes(), kStepCells)) {
    for (const ApproachDirection& direction : directions)
      largest = std::max(largest, (difference(position, direction) - zero).cwiseAbs().maxCoeff());
  }
  return largest;
}

/// Every point with the parallel axes at home and at the ends of their travel.
std::vector<VolumePoint> over_parallel_axes(const Machine& machine, std::vector<VolumePoint> points) {
  for (const AxisName name : machine.parallel_axes()) {
    const Axis& axis = machine.axis(name);
    std::vector<VolumePoint> more = points;
    for (const double end : {axis.travel_min, axis.travel_max}) {
      if (end == axis.home) continue;
      for (VolumePoint point : points) {
        point.position[index_of(name)] = end;
        more.push_back(point);
      }
    }
    points = std::move(more);
  }
  return points;
}

}  // namespace

std::string FixedLeft::axes_text() const {
  std::string text;
  for (const AxisName axis : axes) text += (text.empty() ? "" : " and ") + std::string(1, letter_of(axis));
  return text;
}

ErrorLeft error_left(const Machine& machine, const std::vector<VolumePoint>& points,
                     const DisplacementField& errors) {
  std::vector<Eigen::Vector3d> places, vectors;
  const auto add = [&](bool inside) {
    for (const VolumePoint& point : points) {
      if (point.inside != inside) continue;
      places.push_back(place_of(machine, point.position));
      vectors.push_back(errors(point.position, point.direction));
    }
  };
  add(true);
  const std::size_t inside = places.size();
  add(false);
  const std::vector<Eigen::Vector3d> left = without_rigid_motion(places, vectors, inside);
  return {volumetric_figures(std::span(left).first(inside)).rms, volumetric_figures(left).max};
}

namespace {

/// The stated conditions with every one that the effects depend on at its least and at its greatest.
std::vector<Conditions> ends_of_conditions(const FitResult& result, const MachineEffects& effects,
                                           const Conditions& stated) {
  std::vector<Conditions> all = {stated};
  const auto vary = [&all](const RecordedRange& range, auto&& set) {
    if (!(range.max > range.min)) return;
    std::vector<Conditions> more;
    for (const Conditions& conditions : all) {
      for (const double value : {range.min, range.max}) {
        more.push_back(conditions);
        set(more.back(), value);
      }
    }
    all = std::move(more);
  };
  std::set<std::string> channels;
  bool time = false, feed = false;
  for (std::size_t e = 0; e < effects.effect_count(); ++e) {
    channels.insert(effects.reach(e).temperature.begin(), effects.reach(e).temperature.end());
    time |= effects.reach(e).time;
    feed |= effects.reach(e).feed;
  }
  for (const Axis& axis : result.machine.axes) {
    if (axis.expansion) channels.insert(axis.expansion->channel);
  }
  constexpr std::size_t kMostEnds = 64;
  for (const std::string& channel : channels) {
    const auto range = result.conditions.temperature_degC.find(channel);
    if (range == result.conditions.temperature_degC.end() || all.size() >= kMostEnds) continue;
    vary(range->second,
         [&](Conditions& conditions, double value) { conditions.temperature_degC[channel] = value; });
  }
  if (time && result.conditions.time)
    vary(*result.conditions.time, [](Conditions& conditions, double value) { conditions.time = value; });
  if (feed && result.conditions.feed)
    vary(*result.conditions.feed, [](Conditions& conditions, double value) { conditions.feed = value; });
  return all;
}

std::optional<ErrorLeft> left_over_conditions(const FitResult& result, const TableFormatOptions& options,
                                              const DisplacementField& correction,
                                              const std::vector<VolumePoint>& points) {
  const Conditions stated = conditions_of(result, options);
  const Tool& tool = tool_of(result.machine, options);
  const std::vector<Conditions> ends =
      ends_of_conditions(result, MachineEffects(result, tool, stated), stated);
  if (ends.size() < 2) return std::nullopt;
  ErrorLeft over{0.0, 0.0};
  for (const Conditions& conditions : ends) {
    TableFormatOptions there = options;
    there.conditions = conditions;
    const ErrorLeft left =
        error_left(result.machine, points, corrected(errors_to_correct(result, there), correction));
    over.rms += left.rms * left.rms / static_cast<double>(ends.size());
    over.max = std::max(over.max, left.max);
  }
  over.rms = std::sqrt(over.rms);
  return over;
}

int places_inside(const std::vector<VolumePoint>& points) {
  const auto from_plus = [](const VolumePoint& point) {
    return point.inside && std::ranges::all_of(point.direction, [](int sign) { return sign >= 0; });
  };
  return static_cast<int>(std::ranges::count_if(points, from_plus));
}

/// Half of the approaches: directions of different axes are uncorrelated in them, as in all eight.
double identification_uncertainty(const FitResult& result, const TableFormatOptions& options,
                                  const std::vector<VolumePoint>& points) {
  std::vector<AxisPosition> positions;
  std::vector<ApproachDirection> directions;
  for (const VolumePoint& point : points) {
    if (!point.inside || point.direction[0] * point.direction[1] * point.direction[2] < 0) continue;
    positions.push_back(point.position);
    directions.push_back(point.direction);
  }
  return volume_uncertainty(result, tool_of(result.machine, options), conditions_of(result, options),
                            positions, directions);
}

}  // namespace

double VolumeCheck::expected_rms() const { return std::hypot(exported.rms, identification_u); }

VolumeCheck check_in_volume(const FitResult& result, const TableFormatOptions& options,
                            const CompensationTables& tables) {
  const Machine& machine = result.machine;
  const DisplacementField errors = errors_to_correct(result, options);
  const DisplacementField measured =
      displacement_field(result, tool_of(machine, options), conditions_of(result, options));
  const AxisPosition lines = lines_of(machine, options);
  const Compensation ideal(machine, lines, options.type, errors);
  const DisplacementField correction = linear_part(result, options, tables);
  const DisplacementField exported = corrected(errors, correction);
  const std::vector<VolumePoint> points = volume_points(machine, kVolumeCells);

  VolumeCheck check;
  check.places = places_inside(points);
  check.before = error_left(machine, points, measured);
  check.ideal = error_left(machine, points, corrected(errors, ideal));
  check.exported = error_left(machine, points, exported);
  for (const CompensationPart part : kLinearCompensationParts) {
    const Compensation of_before(machine, lines, part, measured), of_exported(machine, lines, part, exported);
    check.parts.push_back({part, error_left(machine, points, part_of(of_before)),
                           error_left(machine, points, part_of(of_exported))});
  }
  check.fixed = fixed_left(machine, points, measured);
  check.identification_u = identification_uncertainty(result, options, points);
  check.over_conditions = left_over_conditions(result, options, correction, points);
  if (!machine.parallel_axes().empty()) {
    const std::vector<VolumePoint> over = over_parallel_axes(machine, points);
    check.over_parallel = {{}, error_left(machine, over, measured), error_left(machine, over, exported)};
    for (const AxisName axis : machine.parallel_axes())
      check.over_parallel->axes.push_back(machine.axis(axis));
  }
  return check;
}

namespace {

double deviation_from(const Compensation& ideal, const TableFormat& format, const FitResult& result,
                      const TableFormatOptions& options, const CompensationTables& tables) {
  return largest_deviation(result.machine, ideal, linear_part(result, options, tables),
                           format.limits.both_directions);
}

}  // namespace

double deviation_of(const TableFormat& format, const FitResult& result, const TableFormatOptions& options,
                    const CompensationTables& tables) {
  return deviation_from(sampled_compensation(format, result, options), format, result, options, tables);
}

StepChoice choose_step(const TableFormat& format, const FitResult& result, TableFormatOptions options,
                       double tolerance) {
  if (!format.limits.sampled) return {0.0, 0.0, true, {}};
  // What tables of rotary axes leave is no matter of the step.
  if (!format.indivisible && !options.type.linear().empty()) options.type = options.type.linear();
  const Compensation ideal = sampled_compensation(format, result, options);
  double longest = 0.0;
  for (const AxisName axis : result.machine.main_linear_axes())
    longest = std::max(longest, 0.5 * result.machine.axis(axis).travel());
  StepChoice best{0.0, std::numeric_limits<double>::infinity(), false, {}};
  std::optional<InputError> refused;  // by the coarsest step
  for (const double step : round_steps(longest)) {
    options.step = step;
    try {
      const std::vector<TableFile> files = write_tables(format, result, options);
      if (bytes_of(files) > kMostTableBytes) break;
      const double deviation = deviation_from(ideal, format, result, options, format.read(files));
      if (deviation < best.deviation) best = {step, deviation, false, {}};
      best.reached = best.deviation <= tolerance + 0.5 * format.limits.resolution;
    } catch (const InputError& error) {  // too many points, or values out of range where it is too coarse
      if (!refused) refused = error;
      if (best.step > 0.0 && best.refusal.empty()) best.refusal = error.problem();
    }
    if (best.reached) break;
  }
  if (best.step == 0.0 && refused) throw InputError(*refused);
  return best;
}

}  // namespace volcal
