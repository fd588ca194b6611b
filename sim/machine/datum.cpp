#include "volcal/sim/machine/datum.h"

#include <Eigen/Geometry>
#include <array>
#include <stdexcept>

#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

/// 5-point Gauss-Legendre rule on [-1, 1] (Abramowitz and Stegun 25.4.30), exact to degree 9.
constexpr std::array<double, 5> kNode = {-0.90617984593866399280, -0.53846931010568309104, 0.0,
                                         0.53846931010568309104, 0.90617984593866399280};
constexpr std::array<double, 5> kWeight = {0.23692688505618908751, 0.47862867049936646804,
                                           0.56888888888888888889, 0.47862867049936646804,
                                           0.23692688505618908751};
constexpr int kPanels = 400;

/// Across the axis of a rotary axis: displacements and tilts that its average line has.
bool is_transverse(ErrorSymbol symbol) {
  return is_rotary(symbol.axis) && direction_of(symbol.component) != direction_of(symbol.axis);
}

/// Small displacement of a body: that of its point at the origin, and its rotation.
RigidMotion& operator+=(RigidMotion& sum, const RigidMotion& motion) {
  sum.translation += motion.translation;
  sum.rotation += motion.rotation;
  return sum;
}

}  // namespace

double least_squares_slope(const ErrorFunction& function, double low, double high) {
  const double length = high - low;
  const double centre = 0.5 * (low + high);
  const double half_panel = 0.5 * length / kPanels;
  double integral = 0.0;
  for (int panel = 0; panel < kPanels; ++panel) {
    const double middle = low + (2 * panel + 1) * half_panel;
    for (std::size_t i = 0; i < kNode.size(); ++i) {
      const double q = middle + kNode[i] * half_panel;
      integral += kWeight[i] * half_panel * (q - centre) * function(q);
    }
  }
  return 12.0 * integral / (length * length * length);
}

double uniform_mean(const ErrorFunction& function, double low, double high) {
  const double half_panel = 0.5 * (high - low) / kPanels;
  double sum = 0.0;
  for (int panel = 0; panel < kPanels; ++panel) {
    const double middle = low + (2 * panel + 1) * half_panel;
    for (std::size_t i = 0; i < kNode.size(); ++i)
      sum += 0.5 * kWeight[i] * function(middle + kNode[i] * half_panel);
  }
  return sum / kPanels;
}

TruthInDatum::TruthInDatum(const TruthMachine& truth) : TruthInDatum(truth, truth.machine().datum) {}

TruthInDatum::TruthInDatum(const TruthMachine& truth, Datum datum) : truth_(truth), datum_(datum) {
  for (const Axis& axis : truth.machine().axes) {
    if (!is_rotary(axis.name)) find_slopes(axis);
  }
  for (const Axis& axis : truth.machine().axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      if (!is_transverse(symbol)) continue;
      mean_[symbol] = uniform_mean([&](double q) { return truth.function_value(symbol, q); }, axis.travel_min,
                                   axis.travel_max);
    }
  }
  const Eigen::Vector3d e_p = unit(datum_.primary);
  const Eigen::Vector3d e_s = unit(datum_.secondary);
  const Eigen::Vector3d e_t = unit(datum_.third());
  const Eigen::Vector3d across = e_p.cross(direction_error(datum_.primary));
  const double about_primary = (direction_error(datum_.secondary) - across.cross(e_s)).dot(e_p.cross(e_s));
  frame_rotation_ = across + about_primary * e_p;
  const Eigen::Vector3d secondary = direction_error(datum_.secondary) - frame_rotation_.cross(e_s);
  const Eigen::Vector3d third = direction_error(datum_.third()) - frame_rotation_.cross(e_t);
  squareness_ = {secondary.dot(e_t.cross(e_s)), third.dot(e_p.cross(e_t)), third.dot(e_s.cross(e_t))};
  set_locations();
  set_angles_of_parallel_axes();
  carry_linear_constants();
}

void TruthInDatum::find_slopes(const Axis& axis) {
  for (const Component component : {Component::X, Component::Y, Component::Z}) {
    const ErrorSymbol symbol{component, axis.name};
    if (!symbol.is_straightness()) continue;
    slope_[index_of(axis.name)][index_of(component)] = least_squares_slope(
        [&](double q) { return truth_.function_value(symbol, q); }, axis.travel_min, axis.travel_max);
  }
}

/// Of the mean direction in the frame of the datum, turns about both directions across the axis.
void TruthInDatum::set_angles_of_parallel_axes() {
  const Machine& machine = truth_.machine();
  for (const AxisName axis : machine.parallel_axes()) {
    const Eigen::Vector3d turned = direction_error(axis) - frame_rotation_.cross(unit(axis));
    for (const LocationSymbol& symbol : linear_locations(machine, axis)) {
      const Eigen::Vector3d about = Eigen::Vector3d::Unit(direction_of(symbol.component));
      locations_[symbol] = turned.dot(about.cross(unit(axis)));
    }
  }
}

void TruthInDatum::set_locations() {
  for (const Joint& joint : truth_.machine().structure.joints) {
    if (!is_rotary(joint.axis)) continue;
    const double side = joint.workpiece_side ? -1.0 : 1.0;
    for (const Component component : kAllComponents) {
      const LocationSymbol symbol{component, joint.axis};
      const ErrorSymbol motion{component, joint.axis};
      locations_[symbol] =
          truth_.location(symbol) + (motion.is_positioning() ? 1.0 : side) * removed_constant(motion);
    }
  }
}

/// Home values of the linear axes and the rotation of the machine frame, as far as they lie between two
/// rotary axes. With the twist (T, A) of all home values at the origin and the frame rotation phi, the point
/// x of the innermost body of the workpiece side moves by T + phi x x and the point x_H of that of the tool
/// side by (A - phi) x x_H.
void TruthInDatum::carry_linear_constants() {
  const Machine& machine = truth_.machine();
  RigidMotion all;
  const Joint* table = nullptr;  // rotary, nearest the bed
  const Joint* head = nullptr;
  for (const Joint& joint : machine.structure.joints) {
    if (is_rotary(joint.axis)) {
      if (joint.workpiece_side) table = &joint;
      if (!joint.workpiece_side && head == nullptr) head = &joint;
      continue;
    }
    const Axis& axis = machine.axis(joint.axis);
    RigidMotion own;
    for (int k = 0; k < 3; ++k) {
      const ErrorSymbol motion{kAllComponents[static_cast<std::size_t>(k)], joint.axis};
      own.translation[k] = removed_constant(motion) - removed_slope(motion) * axis.home;
      own.rotation[k] = removed_constant({kAllComponents[static_cast<std::size_t>(k) + 3], joint.axis});
    }
    own.translation -= own.rotation.cross(axis.reference_point);
    all += own;
  }
  const auto add = [&](const Joint& joint, const RigidMotion& motion) {
    const double side = joint.workpiece_side ? -1.0 : 1.0;
    const Eigen::Vector3d at_centre =
        motion.translation + motion.rotation.cross(machine.axis(joint.axis).centre);
    for (const Component component : kAllComponents) {
      const int k = direction_of(component);
      const double value = is_rotation(component) ? motion.rotation[k] : at_centre[k];
      const bool positioning = ErrorSymbol{component, joint.axis}.is_positioning();
      locations_[{component, joint.axis}] += (positioning ? 1.0 : side) * value;
    }
  };
  if (table != nullptr) add(*table, {all.translation, frame_rotation_});
  if (head != nullptr) add(*head, {Eigen::Vector3d::Zero(), all.rotation - frame_rotation_});
}

/// Mean direction of an axis minus its nominal direction: squareness, straightness slopes, and the angles
/// that the axes which carry it have at home.
Eigen::Vector3d TruthInDatum::direction_error(AxisName axis) const {
  const Machine& machine = truth_.machine();
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  for (const LocationSymbol& symbol : linear_locations(machine, axis)) {
    error +=
        truth_.location(symbol) * Eigen::Vector3d::Unit(direction_of(symbol.component)).cross(unit(axis));
  }
  for (int i = 0; i < 3; ++i) error[i] += slope_[index_of(axis)][static_cast<std::size_t>(i)];
  for (const Joint& joint : machine.structure.joints) {
    if (is_rotary(joint.axis)) continue;
    if (joint.axis == axis && !joint.workpiece_side) break;
    const double home = machine.axis(joint.axis).home;
    const Eigen::Vector3d angle{truth_.function_value({Component::A, joint.axis}, home),
                                truth_.function_value({Component::B, joint.axis}, home),
                                truth_.function_value({Component::C, joint.axis}, home)};
    error += angle.cross(unit(axis));
    if (joint.axis == axis) break;
  }
  return error;
}

double TruthInDatum::removed_constant(ErrorSymbol symbol) const {
  const auto mean = mean_.find(symbol);
  return mean != mean_.end() ? mean->second
                             : truth_.function_value(symbol, truth_.machine().axis(symbol.axis).home);
}

double TruthInDatum::value(ErrorSymbol symbol, double position) const {
  const double home = truth_.machine().axis(symbol.axis).home;
  return truth_.function_value(symbol, position) - removed_constant(symbol) -
         removed_slope(symbol) * (position - home);
}

double TruthInDatum::location(LocationSymbol symbol) const {
  const auto found = locations_.find(symbol);
  if (found == locations_.end())
    throw std::invalid_argument(symbol.name() +
                                " is not a location error of a rotary or parallel axis of this machine");
  return found->second;
}

double TruthInDatum::removed_slope(ErrorSymbol symbol) const {
  return symbol.is_straightness() ? slope_[index_of(symbol.axis)][index_of(symbol.component)] : 0.0;
}

}  // namespace volcal::sim
