#include "volcal/identify/standards/rotary_tests.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "volcal/identify/standards/approach.h"
#include "volcal/identify/standards/positioning_notes.h"
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
constexpr double kTestTurn = 2.0 * std::numbers::pi;

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

PositioningFigures angular_figures(const Machine& machine, const Setup& setup, AxisName axis, double sense,
                                   const SetupValues& values, const std::vector<double>& value) {
  const std::vector<int> approach = axis_approach(machine, setup.readings, axis);
  std::vector<PositioningReading> readings;
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (!values.has(row)) continue;
    readings.push_back({setup.readings.position[index_of(axis)][row], sense * value[row], approach[row]});
  }
  return positioning_figures(readings);
}

bool same_angle_of_turn(double one, double other) {
  return std::abs(std::remainder(one - other, kTestTurn)) <= kSameTestAngle;
}

/// Of every row: how often its angle, a turn more or less, was met before.
std::vector<int> visits_before(const std::vector<double>& angles) {
  std::vector<int> visits;
  std::vector<std::pair<double, int>> met;
  for (const double angle : angles) {
    const auto known =
        std::ranges::find_if(met, [&](const auto& each) { return same_angle_of_turn(each.first, angle); });
    visits.push_back(known == met.end() ? 0 : ++known->second);
    if (known == met.end()) met.emplace_back(angle, 0);
  }
  return visits;
}

/// Displacements of a sphere while one axis turns, in the directions of the body that carries the axis.
struct TurnedSphere {
  const Setup* setup = nullptr;
  AxisName axis = AxisName::C;
  double turn_sense = 1.0;  ///< of the turning body for a positive command
  double height = 0.0;      ///< of the tool point along the axis, from its centre, m
  std::vector<double> angle;
  std::vector<int> visit;  ///< of the angle, a turn more or less, in the order of reading
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
  const std::vector<int> visit = visits_before(setup.readings.position[index_of(axis)]);
  TurnedSphere sphere{&setup, axis, 1.0, 0.0, {}, {}, {}, {}, notes_on_removed(values)};
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (!values.has(row)) continue;
    const AxisPosition position = setup.readings.commanded_position(row);
    const JointLever lever = lever_of(chain, position, tool, axis);
    sphere.turn_sense = lever.workpiece_side ? -1.0 : 1.0;
    sphere.height = lever.arm_s[direction_of(axis)];
    sphere.angle.push_back(position[index_of(axis)]);
    sphere.visit.push_back(visit[row]);
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

std::optional<std::size_t> same_visit(const TurnedSphere& sphere, double angle, int visit) {
  for (std::size_t k = 0; k < sphere.angle.size(); ++k) {
    if (sphere.visit[k] == visit && same_angle_of_turn(sphere.angle[k], angle)) return k;
  }
  return std::nullopt;
}

/// Rotation across the axis that moves two spheres differently: (h x (d2 - d1)) / h^2, h along the axis. Of
/// every visit of an angle at one sphere and the same visit at the other: turns may differ.
std::vector<RotationReading> tilt_plot(const TurnedSphere& low, const TurnedSphere& high, int about,
                                       std::vector<Vector3d> TurnedSphere::*values) {
  const Vector3d apart = Vector3d::Unit(direction_of(low.axis)) * (high.height - low.height);
  std::vector<RotationReading> plot;
  for (std::size_t k = 0; k < low.angle.size(); ++k) {
    const std::optional<std::size_t> same = same_visit(high, low.angle[k], low.visit[k]);
    if (!same) continue;
    const Vector3d between = (high.*values)[*same] - (low.*values)[k];
    plot.push_back({low.angle[k], (apart.cross(between) / apart.squaredNorm())[about]});
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
                                                            std::span<const SetupValues> values,
                                                            std::vector<Finding>& not_recognised) {
  std::vector<RotaryPositioningTest> tests;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    if (traits_of(setup).line_reading != LineReading::Rotation) continue;
    const std::vector<AxisName> moving = moving_axes(setup);
    if (std::ranges::none_of(moving, is_rotary)) continue;  // angles of a linear axis have no such figures
    if (moving.size() > 1) {
      not_recognised.push_back({FindingCode::NoTestSeveralAxesMove, {{"setup", setup.name}}});
      continue;
    }
    const AxisName axis = moving.front();
    const double sense = sense_of_reading(campaign, setup, axis);
    if (sense == 0.0) {
      not_recognised.push_back({FindingCode::NoTestAngleNotRead,
                                {{"setup", setup.name}, {"axis", std::string(1, letter_of(axis))}}});
      continue;
    }
    const auto figures = [&](const std::vector<std::vector<double>>& value) {
      return angular_figures(campaign.machine, setup, axis, sense, values[i], value[0]);
    };
    PositioningFigures readings = figures(values[i].reading);
    std::vector<Finding> notes = notes_on_positioning(readings, values[i], "urad");
    tests.push_back({setup.name,
                     axis,
                     place_of_other_axes(campaign, setup, axis),
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
