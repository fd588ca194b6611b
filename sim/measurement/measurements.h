#pragma once
/// Settings of the usual measurements, and the setups that they become. m, rad, s, degC. Positions of axes
/// are given as shares of the travel, `at` = (0.5, 0.5, 0.5) being the middle of the volume.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"
#include "volcal/sim/measurement/rotary_poses.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// Instruments of the measurements below.
inline constexpr const char* kLaserTracer = "laser-tracer";
inline constexpr const char* kLaserTracker = "laser-tracker";
inline constexpr const char* kBallBar = "ball-bar";
inline constexpr const char* kDisplacementReader = "displacement";
inline constexpr const char* kStraightnessReader = "straightness";
inline constexpr const char* kAngleReader = "angle";
inline constexpr const char* kVolumetricPoints = "volumetric-points";
inline constexpr const char* kRTest = "r-test";
inline constexpr const char* kProbedSphere = "probed-sphere";

/// Tracking interferometer or tracker at several stations: jittered grids over the whole travel, each
/// position met from both directions; or, of a run that has them, positions as given. Without stations and
/// runs: four stations around the volume and eight runs with the machine's first three tools (fewer if it has
/// fewer).
struct Tracking {
  struct Station {
    std::string name;
    Eigen::Vector3d position_w = Eigen::Vector3d::Zero();
  };
  struct Run {
    std::string station;
    std::string tool;
    std::vector<CommandedPoint> points = {};  ///< in place of a grid
  };
  std::string instrument = kLaserTracer;  ///< one that has a station
  std::vector<Station> stations;
  std::vector<Run> runs;
  int revisits = 0;  ///< how often the list of runs is gone through again
  /// Of rotary axes at the positions of the grid. Stations are in workpiece coordinates: the instrument goes
  /// with the table.
  RotaryMotion rotary = RotaryMotion::Home;
  RotaryGrid rotary_grid;
  bool parallel_moves = false;            ///< U, V, W at random positions of their travel, otherwise at home
  Eigen::Vector3i grid{9, 7, 6};          ///< positions per axis; readings per run are twice the product
  double jitter = 0.3;                    ///< largest, as a share of a grid step
  double station_guess_error = 5e-3;      ///< standard deviation per component of the campaign's guesses
  std::optional<double> station_sigma;    ///< stated in the campaign; absent = free
  double dead_path_spread = 1e-3;         ///< how far the readings' zero is from the first point
  double station_rotation_spread = 1e-2;  ///< rad, of a tracker's frame
  std::optional<double> length_scale_sigma;  ///< stated and drawn, one for all runs; absent = exact
  NoiseLevel noise{0.25e-6, 0.3e-6, 1e-6, 0.6e-6};
  double seconds_per_reading = 4.0;
};

/// ISO 230-4 circles, clockwise (run 0) and counter-clockwise (run 1), one setup per plane; or, of runs that
/// are listed, positions as given, one setup per run. The centre ball of a run stands at centre_w.
struct BallBarCircles {
  struct Run {
    std::string name;  ///< of its setup
    Eigen::Vector3d centre_w = Eigen::Vector3d::Zero();
    std::string tool;
    std::vector<CommandedPoint> points;  ///< on a sphere about the centre, within the bar's stroke
    SourcePlace place = {};              ///< of the study file, for messages
  };
  std::vector<Run> runs;            ///< in place of planes
  std::vector<std::string> planes;  ///< empty = XY, YZ, ZX, of which the machine has both axes
  std::string tool;                 ///< empty = the first
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  double radius = 0.0;  ///< 0 = 150 mm, or 45 % of the shortest travel if that is less
  int points_per_turn = 180;
  double feed = 0.0;                   ///< m/s; 0 = what seconds_per_reading gives, otherwise it gives that
  bool records_feed = false;           ///< the campaign has the column feed_mm_min
  double centre_error = 20e-6;         ///< standard deviation of centre_mm, per component
  double length_error = 3e-6;          ///< standard deviation of the bar's length error
  std::optional<double> length_sigma;  ///< stated: 0 = calibrated (and the length error is 0), absent = free
  NoiseLevel noise{0.3e-6, 0.0, 0.0, 0.5e-6};
  double seconds_per_reading = 0.1;
};

/// ISO 230-6: body diagonals, or the face diagonals of the planes through `at`; as steps if asked for.
struct Diagonals {
  enum class Kind { Body, Face };
  Kind kind = Kind::Body;
  bool steps = false;
  std::string tool;
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  double margin = 0.0;  ///< share of the travel left out at each end
  int points = 21;      ///< of a diagonal; of step diagonals: the number of steps
  int runs = 1;
  bool bidirectional = true;
  double offset_spread = 20e-6;
  NoiseLevel noise{0.25e-6, 0.3e-6, 0.0, 0.5e-6};
  double seconds_per_reading = 2.0;
};

/// ISO 230-2 positioning along one axis each, bidirectional.
struct AxisLines {
  std::vector<AxisName> axes;  ///< empty = X, Y, Z, of which the machine has them
  std::string tool;
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  int points = 11;
  int runs = 5;
  bool offset_per_line = false;
  double offset_spread = 20e-6;
  NoiseLevel noise{0.25e-6, 0.3e-6, 0.0, 0.5e-6};
  double seconds_per_reading = 4.0;
};

/// Straightness of each axis in both transverse directions against a straightedge or beam, bidirectional.
struct StraightnessLines {
  std::vector<AxisName> axes;  ///< empty = X, Y, Z, of which the machine has them
  std::string tool;
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  int points = 21;
  int runs = 1;
  double offset_spread = 5e-6;
  double rotation_spread = 50e-6;  ///< rad, of the artefact
  NoiseLevel noise{0.4e-6, 0.0, 0.0, 0.5e-6};
  double seconds_per_reading = 2.0;
};

/// A square in a plane: straightness of both axes against the arms of one artefact, whose rotation they
/// share.
struct Squares {
  std::vector<std::string> planes;  ///< empty = XY, YZ, ZX, of which the machine has both axes
  std::string tool;
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  int points = 21;
  int runs = 1;
  double offset_spread = 5e-6;
  double rotation_spread = 50e-6;
  NoiseLevel noise{0.4e-6, 0.0, 0.0, 0.5e-6};
  double seconds_per_reading = 2.0;
};

/// Angles along each linear axis, about x, y and z: angular interferometer ("relative") or level ("tool",
/// "table"). Of a rotary axis the angle about itself, actual less commanded, over its travel, one turn at
/// most (ISO 230-2).
struct AngleLines {
  std::vector<AxisName> axes;  ///< empty = X, Y, Z, of which the machine has them
  std::string body = "relative";
  std::string tool;
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  int points = 21;
  int runs = 1;
  double offset_spread = 10e-6;  ///< rad
  NoiseLevel noise{0.5e-6, 0.0, 0.0, 0.0};
  double seconds_per_reading = 2.0;
};

/// Axis of rotation (ISO 230-7): displacements of a sphere on the line of a rotary axis, which turns alone,
/// a turn or its travel a run; one setup per axis, tool and height.
struct AxisOfRotation {
  std::vector<AxisName> axes;      ///< empty = every rotary axis
  std::vector<std::string> tools;  ///< empty = the first
  /// Of the sphere along the line, from the axis' centre; empty = at the centre, or, where no linear axis
  /// goes along the line, wherever the tool's length has it.
  std::vector<double> heights;
  std::string frame = "workpiece";  ///< axes of the readings; or "tool", "machine"
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  int points = 36;  ///< of a run
  int runs = 2;
  bool bidirectional = false;
  double offset_spread = 5e-6;  ///< of the sphere from the line, per component
  NoiseLevel noise{0.2e-6, 0.0, 0.0, 0.3e-6};
  double seconds_per_reading = 2.0;
};

/// Drift at rest (ISO 230-3): nothing moves, and displacements of the spindle against spheres on the table
/// are read over time. One setup per tool, all read at the same times: tools of different length are places
/// along one mandrel.
struct DriftAtRest {
  std::vector<std::string> tools;  ///< empty = the first
  Eigen::Vector3d at{0.5, 0.5, 0.5};
  double duration = 4.0 * 3600.0;  ///< s
  double seconds_per_reading = 300.0;
  double offset_spread = 20e-6;  ///< of the readings' zeros, per component
  NoiseLevel noise{0.1e-6, 0.0, 0.0, 0.0};
};

/// Error vectors on a regular grid over the travel (grid plate, probed artefact).
struct PointGrid {
  Eigen::Vector3i grid{5, 4, 3};
  RotaryMotion rotary = RotaryMotion::Home;
  RotaryGrid rotary_grid;
  bool parallel_moves = false;  ///< U, V, W at random positions of their travel, otherwise at home
  std::string tool;
  bool rigid_alignment = true;
  double alignment_shift = 20e-6;
  double alignment_rotation = 20e-6;  ///< rad
  NoiseLevel noise{0.5e-6, 0.0, 0.0, 0.5e-6};
  double seconds_per_reading = 10.0;
};

/// A sphere on the workpiece's table, or the place of a ball-bar's centre ball.
struct SpherePlace {
  std::string name;
  Eigen::Vector3d position_w = Eigen::Vector3d::Zero();  ///< nominal
};

/// Where rotary axes are measured: every place with every tool, rotary axes on a grid, linear axes following.
struct RotaryPoses {
  /// A setup with positions of its own, as a plan has them; in place of the grid.
  struct Run {
    std::string name;
    std::string sphere;
    std::string tool;
    std::vector<CommandedPoint> points;
    SourcePlace place = {};
  };

  std::vector<SpherePlace> spheres;
  std::vector<std::string> tools;  ///< empty = the first three of the machine
  RotaryGrid grid;
  std::vector<Run> runs;  ///< of R-tests and centres
};

/// R-test (ISO 10791-6): displacement of the tool point against a sphere that it stays on, one setup per
/// sphere and tool.
struct RTest {
  RotaryPoses poses;
  std::string frame = "workpiece";  ///< axes of the readings; or "tool", "machine"
  double offset_spread = 30e-6;     ///< of the sphere from where the program has it, per component
  NoiseLevel noise{0.5e-6, 0.0, 0.0, 0.5e-6};
  double seconds_per_reading = 5.0;
};

/// A touch probe on spheres: the centres that the control finds, one setup per sphere and tool; or every
/// contact, one setup per sphere, tool and kind of contact: W along the tool from its side, U and V across it
/// along the tool's x and y, from both sides.
struct ProbedSphere {
  RotaryPoses poses;
  bool contacts = false;
  std::vector<std::string> kinds = {"W", "U", "V"};
  double place_error = 50e-6;          ///< of the true centres from the stated places, per component
  double radius = 18e-3;               ///< nominal, sphere and ball
  double radius_error = 5e-6;          ///< standard deviation, one draw per kind of contact
  std::optional<double> radius_sigma;  ///< stated: 0 = calibrated (and the error is 0), absent = free
  NoiseLevel noise{0.5e-6, 0.0, 0.0, 0.7e-6};
  double seconds_per_reading = 20.0;
};

/// Ball-bar while rotary axes move: the tool's ball stays at the bar's length from the centre ball in one
/// direction, one setup per place, tool and direction.
struct BallBarPoses {
  RotaryPoses poses;
  double length = 0.1;
  std::vector<std::string> directions = {"x", "y", "z"};
  std::string frame = "machine";  ///< in whose axes the directions stand still; or "workpiece", "tool"
  BallBarCircles bar;             ///< its errors and noise
};

using MeasurementSettings =
    std::variant<Tracking, BallBarCircles, Diagonals, AxisLines, StraightnessLines, Squares, AngleLines,
                 PointGrid, RTest, ProbedSphere, BallBarPoses, AxisOfRotation, DriftAtRest>;

struct Measurement {
  std::string name;  ///< prefix of its setups' names; empty = by kind
  MeasurementSettings settings;
  SourcePlace place = {};  ///< of the study file, for messages
  bool shuffled = false;   ///< lines in random order instead of the path's
};

/// Setups of a measurement, each with as many unseen positions as it has points; nuisance truths are drawn
/// from the stream of (seed, measurement name). The machine needs two of the axes X, Y and Z. Throws
/// InputError for a tool, station, plane or number that makes no sense.
std::vector<SetupPlan> plan_setups(const Measurement& measurement, const Machine& machine,
                                   std::uint64_t seed);

}  // namespace volcal::sim
