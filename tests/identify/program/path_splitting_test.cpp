// The tolerance of split lines holds everywhere along them, also where errors have corners.

#include "volcal/identify/program/path_splitting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/identified_machines.h"
#include "tests/support/nc_programs.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

constexpr double kSplitTolerance = 0.5e-6;

struct SplitLine {
  Eigen::Vector3d from, to;
  std::vector<PathNode> nodes;
};

SplitLine split(PathSplitter& splitter, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  SplitLine line{from, to, {}};
  ApproachDirection directions{};
  turn_directions(to - from, directions);
  line.nodes.push_back({0.0, splitter.solver().command(from, directions)});
  splitter.split(from, to, directions, 0.0, 1.0, line.nodes);
  return line;
}

/// Largest distance of the straight segments from the corrected path, at many places between the nodes.
double deviation(PathSplitter& splitter, const SplitLine& line, int places) {
  ApproachDirection directions{};
  turn_directions(line.to - line.from, directions);
  double largest = 0.0;
  for (std::size_t i = 0; i + 1 < line.nodes.size(); ++i) {
    const PathNode &a = line.nodes[i], &b = line.nodes[i + 1];
    for (int k = 1; k < places; ++k) {
      const double share = static_cast<double>(k) / places;
      const double t = a.t + share * (b.t - a.t);
      const Eigen::Vector3d wanted =
          splitter.solver().command(line.from + t * (line.to - line.from), directions);
      largest = std::max(largest, (a.command + share * (b.command - a.command) - wanted).norm());
    }
  }
  return largest;
}

/// 10 um sine of 200 mm: e'' = 10 um (2 pi / 0.2 m)^2 = 9.87e-3 /m, h = sqrt(8 * 0.5 um / e'') = 20 mm, so
/// that 1 m takes at least 50 and, with three quarters of the tolerance at work, not twice as many segments.
TEST(PathSplitting, TakesAboutAsManySegmentsAsTheCurvatureAsksFor) {
  const double k = 2.0 * M_PI / 0.2;
  std::vector<double> ends;
  for (int i = -100; i <= 100; ++i) ends.push_back(i * 0.01);
  const auto field = [k](const AxisPosition& q, const ApproachDirection&) {
    return Eigen::Vector3d(0, 10e-6 * std::sin(k * q[0]), 0);
  };
  PathSplitter splitter(testing::errors_with(field, {ends, {}, {}}), Eigen::Vector3d::Zero(),
                        kSplitTolerance);
  const SplitLine line = split(splitter, {-0.5, 0, 0}, {0.5, 0, 0});
  EXPECT_GE(line.nodes.size() - 1, 40U);
  EXPECT_LE(line.nodes.size() - 1, 100U);
  EXPECT_LE(deviation(splitter, line, 50), kSplitTolerance);
}

/// p' + e(p') = p to 1 nm, from wherever the last solution was, with errors of 0.3 mm that change by 1e-3.
TEST(PathSplitting, SolvesForTheCommandToANanometre) {
  const auto field = [](const AxisPosition& q, const ApproachDirection&) {
    return Eigen::Vector3d(3e-4 + 1e-3 * q[1], 5e-4 * q[2] - 2e-4, 1e-3 * q[0] * q[1]);
  };
  PathSplitter splitter(testing::errors_with(field), Eigen::Vector3d::Zero(), kSplitTolerance);
  EXPECT_GT(splitter.steepness(), 1e-3);
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d wanted = testing_support::random_vector(random, 0.9);
    const Eigen::Vector3d command = splitter.solver().command(wanted, {});
    EXPECT_LT((command + splitter.solver().error(command, {}) - wanted).norm(), 1e-9);
  }
}

/// One narrow tooth of 4 um, which equal steps would walk over.
TEST(PathSplitting, FindsANarrowTooth) {
  const auto field = [](const AxisPosition& q, const ApproachDirection&) {
    return Eigen::Vector3d(0, 0, std::max(0.0, 4e-6 - 4e-3 * std::abs(q[0] - 0.3171)));
  };
  const std::vector<double> ends = {-1.0, 0.3161, 0.3171, 0.3181, 1.0};
  PathSplitter splitter(testing::errors_with(field, {ends, {}, {}}), Eigen::Vector3d::Zero(),
                        kSplitTolerance);
  const SplitLine line = split(splitter, {0, 0, 0}, {1, 0, 0});
  EXPECT_LE(line.nodes.size(), 8U);
  EXPECT_LE(deviation(splitter, line, 4000), kSplitTolerance + 1e-8);
  // Without knowing of the pieces the tooth is missed: the test sees it.
  PathSplitter blind(testing::errors_with(field), Eigen::Vector3d::Zero(), kSplitTolerance);
  EXPECT_GT(deviation(splitter, split(blind, {0, 0, 0}, {1, 0, 0}), 4000), 2e-6);
}

/// Machines of sim, errors as polylines with 50 corners per axis, lines in all directions.
TEST(PathSplitting, HoldsOnRandomMachinesForRandomLines) {
  std::mt19937_64 random(5);
  for (std::size_t structure = 0; structure < 3; ++structure) {
    const sim::TruthMachine truth =
        sim::random_truth(sim::reference_machines()[structure], 70 + structure, {});
    const FitResult result = testing::result_of(truth);
    const Eigen::Vector3d tool = truth.machine().tools[1].offset;
    PathSplitter splitter(program_errors(result, {}, {}), tool, kSplitTolerance);
    std::size_t segments = 0;
    for (int i = 0; i < 40; ++i) {
      Eigen::Vector3d ends[2];
      for (Eigen::Vector3d& end : ends) {
        for (const AxisName name : kLinearAxes) {
          const Axis& axis = truth.machine().axis(name);
          end[direction_of(name)] =
              std::uniform_real_distribution<double>(axis.travel_min, axis.travel_max)(random);
        }
      }
      if (i % 4 == 0) ends[1] = ends[0] + 0.02 * (ends[1] - ends[0]);  // short ones
      const SplitLine line = split(splitter, ends[0], ends[1]);
      segments += line.nodes.size() - 1;
      EXPECT_LE(deviation(splitter, line, 60), kSplitTolerance) << "structure " << structure << " line " << i;
    }
    EXPECT_GT(segments, 100U);
  }
}

TEST(PathSplitting, ChordsKeepTheirToleranceAndTurnAtQuadrants) {
  NcArcWords words;
  words.start = Eigen::Vector3d(0.03, 0, 0);
  words.end = Eigen::Vector3d(0.03, 0, 0.01);
  const NcArc arc = arc_about(words, Eigen::Vector2d::Zero());
  const std::vector<double> ends = chord_ends(arc, 0.5e-6);
  // sqrt(8 * 0.5 um * 30 mm) = 0.346 mm of 188.5 mm: 545 chords at least.
  EXPECT_GE(ends.size() - 1, 544U);
  EXPECT_LE(ends.size() - 1, 552U);
  for (const double quadrant : {0.25, 0.5, 0.75})
    EXPECT_TRUE(std::ranges::any_of(ends, [&](double t) { return std::abs(t - quadrant) < 1e-12; }))
        << quadrant;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const Eigen::Vector3d middle = 0.5 * (arc.point(ends[i]) + arc.point(ends[i + 1]));
    EXPECT_LE(0.03 - middle.head<2>().norm(), 0.5e-6 + 1e-12);
  }
}

}  // namespace
}  // namespace volcal
