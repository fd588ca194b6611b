#include "volcal/identify/standards/standard_figures.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "volcal/identify/standards/approach.h"
#include "volcal/identify/standards/drift_tests.h"
#include "volcal/identify/standards/positioning_notes.h"
#include "volcal/identify/standards/rotary_tests.h"
#include "volcal/identify/standards/setup_values.h"
#include "volcal/identify/standards/target_positions.h"
#include "volcal/identify/standards/test_paths.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/nuisance.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr double kBeamAlignment = 0.01;  // rad between beam and motion

std::string place_of(const Campaign& campaign, const Setup& setup, const StraightPath& path) {
  std::string place;
  for (const Axis& axis : campaign.machine.axes) {
    if (is_rotary(axis.name) || axis.name == path.moving.front()) continue;
    const double position = setup.readings.position[index_of(axis.name)][path.rows.front()];
    place += fmt::format("{}{} {:g}", place.empty() ? "" : ", ", letter_of(axis.name),
                         std::round(position * kPerMicro) / kPerMilli);
  }
  return place.empty() ? place : place + " mm";
}

/// Deviations along a line of a displacement setup.
class LineEvaluation {
 public:
  LineEvaluation(const Campaign& campaign, const Setup& setup, const StraightPath& path)
      : setup_(setup), path_(path), point_w_(nominal_points_w(campaign, setup)) {
    const Vector3d first_to_last_w = line_direction(point_w_).value_or(path.direction_w);
    beam_w_ = setup.options.vector("direction").value_or(first_to_last_w).normalized();
    is_deviation_ = channel_column(setup, 0).starts_with("deviation");
    own_zero_ = setup.options.text("offset_per").value_or("setup") == "line" && !setup.readings.line.empty();
  }

  bool beam_along_motion() const { return beam_w_.cross(path_.direction_w).norm() < kBeamAlignment; }
  bool every_line_has_its_own_zero() const { return own_zero_; }

  PositioningFigures figures(const SetupValues& values, const std::vector<double>& value) const {
    std::vector<PositioningReading> readings;
    std::vector<std::int32_t> line;
    for (std::size_t k = 0; k < path_.rows.size(); ++k) {
      const std::size_t row = path_.rows[k];
      if (!values.has(row)) continue;
      readings.push_back({path_.along[k], deviation(row, value[row]), path_.approach[k]});
      line.push_back(setup_.readings.line.empty() ? 0 : setup_.readings.line[row]);
    }
    if (own_zero_) zero_each_line(line, readings);
    PositioningFigures figures = positioning_figures(readings);
    if (own_zero_) drop_what_compares_lines(line, readings, figures);
    return figures;
  }

 private:
  double deviation(std::size_t row, double value) const {
    const double commanded = beam_w_.dot(point_w_[row] - point_w_[path_.rows.front()]);
    const double sense = beam_w_.dot(path_.direction_w) > 0.0 ? 1.0 : -1.0;
    return sense * (is_deviation_ ? value : value - commanded);
  }

  static void zero_each_line(const std::vector<std::int32_t>& line,
                             std::vector<PositioningReading>& readings) {
    std::map<std::int32_t, std::pair<double, int>> sums;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      sums[line[k]].first += readings[k].deviation;
      ++sums[line[k]].second;
    }
    for (std::size_t k = 0; k < readings.size(); ++k) {
      readings[k].deviation -= sums[line[k]].first / sums[line[k]].second;
    }
  }

  /// A line's own zero says nothing between lines: figures of both directions, and those of one direction
  /// where its lines did not meet the same targets.
  static void drop_what_compares_lines(const std::vector<std::int32_t>& line,
                                       const std::vector<PositioningReading>& readings,
                                       PositioningFigures& figures) {
    figures.reversal.reset();
    figures.mean_reversal.reset();
    figures.systematic.reset();
    figures.repeatability.reset();
    figures.accuracy.reset();
    const bool positive = lines_share_targets(line, readings, +1);
    const bool negative = lines_share_targets(line, readings, -1);
    if (!positive) figures.positive = {};
    if (!negative) figures.negative = {};
    if (!positive || !negative) figures.mean_bidirectional.reset();
  }

  static bool lines_share_targets(const std::vector<std::int32_t>& line,
                                  const std::vector<PositioningReading>& readings, int direction) {
    std::vector<double> position;
    for (const PositioningReading& reading : readings) position.push_back(reading.target);
    const TargetGroups targets = group_targets(position, kSamePosition);
    std::map<std::int32_t, std::set<std::size_t>> met;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      if (readings[k].direction == direction) met[line[k]].insert(targets.group[k]);
    }
    return std::all_of(met.begin(), met.end(),
                       [&](const auto& one) { return one.second == met.begin()->second; });
  }

  const Setup& setup_;
  const StraightPath& path_;
  std::vector<Vector3d> point_w_;
  Vector3d beam_w_;
  bool is_deviation_ = false;
  bool own_zero_ = false;
};

/// Whether lines met a direction's targets and none of its figures compares them.
bool has_targets_of_own(const PositioningFigures& figures, ApproachStatistics PositioningTarget::*approach,
                        const UnidirectionalFigures& of_direction) {
  return !of_direction.systematic && std::ranges::any_of(figures.targets, [&](const auto& target) {
    return (target.*approach).count > 0;
  });
}

Finding lines_own_zero(const PositioningFigures& figures) {
  std::vector<std::string> directions;
  if (has_targets_of_own(figures, &PositioningTarget::positive, figures.positive))
    directions.emplace_back("+");
  if (has_targets_of_own(figures, &PositioningTarget::negative, figures.negative))
    directions.emplace_back("-");
  const bool shared = figures.positive.systematic || figures.negative.systematic;
  Finding note{FindingCode::StandardsLinesOwnZero, {{"targets_of_own", !shared}}};
  if (shared && !directions.empty()) note.data["direction"] = directions.front();
  return note;
}

std::vector<Finding> line_notes(const LineEvaluation& evaluation, const PositioningFigures& figures,
                                const SetupValues& values) {
  std::vector<Finding> notes = notes_on_positioning(figures, values, "um");
  if (evaluation.every_line_has_its_own_zero()) notes.insert(notes.begin(), lines_own_zero(figures));
  return notes;
}

void evaluate_displacement(const Campaign& campaign, const Setup& setup, const SetupValues& values,
                           StandardFigures& result) {
  const FoundPaths<StraightPath> found = straight_paths(campaign, setup);
  result.not_recognised.insert(result.not_recognised.end(), found.not_recognised.begin(),
                               found.not_recognised.end());
  for (const StraightPath& path : found.paths) {
    const LineEvaluation evaluation(campaign, setup, path);
    if (!evaluation.beam_along_motion()) {
      result.not_recognised.push_back(
          {FindingCode::NoTestBeamAcross, {{"setup", setup.name}, {"path", path.name}}});
      continue;
    }
    PositioningFigures readings = evaluation.figures(values, values.reading[0]);
    PositioningFigures model = evaluation.figures(values, values.predicted[0]);
    std::vector<Finding> notes = line_notes(evaluation, readings, values);
    if (path.moving.size() == 1) {
      result.lines.push_back({setup.name,
                              path.moving.front(),
                              place_of(campaign, setup, path),
                              {std::move(readings), std::move(model)},
                              std::move(notes)});
    } else {
      result.diagonals.push_back({setup.name,
                                  path.moving,
                                  {{path.name, std::move(readings)}, {path.name, std::move(model)}},
                                  std::move(notes)});
    }
  }
}

void summarise_diagonals(StandardFigures& result) {
  std::map<std::vector<AxisName>, SideBySide<std::vector<DiagonalFigures>>> groups;
  for (const DiagonalTest& test : result.diagonals) {
    groups[test.axes].readings.push_back(test.figures.readings);
    groups[test.axes].model.push_back(test.figures.model);
  }
  for (const auto& [axes, figures] : groups) {
    result.diagonal_groups.push_back(
        {axes, {diagonal_summary(figures.readings), diagonal_summary(figures.model)}});
  }
}

/// A bar's distances to its centre, as radii in the plane of the circle.
class CircleEvaluation {
 public:
  CircleEvaluation(const CirclePath& path, const Vector3d& instrument_w) : path_(path) {
    const Vector3d offset_w = instrument_w - path.centre_w;
    centre_ = {offset_w.dot(path.first_w), offset_w.dot(path.second_w)};
    height_ = offset_w.dot(path.first_w.cross(path.second_w));
  }

  const Eigen::Vector2d& instrument_centre() const { return centre_; }

  /// Places of the path that readings and predictions have.
  std::vector<std::size_t> places(const SetupValues& values) const {
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < path_.rows.size(); ++k) {
      const std::size_t row = path_.rows[k];
      if (values.has(row) && values.reading[0][row] > std::abs(height_) &&
          values.predicted[0][row] > std::abs(height_))
        places.push_back(k);
    }
    return places;
  }

  std::vector<CircleReading> readings(const std::vector<std::size_t>& places,
                                      const std::vector<double>& length) const {
    std::vector<CircleReading> readings;
    for (const std::size_t k : places) {
      const double bar = length[path_.rows[k]];
      const double radius = std::sqrt(bar * bar - height_ * height_);
      readings.push_back({path_.angle[k], radius - path_.commanded_radius[k], path_.sense[k]});
    }
    return readings;
  }

 private:
  const CirclePath& path_;
  Eigen::Vector2d centre_;
  double height_ = 0.0;
};

CircleTest circle_test(const CirclePath& path, const Setup& setup, std::size_t setup_index,
                       const SetupValues& values) {
  CircleTest test{
      setup.name, path.first, path.second, path.radius, path.centre_w, {}, notes_on_removed(values),
      setup_index};
  const CircleEvaluation evaluation(path, setup.options.vector("centre").value_or(path.centre_w));
  const std::vector<std::size_t> places = evaluation.places(values);
  for (const std::size_t place : places) test.rows.push_back(path.rows[place]);
  const auto readings = evaluation.readings(places, values.reading[0]);
  const auto model = evaluation.readings(places, values.predicted[0]);
  test.figures.readings = circular_figures(readings, path.radius, evaluation.instrument_centre());
  test.figures.model = circular_figures(model, path.radius, evaluation.instrument_centre());
  const Eigen::Vector2d& centre = test.figures.readings.centre;
  test.radial = {radial_deviations(readings, path.radius, centre),
                 radial_deviations(model, path.radius, centre)};
  return test;
}

void evaluate_ball_bar(const Campaign& campaign, std::size_t setup_index, const SetupValues& values,
                       StandardFigures& result) {
  const Setup& setup = campaign.setups[setup_index];
  const FoundPaths<CirclePath> found = circle_paths(campaign, setup);
  result.not_recognised.insert(result.not_recognised.end(), found.not_recognised.begin(),
                               found.not_recognised.end());
  for (const CirclePath& path : found.paths) {
    CircleTest test = circle_test(path, setup, setup_index, values);
    if (setup.options.number("length_sigma").value_or(1.0) != 0.0) {
      test.notes.push_back({FindingCode::StandardsBarUncalibrated});
    }
    result.circles.push_back(std::move(test));
  }
}

void evaluate_points(const Campaign& campaign, const Setup& setup, const SetupValues& values,
                     StandardFigures& result) {
  if (setup.readings.channels() < 3) {
    result.not_recognised.push_back(
        {FindingCode::NoTestComponentsMissing,
         {{"setup", setup.name}, {"components", static_cast<std::int64_t>(setup.readings.channels())}}});
    return;
  }
  const std::vector<Vector3d> point_w = nominal_points_w(campaign, setup);
  std::vector<Vector3d> points, readings, model;
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (!values.has(row)) continue;
    points.push_back(point_w[row]);
    readings.emplace_back(values.reading[0][row], values.reading[1][row], values.reading[2][row]);
    model.emplace_back(values.predicted[0][row], values.predicted[1][row], values.predicted[2][row]);
  }
  if (points.empty()) return;
  std::vector<Vector3d> difference;
  difference.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) difference.emplace_back(readings[i] - model[i]);
  PointsTest test{setup.name, {}, volumetric_figures(difference), notes_on_removed(values)};
  if (setup.options.text("alignment").value_or("rigid") == "rigid") {
    readings = without_rigid_motion(points, readings);
    model = without_rigid_motion(points, model);
    test.notes.push_back({FindingCode::StandardsRigidMotionRemoved});
  }
  test.figures = {volumetric_figures(readings), volumetric_figures(model)};
  result.points.push_back(std::move(test));
}

}  // namespace

StandardFigures standard_figures(const Campaign& campaign, std::span<const ResidualRecord> records) {
  const std::vector<SetupValues> values = values_by_setup(campaign, records);
  StandardFigures result;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    const InstrumentTraits& traits = traits_of(setup);
    if (traits.laser_length == LaserLength::Displacement)
      evaluate_displacement(campaign, setup, values[i], result);
    if (traits.has_bar) evaluate_ball_bar(campaign, i, values[i], result);
    if (traits.reads_error_vectors) evaluate_points(campaign, setup, values[i], result);
  }
  result.rotary_lines = rotary_positioning_tests(campaign, values, result.not_recognised);
  result.error_motions = error_motion_tests(campaign, values);
  result.drifts = drift_tests(campaign, values);
  summarise_diagonals(result);
  return result;
}

}  // namespace volcal
