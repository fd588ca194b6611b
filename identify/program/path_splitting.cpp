#include "volcal/identify/program/path_splitting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "volcal/identify/program/quartic.h"
#include "volcal/identify/program/sample_shares.h"

namespace volcal {
namespace {

constexpr double kShareOfNodes = 0.25;  ///< of the tolerance
constexpr double kShareOfChoice = 0.5;
constexpr double kLebesgue = 1.25;
constexpr double kShareOfQuartic = 0.1;
constexpr std::size_t kQuarticChecks = 4;
constexpr double kShortestQuartic = 1e-5;  ///< m: what bends within it is a step
constexpr std::size_t kMostCloseNodes = 1000000;
constexpr std::size_t kMostPassed = 512;  ///< close nodes by one segment
/// Shares of the travel of the other axes, between which no wave has one phase.
constexpr std::array<double, 3> kPlacesAcross = {0.0131556174964, 0.4721359549996, 0.9787137637479};

/// Bound of the norm of the second derivative by t, on [0, 1], of the quartic through five equidistant
/// values.
double second_derivative_bound(const std::array<Eigen::Vector3d, 5>& f) {
  constexpr double kPerStepSquared = 16.0 / 12.0;
  const Eigen::Vector3d begin = 35.0 * f[0] - 104.0 * f[1] + 114.0 * f[2] - 56.0 * f[3] + 11.0 * f[4];
  const Eigen::Vector3d middle = -f[0] + 16.0 * f[1] - 30.0 * f[2] + 16.0 * f[3] - f[4];
  const Eigen::Vector3d end = 11.0 * f[0] - 56.0 * f[1] + 114.0 * f[2] - 104.0 * f[3] + 35.0 * f[4];
  return kLebesgue * kPerStepSquared * std::max({begin.norm(), middle.norm(), end.norm()});
}

Eigen::Vector3d quartic_at(const std::array<Eigen::Vector3d, 5>& f, double share) {
  const std::array<double, 5> weights = quartic_weights(share);
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < f.size(); ++i) value += weights[i] * f[i];
  return value;
}

}  // namespace

PathTooLong::PathTooLong()
    : std::runtime_error(
          "the identified errors change in waves so short that the line would become more than " +
          std::to_string(kMostSegments) + " lines within the tolerance") {}

const char* PathTooLong::remedy() {
  return "allow more by --tolerance-um, write the line as several, or leave the effect with these waves out "
         "of the model";
}

PathSplitter::PathSplitter(const ProgramErrors& errors, const Eigen::Vector3d& tool_offset, double tolerance)
    : solver_(errors.machine, errors.field(tool_offset)), pieces_(errors.pieces), tolerance_(tolerance) {
  set_steepness(errors.machine);
  solver_.set_steepness(steepness_);
}

/// Largest slope along an axis near both ends, in the middle and at another place of every piece, from a
/// point of the other axes.
double PathSplitter::steepness_along(int axis, Eigen::Vector3d point, const std::vector<double>& ends) const {
  constexpr double kStep = 1e-6;  // m
  double largest = 0.0;
  double last_place = ends.front();
  point[axis] = last_place;
  Eigen::Vector3d last = solver_.error(point, {});
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    for (const double share : {0.02, 0.5, 0.98, sample_share(i)}) {
      const double place = ends[i] + share * (ends[i + 1] - ends[i]);
      point[axis] = place;
      const Eigen::Vector3d here = solver_.error(point, {});
      const double apart = std::max(std::abs(place - last_place), kStep);
      largest = std::max(largest, (here - last).norm() / apart);  // a step shows between places alone
      point[axis] += kStep;
      largest = std::max(largest, (solver_.error(point, {}) - here).norm() / kStep);
      last = here;
      last_place = place;
    }
  }
  return largest;
}

/// Along every axis, near the corners and in the middle of the others.
void PathSplitter::set_steepness(const Machine& machine) {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), range = Eigen::Vector3d::Zero();
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) continue;
    low[direction_of(axis.name)] = axis.travel_min;
    range[direction_of(axis.name)] = axis.travel();
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int second = (axis + 1) % 3, third = (axis + 2) % 3;
    std::vector<double> ends = pieces_[static_cast<std::size_t>(axis)];
    if (ends.size() < 2) ends = {low[axis], low[axis] + range[axis]};
    for (const double u : kPlacesAcross) {
      for (const double v : kPlacesAcross) {
        Eigen::Vector3d point = low;
        point[second] += u * range[second];
        point[third] += v * range[third];
        steepness_ = std::max(steepness_, 2.0 * steepness_along(axis, point, ends));
      }
    }
  }
}

/// Where the line crosses an end of a piece.
void PathSplitter::cut_at_pieces(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  cuts_.assign({0.0, 1.0});
  for (int axis = 0; axis < 3; ++axis) {
    const double begin = from[axis], length = to[axis] - from[axis];
    if (length == 0.0) continue;
    const auto& ends = pieces_[static_cast<std::size_t>(axis)];
    const auto first = std::upper_bound(ends.begin(), ends.end(), std::min(begin, to[axis]));
    const auto last = std::lower_bound(first, ends.end(), std::max(begin, to[axis]));
    for (auto end = first; end != last; ++end) cuts_.push_back((*end - begin) / length);
  }
  std::ranges::sort(cuts_);
}

/// Compared at shares of an interval at which no wave has one phase.
PathSplitter::Shape PathSplitter::shape_of(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                           const ApproachDirection& directions, double t_begin, double t_end,
                                           const std::array<Eigen::Vector3d, 5>& values) {
  const auto off_chord = [&](double share, const Eigen::Vector3d& command) {
    return (command - values[0] - share * (values[4] - values[0])).norm();
  };
  double off = 0.0, off_quartic = 0.0;
  for (std::size_t i = 1; i < 4; ++i)
    off = std::max(off, off_chord(0.25 * static_cast<double>(i), values[i]));
  for (std::size_t i = 0; i < kQuarticChecks; ++i) {
    const double share = sample_share(i);
    const double t = t_begin + share * (t_end - t_begin);
    const Eigen::Vector3d command = solver_.command(from + t * (to - from), directions);
    off = std::max(off, off_chord(share, command));
    off_quartic = std::max(off_quartic, (command - quartic_at(values, share)).norm());
  }
  if (off_quartic <= kShareOfQuartic * tolerance_) return Shape::Quartic;
  return off <= kShareOfNodes * tolerance_ ? Shape::Straight : Shape::Other;
}

/// Nodes behind t_begin up to t_end, close enough for the bound.
void PathSplitter::add_interval(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                const ApproachDirection& directions, double t_begin, double t_end) {
  const auto at = [&](double t) -> PathNode {
    return {t, solver_.command(t >= 1.0 ? to : Eigen::Vector3d(from + t * (to - from)), directions)};
  };
  std::array<Eigen::Vector3d, 5> values;
  values[0] = close_.back().command;
  for (std::size_t i = 1; i < 5; ++i)
    values[i] = at(t_begin + 0.25 * static_cast<double>(i) * (t_end - t_begin)).command;
  const bool can_be_halved = (t_end - t_begin) * (to - from).norm() > kShortestQuartic;
  const Shape shape = can_be_halved ? shape_of(from, to, directions, t_begin, t_end, values) : Shape::Quartic;
  if (shape == Shape::Other) {
    const double middle = 0.5 * (t_begin + t_end);
    add_interval(from, to, directions, t_begin, middle);
    add_interval(from, to, directions, middle, t_end);
    return;
  }
  if (shape == Shape::Straight) {
    close_.push_back({t_end, values[4]});
    return;
  }
  const double bound = second_derivative_bound(values);
  const double parts = std::ceil(std::sqrt(bound / (8.0 * kShareOfNodes * tolerance_)));
  if (!(parts + static_cast<double>(close_.size()) < kMostCloseNodes)) throw PathTooLong();
  const int count = static_cast<int>(std::max(parts, 1.0));
  for (int i = 1; i < count; ++i) close_.push_back(at(t_begin + (t_end - t_begin) * i / count));
  close_.push_back({t_end, values[4]});
}

/// The last node to which a straight segment from the anchor passes all between them.
std::size_t PathSplitter::furthest(std::size_t anchor) const {
  const PathNode& begin = close_[anchor];
  std::size_t good = anchor + 1;
  for (std::size_t end = anchor + 2; end < std::min(close_.size(), anchor + kMostPassed); ++end) {
    for (std::size_t k = anchor + 1; k < end; ++k) {
      const double share = (close_[k].t - begin.t) / (close_[end].t - begin.t);
      const Eigen::Vector3d on_line = begin.command + share * (close_[end].command - begin.command);
      if ((close_[k].command - on_line).norm() > kShareOfChoice * tolerance_) return good;
    }
    good = end;
  }
  return good;
}

void PathSplitter::keep_needed(double t_from, double t_to, std::vector<PathNode>& nodes) const {
  const std::size_t most = nodes.size() + kMostSegments;
  for (std::size_t at = 0; at + 1 < close_.size();) {
    at = furthest(at);
    if (nodes.size() == most) throw PathTooLong();
    const bool last = at + 1 == close_.size();
    nodes.push_back({last ? t_to : t_from + close_[at].t * (t_to - t_from), close_[at].command});
  }
}

void PathSplitter::split(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                         const ApproachDirection& directions, double t_from, double t_to,
                         std::vector<PathNode>& nodes) {
  // What changes by at most L per m is at most 2 L t (1 - t) h <= L h / 2 off its chord of length h.
  if (0.5 * steepness_ * (to - from).norm() < kShareOfNodes * tolerance_) {
    nodes.push_back({t_to, solver_.command(to, directions)});
    return;
  }
  cut_at_pieces(from, to);
  close_.assign({{0.0, solver_.command(from, directions)}});
  for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
    constexpr double kSamePlace = 1e-12;
    if (cuts_[i + 1] - cuts_[i] > kSamePlace) add_interval(from, to, directions, cuts_[i], cuts_[i + 1]);
  }
  close_.back().t = 1.0;
  keep_needed(t_from, t_to, nodes);
}

std::vector<double> chord_ends(const NcArc& arc, double tolerance) {
  const double radius = std::max(arc.start_radius, arc.end_radius);
  const double turn = std::abs(arc.sweep);
  // A chord of angle a is radius (1 - cos(a / 2)) off.
  constexpr double kNarrowest = 1e-4;  // rad; 1.25 nm off at a radius of 1 m
  const double widest = std::max(2.0 * std::acos(std::max(1.0 - tolerance / radius, 0.0)), kNarrowest);
  const double quarter = 0.5 * std::numbers::pi;
  std::vector<double> ends = {0.0, 1.0};
  const double low = std::min(arc.start_angle, arc.start_angle + arc.sweep);
  const auto first = static_cast<int>(std::floor(low / quarter)) + 1;
  for (int k = first; k * quarter < low + turn; ++k)
    ends.push_back((k * quarter - arc.start_angle) / arc.sweep);
  std::ranges::sort(ends);
  std::vector<double> all = {0.0};
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double part = ends[i + 1] - ends[i];
    constexpr double kSameAngle = 1e-12;
    if (part < kSameAngle) continue;
    const int count = std::max(1, static_cast<int>(std::ceil(part * turn / widest)));
    for (int k = 1; k < count; ++k) all.push_back(ends[i] + part * k / count);
    all.push_back(ends[i + 1]);
  }
  all.back() = 1.0;
  return all;
}

}  // namespace volcal
