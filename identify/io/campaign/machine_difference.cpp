#include "volcal/identify/io/campaign/machine_difference.h"

#include <algorithm>
#include <cmath>

namespace volcal {
namespace {

constexpr double kSamePlace = 1e-9;  // m or rad

std::string axis_difference(const Axis& a, const Axis& b) {
  const auto differs = [](double x, double y) { return std::abs(x - y) > kSamePlace; };
  const std::string name(1, letter_of(a.name));
  if (differs(a.travel_min, b.travel_min) || differs(a.travel_max, b.travel_max)) return "travel of " + name;
  if (differs(a.home, b.home)) return "home of " + name;
  if ((a.reference_point - b.reference_point).norm() > kSamePlace) return "reference point of " + name;
  if ((a.centre - b.centre).norm() > kSamePlace) return "centre of " + name;
  return "";
}

}  // namespace

std::string machine_difference(const Machine& a, const Machine& b) {
  const auto same_joint = [](const Joint& x, const Joint& y) {
    return x.axis == y.axis && x.workpiece_side == y.workpiece_side;
  };
  if (!std::ranges::equal(a.structure.joints, b.structure.joints, same_joint)) {
    return "structure \"" + a.structure.code + "\" and \"" + b.structure.code + "\"";
  }
  if (a.datum.primary != b.datum.primary || a.datum.secondary != b.datum.secondary) return "datum";
  for (std::size_t i = 0; i < a.axes.size(); ++i) {
    if (std::string difference = axis_difference(a.axes[i], b.axes[i]); !difference.empty())
      return difference;
  }
  return "";
}

void require_machine_of_model(const Machine& own, const Machine& machine, const SourcePlace& place) {
  const std::string difference = machine_difference(own, machine);
  if (difference.empty()) return;
  throw InputError(place,
                   "the model is for another machine than " +
                       (machine.file.empty() ? "this one" : machine.file) + ": " + difference,
                   "use a model of the same machine");
}

}  // namespace volcal
