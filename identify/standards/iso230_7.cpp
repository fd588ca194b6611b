#include "volcal/identify/standards/iso230_7.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/standards/target_positions.h"

namespace volcal {
namespace {

constexpr double kTurnAngle = 2.0 * std::numbers::pi;
constexpr double kSameAngleOfTurn = 1e-5;  // rad

/// 0 ... one turn; what is a rounding below a turn is 0.
double within_turn(double angle) {
  const double part = angle - kTurnAngle * std::floor(angle / kTurnAngle);
  return kTurnAngle - part < kSameAngleOfTurn ? 0.0 : part;
}

/// Mean value at every angle of a turn, and how far apart its readings are.
struct TurnPlot {
  std::vector<double> angle;
  std::vector<double> mean;
  std::optional<double> width;
};

TurnPlot plot_over_a_turn(std::span<const RotationReading> readings) {
  std::vector<double> angles;
  for (const RotationReading& reading : readings) angles.push_back(within_turn(reading.angle));
  const TargetGroups groups = group_targets(angles, kSameAngleOfTurn);
  TurnPlot plot;
  plot.angle = groups.position;
  std::vector<std::vector<double>> values(groups.position.size());
  for (std::size_t k = 0; k < readings.size(); ++k) values[groups.group[k]].push_back(readings[k].value);
  for (const std::vector<double>& at : values) {
    double sum = 0.0;
    for (const double value : at) sum += value;
    plot.mean.push_back(sum / static_cast<double>(at.size()));
    if (at.size() < 2) continue;
    const auto [low, high] = std::ranges::minmax(at);
    plot.width = std::max(plot.width.value_or(0.0), high - low);
  }
  return plot;
}

double widest_gap(const std::vector<double>& angle) {
  double gap = angle.front() + kTurnAngle - angle.back();
  for (std::size_t k = 1; k < angle.size(); ++k) gap = std::max(gap, angle[k] - angle[k - 1]);
  return gap;
}

/// Constant, cosine and sine of one wave a turn.
Eigen::Vector3d first_harmonic(const std::vector<double>& angle, const std::vector<double>& value) {
  const auto rows = static_cast<Eigen::Index>(angle.size());
  Eigen::MatrixXd design(rows, 3);
  Eigen::VectorXd values(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const double at = angle[static_cast<std::size_t>(k)];
    design.row(k) << 1.0, std::cos(at), std::sin(at);
    values[k] = value[static_cast<std::size_t>(k)];
  }
  return least_squares(design, values).solution;
}

/// Range of values about a centre.
double range_about(const Eigen::Vector3d& centre, const std::vector<double>& angle,
                   const std::vector<double>& value) {
  double low = std::nan(""), high = low;
  for (std::size_t k = 0; k < angle.size(); ++k) {
    const double left = value[k] - centre[1] * std::cos(angle[k]) - centre[2] * std::sin(angle[k]);
    low = std::fmin(low, left);
    high = std::fmax(high, left);
  }
  return high - low;
}

}  // namespace

ErrorMotionFigures error_motion_figures(std::span<const RotationReading> readings, MotionCentre centre) {
  ErrorMotionFigures figures;
  if (readings.empty()) return figures;
  const TurnPlot plot = plot_over_a_turn(readings);
  figures.angles = static_cast<int>(plot.angle.size());
  figures.largest_gap = widest_gap(plot.angle);
  if (figures.largest_gap > kLargestAngleGap) return figures;
  const Eigen::Vector3d harmonic = first_harmonic(plot.angle, plot.mean);
  const Eigen::Vector3d about =
      centre == MotionCentre::LeastSquares ? harmonic : Eigen::Vector3d::Zero().eval();
  std::vector<double> angle, value;
  for (const RotationReading& reading : readings) {
    angle.push_back(reading.angle);
    value.push_back(reading.value);
  }
  figures.total = range_about(about, angle, value);
  figures.synchronous = range_about(about, plot.angle, plot.mean);
  figures.asynchronous = plot.width;
  figures.fundamental = 2.0 * harmonic.tail<2>().norm();
  return figures;
}

std::vector<RotationReading> about_centre(std::span<const RotationReading> readings, MotionCentre centre) {
  std::vector<RotationReading> plot(readings.begin(), readings.end());
  if (plot.empty()) return plot;
  const TurnPlot turn = plot_over_a_turn(readings);
  Eigen::Vector3d about = Eigen::Vector3d::Zero();
  if (widest_gap(turn.angle) <= kLargestAngleGap) {
    about = first_harmonic(turn.angle, turn.mean);
    if (centre == MotionCentre::PolarChart) about.tail<2>().setZero();
  } else {
    for (const double mean : turn.mean) about[0] += mean / static_cast<double>(turn.mean.size());
  }
  for (RotationReading& reading : plot)
    reading.value -= about[0] + about[1] * std::cos(reading.angle) + about[2] * std::sin(reading.angle);
  return plot;
}

}  // namespace volcal
