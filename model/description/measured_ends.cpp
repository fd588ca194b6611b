#include "volcal/model/description/measured_ends.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace volcal {
namespace {

constexpr double kTurnOfCircle = 2.0 * std::numbers::pi;
constexpr double kEdge = 1e-6;           // m or rad
constexpr double kSameAngle = 1e-9;      // rad
constexpr double kRepeatedValue = 1e-9;  // m or rad: nine decimals of um or urad stand in tables

/// By whole turns to where it is nearest to the middle of first and last.
double turned(double position, const MeasuredEnds& ends) {
  if (!ends.goes_round) return position;
  return position - kTurnOfCircle * std::round((position - 0.5 * (ends.first + ends.last)) / kTurnOfCircle);
}

bool repeats_after_a_turn(const FunctionSpec& function) {
  if (function.basis == "fourier") return true;
  const bool is_polyline =
      function.basis == "bspline" && function.degree == 1 && function.breakpoints.size() >= 2;
  if (!is_polyline) return false;
  const double length = function.breakpoints.back() - function.breakpoints.front();
  return length > kTurnOfCircle - kSameAngle &&
         std::abs(std::remainder(length, kTurnOfCircle)) < kSameAngle &&
         std::abs(function.coefficients.back() - function.coefficients.front()) < kRepeatedValue;
}

}  // namespace

double MeasuredEnds::nearest(double position) const {
  if (!(position < first) && !(position > last)) return position;
  return std::clamp(turned(position, *this), first, last);
}

bool MeasuredEnds::is_beyond(double position) const {
  if (!(position < first - kEdge) && !(position > last + kEdge)) return false;
  const double at = turned(position, *this);
  return at < first - kEdge || at > last + kEdge;
}

bool MeasuredEnds::cover(const Axis& axis) const {
  if (goes_round && last - first >= kTurnOfCircle - kEdge) return true;
  return first <= axis.travel_min + kEdge && last >= axis.travel_max - kEdge;
}

bool goes_round(const Axis& axis, const ModelSpec& model) {
  if (!axis.travels_a_turn()) return false;
  bool has_functions = false;
  for (const auto& [symbol, function] : model.functions) {
    if (symbol.axis != axis.name || function.coefficients.empty()) continue;
    if (!repeats_after_a_turn(function)) return false;
    has_functions = true;
  }
  return has_functions;
}

bool stood_still(AxisName axis, const ModelSpec& model) {
  const auto found = model.measured.find(axis);
  if (!is_rotary(axis) || found == model.measured.end()) return false;
  const bool has_functions = std::ranges::any_of(model.functions, [axis](const auto& entry) {
    return entry.first.axis == axis && !entry.second.coefficients.empty();
  });
  return found->second.first == found->second.second && !has_functions;
}

MeasuredEnds measured_ends(const Axis& axis, const ModelSpec& model) {
  const auto found = model.measured.find(axis.name);
  if (found == model.measured.end() || stood_still(axis.name, model)) return {};
  return {found->second.first, found->second.second, goes_round(axis, model)};
}

}  // namespace volcal
