#include "volcal/identify/planning/rotary_positions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "volcal/identify/planning/uniform_random.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kFewestNodes = 3;
constexpr double kTableShare =
    0.25;  // of the smallest side of the swept box, to either side of a table's axis
constexpr double kCircleShare = 0.7;  // of the region's half width: a textbook's circle of places

double in_tenths_of_degrees(double angle) {
  constexpr double kTenth = std::numbers::pi / 1800.0;
  return std::round(angle / kTenth) * kTenth;
}

std::vector<int> node_counts(const std::vector<RotaryStretch>& stretches, std::size_t positions) {
  double product = 1.0;
  for (const RotaryStretch& each : stretches) product *= each.length();
  const double density =
      std::pow(static_cast<double>(positions) / product, 1.0 / static_cast<double>(stretches.size()));
  std::vector<int> counts;
  for (const RotaryStretch& each : stretches)
    counts.push_back(std::max(kFewestNodes, static_cast<int>(std::lround(density * each.length()))));
  return counts;
}

/// Calls use(cell) for every node of a grid, the first axis fastest.
template <class Use>
void for_each_cell(const std::vector<int>& counts, const Use& use) {
  std::array<int, 3> all = {1, 1, 1};
  for (std::size_t i = 0; i < std::min(counts.size(), all.size()); ++i) all[i] = counts[i];
  for (int k = 0; k < all[2]; ++k) {
    for (int j = 0; j < all[1]; ++j) {
      for (int i = 0; i < all[0]; ++i) use(std::array<int, 3>{i, j, k});
    }
  }
}

std::vector<Eigen::Vector3d> corners_and_middle(const Eigen::AlignedBox3d& box) {
  std::vector<Eigen::Vector3d> points = {box.center()};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d share(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    points.emplace_back(box.min() + share.cwiseProduct(box.sizes()));
  }
  return points;
}

}  // namespace

double RotaryStretch::node(double i, int count) const {
  const double step = length() / std::max(1, whole_turn ? count : count - 1);
  return min + step * i;
}

std::vector<RotaryStretch> rotary_stretches(const Machine& machine) {
  std::vector<RotaryStretch> stretches;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    RotaryStretch stretch{axis.name, axis.travel_min, axis.travel_max, turns_fully(axis)};
    if (axis.travel() > kTurn) {
      stretch.min = std::clamp(axis.home - 0.5 * kTurn, axis.travel_min, axis.travel_max - kTurn);
      stretch.max = stretch.min + kTurn;
    }
    stretches.push_back(stretch);
  }
  std::ranges::stable_sort(stretches, std::ranges::greater{}, &RotaryStretch::length);
  return stretches;
}

void require_rotary_axes(const Machine& machine, const std::string& instrument) {
  const std::size_t rotary = rotary_stretches(machine).size();
  if (rotary > 0 && rotary <= 3) return;
  throw InputError({machine.file, 0},
                   rotary == 0 ? "the machine has no rotary axis"
                               : "the machine has more rotary axes than a grid can have",
                   "plan a " + instrument + " for machines with one to three of A, B and C");
}

const Axis* innermost_table(const Machine& machine) {
  for (const Joint& joint : machine.structure.joints) {
    if (!joint.workpiece_side) return nullptr;
    if (is_rotary(joint.axis)) return &machine.axis(joint.axis);
  }
  return nullptr;
}

Eigen::AlignedBox3d rotary_region_w(const Machine& machine, const SweptVolume& swept) {
  const int along = swept.along_spindle();
  const bool up = swept.spindle_w()[along] > 0.0;
  Eigen::AlignedBox3d region = swept.box_w();
  (up ? region.max() : region.min())[along] = region.center()[along];
  const Axis* table = innermost_table(machine);
  if (table == nullptr) return region;
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(kTableShare * swept.box_w().sizes().minCoeff());
  const Eigen::Vector3d& centre_w = table->centre;
  region = Eigen::AlignedBox3d(centre_w - half, centre_w + half);
  (up ? region.min() : region.max())[along] = centre_w[along];
  return region;
}

std::vector<Eigen::Vector3d> places_on_circle_w(const Eigen::AlignedBox3d& region_w, int along_spindle,
                                                int count) {
  const int first = (along_spindle + 1) % 3, second = (along_spindle + 2) % 3;
  const double radius = 0.5 * kCircleShare * std::min(region_w.sizes()[first], region_w.sizes()[second]);
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < count; ++i) {
    const double angle = kTurn * i / count;
    Eigen::Vector3d place = region_w.center();
    place[first] += radius * std::cos(angle);
    place[second] += radius * std::sin(angle);
    places.emplace_back((place * 1e3).array().round() * 1e-3);
  }
  return places;
}

std::vector<PlanPosition> rotary_sweep(const Machine& machine, const RotaryStretch& stretch, int count) {
  std::vector<PlanPosition> sweep;
  for (int i = 0; i < count; ++i) {
    PlanPosition each{home_position(machine), {i, 0, 0}};
    each.position[index_of(stretch.axis)] =
        std::clamp(in_tenths_of_degrees(stretch.node(i, count)), stretch.min, stretch.max);
    sweep.push_back(each);
  }
  return sweep;
}

std::vector<PlanPosition> rotary_grid(const Machine& machine, std::size_t positions, double jitter,
                                      std::uint64_t seed, std::uint64_t stream) {
  const std::vector<RotaryStretch> stretches = rotary_stretches(machine);
  if (stretches.empty()) return {};
  const std::vector<int> counts = node_counts(stretches, positions);
  std::seed_seq mixed{seed, stream};
  std::mt19937_64 random(mixed);
  std::vector<PlanPosition> grid;
  for_each_cell(counts, [&](const std::array<int, 3>& cell) {
    PlanPosition each{home_position(machine), cell};
    for (std::size_t a = 0; a < stretches.size(); ++a) {
      const double moved = cell[a] + jitter * symmetric_uniform(random);
      const double q = in_tenths_of_degrees(stretches[a].node(moved, counts[a]));
      each.position[index_of(stretches[a].axis)] = std::clamp(q, stretches[a].min, stretches[a].max);
    }
    grid.push_back(each);
  });
  return grid;
}

std::vector<AxisPosition> poses_in_box(const Machine& machine, const SweptVolume& swept,
                                       const Eigen::AlignedBox3d& box_w, std::size_t tool, int per_axis) {
  const std::vector<RotaryStretch> stretches = rotary_stretches(machine);
  const std::vector<Eigen::Vector3d> points_w = corners_and_middle(box_w);
  std::vector<AxisPosition> poses;
  for_each_cell(std::vector<int>(stretches.size(), per_axis), [&](const std::array<int, 3>& cell) {
    AxisPosition rotary = home_position(machine);
    for (std::size_t a = 0; a < stretches.size(); ++a)
      rotary[index_of(stretches[a].axis)] = stretches[a].node(cell[a], per_axis);
    for (const Eigen::Vector3d& point_w : points_w) {
      if (const auto pose = swept.position_at(point_w, tool, rotary)) poses.push_back(*pose);
    }
  });
  return poses;
}

}  // namespace volcal
