#include "volcal/sim/machine/datum.h"

#include <Eigen/Geometry>
#include <array>
#include <stdexcept>

#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

void require_linear(ErrorSymbol symbol) {
  if (is_rotary(symbol.axis)) {
    throw std::invalid_argument(symbol.name() + ": the datum of rotary axes is not that of tables");
  }
}

/// 5-point Gauss-Legendre rule on [-1, 1] (Abramowitz and Stegun 25.4.30), exact to degree 9.
constexpr std::array<double, 5> kNode = {-0.90617984593866399280, -0.53846931010568309104, 0.0,
                                         0.53846931010568309104, 0.90617984593866399280};
constexpr std::array<double, 5> kWeight = {0.23692688505618908751, 0.47862867049936646804,
                                           0.56888888888888888889, 0.47862867049936646804,
                                           0.23692688505618908751};
constexpr int kPanels = 400;

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

TruthInDatum::TruthInDatum(const TruthMachine& truth) : TruthInDatum(truth, truth.machine().datum) {}

TruthInDatum::TruthInDatum(const TruthMachine& truth, Datum datum) : truth_(truth), datum_(datum) {
  for (const AxisName name : kLinearAxes) {
    const Axis& axis = truth.machine().axis(name);
    for (const Component component : {Component::X, Component::Y, Component::Z}) {
      const ErrorSymbol symbol{component, name};
      if (!symbol.is_straightness()) continue;
      slope_[index_of(name)][index_of(component)] = least_squares_slope(
          [&](double q) { return truth.function_value(symbol, q); }, axis.travel_min, axis.travel_max);
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
}

/// Mean direction of an axis minus its nominal direction: squareness, straightness slopes, and the angles
/// that the axes which carry it have at home.
Eigen::Vector3d TruthInDatum::direction_error(AxisName axis) const {
  const Machine& machine = truth_.machine();
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  for (const LocationSymbol& symbol : machine.datum.squareness()) {
    if (symbol.axis != axis) continue;
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

double TruthInDatum::value(ErrorSymbol symbol, double position) const {
  require_linear(symbol);
  const double home = truth_.machine().axis(symbol.axis).home;
  return truth_.function_value(symbol, position) - truth_.function_value(symbol, home) -
         removed_slope(symbol) * (position - home);
}

double TruthInDatum::removed_slope(ErrorSymbol symbol) const {
  require_linear(symbol);
  return symbol.is_straightness() ? slope_[index_of(symbol.axis)][index_of(symbol.component)] : 0.0;
}

}  // namespace volcal::sim
