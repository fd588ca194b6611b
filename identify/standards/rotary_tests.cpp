#include "volcal/identify/standards/rotary_tests.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "volcal/identify/standards/approach.h"
#include "volcal/identify/standards/test_paths.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/instruments/reading_frame.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr double kAlongAxis = 0.01;      // rad between the axis of a reading and the rotary axis
constexpr double kApartOnAxis = 5e-3;    // m between spheres, at least
constexpr double kSameTestAngle = 1e-4;  // rad

const Setup* as_test_of_one_axis(const Setup& setup, std::optional<AxisName>& axis) {
  const std::vector<AxisName> moving = moving_axes(setup);
  if (setup.readings.size() == 0 || moving.size() != 1 || !is_rotary(moving.front())) return nullptr;
  axis = moving.front();
  return &setup;
}

JointLever lever_of(const KinematicChain& chain, const AxisPosition& position, const Vector3d& tool,
                    AxisName axis) {
  JointLever levers[kAxisCount];
  chain.levers(position, tool, levers);
  return *std::find_if(levers, levers + chain.joint_count(),
                       [&](const JointLever& lever) { return lever.axis == axis; });
}

/// Sign by which a reading counts in the sense of the command; 0 where it does not read the axis' angle.
double sense_of_reading(const Campaign& campaign, const Setup& setup, AxisName axis) {
  const KinematicChain chain(campaign.machine);
  const Vector3d read_w = setup.options.vector("axis").value_or(Vector3d::Zero()).normalized();
  const JointLever lever =
      lever_of(chain, setup.readings.commanded_position(0), campaign.machine.tools[setup.tool].offset, axis);
  const Vector3d axis_w = lever.rotation_ws.col(direction_of(axis));
  if (read_w.cross(axis_w).norm() > kAlongAxis || read_w.isZero()) return 0.0;
  const double sense = read_w.dot(axis_w) > 0.0 ? 1.0 : -1.0;
  const std::string body = setup.options.text("body").value_or("relative");
  if (body == "relative") return sense;
  const bool turns_body = (body == "table") == lever.workpiece_side;
  return !turns_body ? 0.0 : body == "table" ? -sense : sense;
}

std::vector<Finding> positioning_notes(const PositioningFigures& figures, const SetupValues& values) {
  std::vector<Finding> notes = notes_on_removed(values);
  if (figures.unknown_direction > 0) {
    notes.push_back({FindingCode::StandardsApproachUnknown,
                     {{"readings", static_cast<std::int64_t>(figures.unknown_direction)}}});
  }
  if (!figures.positive.repeatability && !figures.negative.repeatability)
    notes.push_back({FindingCode::StandardsRepeatabilityUndefined});
  return notes;
}

PositioningFigures angular_figures(const Setup& setup, AxisName axis, double sense, const SetupValues& values,
                                   const std::vector<double>& value) {
  const std::vector<int> approach = axis_approach(setup.readings, axis);
  std::vector<PositioningReading> readings;
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (!values.has(row)) continue;
    readings.push_back({setup.readings.position[index_of(axis)][row], sense * value[row], approach[row]});
  }
  return positioning_figures(readings);
}

/// Displacements of a sphere while one axis turns, in the directions of the body that carries the axis.
struct TurnedSphere {
  const Setup* setup = nullptr;
  AxisName axis = AxisName::C;
  double turn_sense = 1.0;  ///< of the turning body for a positive command
  double height = 0.0;      ///< of the tool point along the axis, from its centre, m
  std::vector<double> angle;
  std::vector<Vector3d> reading_s;
  std::vector<Vector3d> predicted_s;
  std::vector<Finding> notes;

  int across(int k) const { return (direction_of(axis) + 1 + k) % 3; }
};

TurnedSphere turned_sphere(const Campaign& campaign, const Setup& setup, AxisName axis,
                           const SetupValues& values) {
  const KinematicChain chain(campaign.machine);
  const Vector3d& tool = campaign.machine.tools[setup.tool].offset;
  const std::vector<Vector3d> reading_w = displacements_w(campaign, setup, values.reading);
  const std::vector<Vector3d> predicted_w = displacements_w(campaign, setup, values.predicted);
  TurnedSphere sphere{&setup, axis, 1.0, 0.0, {}, {}, {}, notes_on_removed(values)};
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (!values.has(row)) continue;
    const AxisPosition position = setup.readings.commanded_position(row);
    const JointLever lever = lever_of(chain, position, tool, axis);
    sphere.turn_sense = lever.workpiece_side ? -1.0 : 1.0;
    sphere.height = lever.arm_s[direction_of(axis)];
    sphere.angle.push_back(position[index_of(axis)]);
    sphere.reading_s.emplace_back(lever.rotation_ws.transpose() * reading_w[row]);
    sphere.predicted_s.emplace_back(lever.rotation_ws.transpose() * predicted_w[row]);
  }
  return sphere;
}

template <class Of>
std::vector<RotationReading> motion_plot(const std::vector<double>& angle,
                                         const std::vector<Vector3d>& values, Of of) {
  std::vector<RotationReading> plot;
  for (std::size_t k = 0; k < angle.size(); ++k) plot.push_back({angle[k], of(angle[k], values[k])});
  return plot;
}

ErrorMotionTest motion_test(std::string setup, AxisName axis, ErrorMotion motion, int direction,
                            std::vector<RotationReading> readings, std::vector<RotationReading> model,
                            std::vector<Finding> notes) {
  const MotionCentre centre =
      motion == ErrorMotion::Axial ? MotionCentre::PolarChart : MotionCentre::LeastSquares;
  ErrorMotionTest test{std::move(setup), axis, motion, direction, {}, {}, std::move(notes)};
  test.figures = {error_motion_figures(readings, centre), error_motion_figures(model, centre)};
  test.plots = {about_centre(readings, centre), about_centre(model, centre)};
  return test;
}

/// Two fixed radial directions, the rotating one, axial.
void add_motions_of_sphere(const TurnedSphere& sphere, std::vector<ErrorMotionTest>& tests) {
  const auto add = [&](ErrorMotion motion, int direction, auto of) {
    tests.push_back(motion_test(sphere.setup->name, sphere.axis, motion, direction,
                                motion_plot(sphere.angle, sphere.reading_s, of),
                                motion_plot(sphere.angle, sphere.predicted_s, of), sphere.notes));
  };
  for (const int k : {0, 1}) {
    const int direction = sphere.across(k);
    add(ErrorMotion::RadialFixed, direction,
        [direction](double, const Vector3d& value) { return value[direction]; });
  }
  const int first = sphere.across(0), second = sphere.across(1);
  add(ErrorMotion::RadialRotating, first, [&sphere, first, second](double angle, const Vector3d& value) {
    const double turned = sphere.turn_sense * angle;
    return value[first] * std::cos(turned) + value[second] * std::sin(turned);
  });
  const int along = direction_of(sphere.axis);
  add(ErrorMotion::Axial, along, [along](double, const Vector3d& value) { return value[along]; });
}

/// Mean of the values read at an angle.
std::optional<Vector3d> mean_at(const TurnedSphere& sphere, const std::vector<Vector3d>& values,
                                double angle) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (std::size_t k = 0; k < sphere.angle.size(); ++k) {
    if (std::abs(sphere.angle[k] - angle) > kSameTestAngle) continue;
    sum += values[k];
    ++count;
  }
  if (count == 0) return std::nullopt;
  return Vector3d(sum / count);
}

/// Rotation across the axis that moves two spheres differently: (h x (d2 - d1)) / h^2, h along the axis.
std::vector<RotationReading> tilt_plot(const TurnedSphere& low, const TurnedSphere& high, int about,
                                       std::vector<Vector3d> TurnedSphere::*values) {
  const Vector3d apart = Vector3d::Unit(direction_of(low.axis)) * (high.height - low.height);
  std::vector<RotationReading> plot;
  std::vector<double> met;
  for (const double angle : low.angle) {
    const bool again =
        std::ranges::any_of(met, [&](double known) { return std::abs(known - angle) <= kSameTestAngle; });
    if (again) continue;
    met.push_back(angle);
    const auto first = mean_at(low, low.*values, angle), second = mean_at(high, high.*values, angle);
    if (!first || !second) continue;
    plot.push_back({angle, (apart.cross(*second - *first) / apart.squaredNorm())[about]});
  }
  return plot;
}

void add_tilts(const std::vector<TurnedSphere>& spheres, std::vector<ErrorMotionTest>& tests) {
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t k = i + 1; k < spheres.size(); ++k) {
      const TurnedSphere& one = spheres[i];
      const TurnedSphere& other = spheres[k];
      if (one.axis != other.axis || std::abs(one.height - other.height) < kApartOnAxis) continue;
      std::vector<Finding> notes = one.notes;
      notes.insert(notes.end(), other.notes.begin(), other.notes.end());
      for (const int side : {0, 1}) {
        const int about = one.across(side);
        tests.push_back(motion_test(one.setup->name + ", " + other.setup->name, one.axis, ErrorMotion::Tilt,
                                    about, tilt_plot(one, other, about, &TurnedSphere::reading_s),
                                    tilt_plot(one, other, about, &TurnedSphere::predicted_s), notes));
      }
    }
  }
}

}  // namespace

bool reads_displacements(const Setup& setup) {
  return setup.readings.channels() == 3 && find_instrument(setup.instrument) != nullptr &&
         channel_column(setup, 0).starts_with("dx");
}

std::vector<Vector3d> displacements_w(const Campaign& campaign, const Setup& setup,
                                      const std::vector<std::vector<double>>& value) {
  const SetupContext context{setup, campaign.machine, campaign.file, nominal_points_w(campaign, setup)};
  const std::vector<ReadingFrame> frames = reading_frames(context);
  std::vector<Vector3d> displacements;
  for (std::size_t row = 0; row < setup.readings.size(); ++row)
    displacements.emplace_back(frames[row].rotation.transpose() *
                               Vector3d(value[0][row], value[1][row], value[2][row]));
  return displacements;
}

std::vector<RotaryPositioningTest> rotary_positioning_tests(const Campaign& campaign,
                                                            std::span<const SetupValues> values) {
  std::vector<RotaryPositioningTest> tests;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    std::optional<AxisName> axis;
    if (traits_of(setup).line_reading != LineReading::Rotation || !as_test_of_one_axis(setup, axis)) continue;
    const double sense = sense_of_reading(campaign, setup, *axis);
    if (sense == 0.0) continue;
    const auto figures = [&](const std::vector<std::vector<double>>& value) {
      return angular_figures(setup, *axis, sense, values[i], value[0]);
    };
    PositioningFigures readings = figures(values[i].reading);
    std::vector<Finding> notes = positioning_notes(readings, values[i]);
    tests.push_back({setup.name,
                     *axis,
                     place_of_other_axes(campaign, setup, *axis),
                     {std::move(readings), figures(values[i].predicted)},
                     std::move(notes)});
  }
  return tests;
}

std::vector<ErrorMotionTest> error_motion_tests(const Campaign& campaign,
                                                std::span<const SetupValues> values) {
  std::vector<TurnedSphere> spheres;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    std::optional<AxisName> axis;
    if (!reads_displacements(setup) || !as_test_of_one_axis(setup, axis)) continue;
    spheres.push_back(turned_sphere(campaign, setup, *axis, values[i]));
  }
  std::vector<ErrorMotionTest> tests;
  for (const TurnedSphere& sphere : spheres) add_motions_of_sphere(sphere, tests);
  add_tilts(spheres, tests);
  return tests;
}

}  // namespace volcal
