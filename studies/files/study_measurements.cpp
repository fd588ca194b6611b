#include <algorithm>

#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/files/run_points.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal {
namespace {

constexpr std::int64_t kMostPoints = 1000000;
constexpr std::int64_t kMostRotaryPositions = 1000;
constexpr double kMostReadings = 2e6;  // of a measurement; a simulated campaign is held in memory

void read(const TomlTable& table, const char* key, double& value) {
  if (const auto found = table.number(key, kNotNegative)) value = *found;
}

void read(const TomlTable& table, const char* key, std::optional<double>& value) {
  if (const auto found = table.number(key, kNotNegative)) value = *found;
}

void read(const TomlTable& table, const char* key, int& value, int least) {
  if (const auto found = table.integer(key, least, kMostPoints)) value = static_cast<int>(*found);
}

void read(const TomlTable& table, const char* key, std::string& value) {
  if (const auto found = table.text(key)) value = *found;
}

void read(const TomlTable& table, const char* key, bool& value) {
  if (const auto found = table.boolean(key)) value = *found;
}

void read_planes(const TomlTable& table, std::vector<std::string>& planes) {
  if (const auto found = table.texts("planes")) planes = *found;
}

template <class IsWanted>
void read_axes(const TomlTable& table, const IsWanted& is_wanted, const std::string& remedy,
               std::vector<AxisName>& axes) {
  const auto names = table.texts("axes");
  if (!names) return;
  axes.clear();
  for (const std::string& name : *names) {
    const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
    if (!axis || !is_wanted(*axis))
      table.fail("axes", table.path() + ".axes names \"" + printable(name) + "\"", remedy);
    axes.push_back(*axis);
  }
}

void read_linear_axes(const TomlTable& table, std::vector<AxisName>& axes) {
  read_axes(
      table, [](AxisName axis) { return !is_rotary(axis); }, "list linear axes: [\"X\", \"Y\"]", axes);
}

/// `readings` follow from the numbers beside `key`.
void require_bounded(const TomlTable& table, const char* key, double readings) {
  if (readings <= kMostReadings) return;
  table.fail(key, table.path() + " asks for " + number_text(readings) + " readings",
             "at most 2,000,000 a measurement; reduce " + std::string(key));
}

void read_grid(const TomlTable& table, Eigen::Vector3i& grid) {
  const auto counts = table.numbers("grid", {2.0, 1000.0});
  if (!counts) return;
  const bool whole = std::ranges::all_of(*counts, [](double n) { return n == static_cast<int>(n); });
  if (counts->size() != 3 || !whole) {
    table.fail("grid", table.path() + ".grid is not three whole numbers",
               "give positions along X, Y, Z: [9, 7, 6]");
  }
  for (int k = 0; k < 3; ++k) grid[k] = static_cast<int>((*counts)[static_cast<std::size_t>(k)]);
  require_bounded(table, "grid", grid.cast<double>().prod());
}

/// Shares of the travel at which the other axes stand.
void read_at(const TomlTable& table, Eigen::Vector3d& at) {
  const auto shares = table.numbers("at", {0.0, 1.0});
  if (!shares) return;
  if (shares->size() != 3) {
    table.fail("at", table.path() + ".at is not three numbers",
               "give shares of the travel of X, Y, Z: [0.5, 0.5, 0.5]");
  }
  at = Eigen::Vector3d((*shares)[0], (*shares)[1], (*shares)[2]);
}

/// What the campaign file does not say; `unit` of the readings.
void read_sealed_noise(const TomlTable& inside, const std::string& unit, sim::NoiseLevel& noise) {
  read(inside, ("wander_" + unit).c_str(), noise.drift);
  if (const auto time = inside.number("wander_time_s", {1e-3, 1e9})) noise.drift_time = *time;
  read(inside, ("line_" + unit).c_str(), noise.line);
  if (const auto share = inside.number("outlier_share", {0.0, 0.5})) noise.outlier_share = *share;
  read(inside, "outlier_sigma", noise.outlier_size);
}

void read_length_noise(const TomlTable& table, sim::NoiseLevel& noise) {
  if (const auto inside = table.table("noise")) {
    read_sealed_noise(*inside, "um", noise);
    read(*inside, "constant_um", noise.constant);
    read(*inside, "per_metre_um", noise.per_metre);
    read(*inside, "repeatability_um", noise.repeatability);
  }
}

template <class Settings>
void read_line_settings(const TomlTable& table, Settings& settings) {
  read(table, "tool", settings.tool);
  read_at(table, settings.at);
  read(table, "points", settings.points, 2);
  read(table, "runs", settings.runs, 1);
  constexpr double kMostLines = 8;  // both directions of the diagonals of a volume
  require_bounded(table, table.has("runs") ? "runs" : "points",
                  kMostLines * static_cast<double>(settings.points) * static_cast<double>(settings.runs));
  read(table, "reading_s", settings.seconds_per_reading);
}

AxisName rotary_axis(const TomlTable& table, const std::string& name) {
  const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
  if (!axis || !is_rotary(*axis))
    table.fail(name, table.path() + " names \"" + printable(name) + "\"", "name rotary axes: A, B or C");
  return *axis;
}

/// Tables by axis: positions = { A = 7, C = 12 }, range_deg = { A = [-90, 30] }.
void read_rotary_grid(const TomlTable& table, sim::RotaryGrid& grid) {
  if (const auto counts = table.table("positions")) {
    for (const std::string& name : counts->keys()) {
      grid.points[rotary_axis(*counts, name)] =
          static_cast<int>(counts->integer(name, 1, kMostRotaryPositions).value());
    }
  }
  if (const auto ranges = table.table("range_deg")) {
    for (const std::string& name : ranges->keys()) {
      const AxisName axis = rotary_axis(*ranges, name);
      const std::vector<double> ends = *ranges->numbers(name);
      if (ends.size() != 2 || !(ends[0] < ends[1]))
        ranges->fail(name, ranges->path() + "." + name + " is not a range", "give [from, to] in deg");
      grid.range[axis] = {ends[0] * kRadianPerDegree, ends[1] * kRadianPerDegree};
    }
  }
  grid.combined = table.choice("poses", {"grid", "singly"}).value_or("grid") == "grid";
  read(table, "bidirectional", grid.bidirectional);
  if (const auto jitter = table.number("jitter", {0.0, 0.5})) grid.jitter = *jitter;
}

sim::RotaryPoses read_rotary_poses(const TomlTable& table) {
  sim::RotaryPoses poses;
  const std::vector<TomlTable> spheres = table.required_tables(
      "spheres", "add a [[measurements.spheres]] table with name and position_mm for every place");
  for (const TomlTable& sphere : spheres)
    poses.spheres.push_back({sphere.required_name("name"), sphere.required_vector3("position_mm")});
  if (const auto tools = table.texts("tools")) poses.tools = *tools;
  read_rotary_grid(table, poses.grid);
  return poses;
}

/// What rotary axes do at the positions of linear axes: rotary = "home", "random" or "grid".
void read_rotary_motion(const TomlTable& table, sim::RotaryMotion& motion, sim::RotaryGrid& grid) {
  const std::string word = table.choice("rotary", {"home", "random", "grid"}).value_or("home");
  motion = word == "random" ? sim::RotaryMotion::Random
           : word == "grid" ? sim::RotaryMotion::Grid
                            : sim::RotaryMotion::Home;
  if (motion == sim::RotaryMotion::Home) return;
  sim::RotaryGrid read_grid;
  if (const auto inside = table.table("rotary_axes")) read_rotary_grid(*inside, read_grid);
  grid = read_grid;
}

/// Positions of a run in a file of their own: columns of the machine's axes, dir_x ..., line and run as in
/// the readings of a campaign (run_points.h).
std::vector<sim::CommandedPoint> read_points(const TomlTable& run) {
  const auto file = run.text("points");
  if (!file) return {};
  return read_run_points(resolve_path(run.place().file, *file), run.place("points"));
}

sim::Tracking read_tracking(const TomlTable& table) {
  sim::Tracking settings;
  for (const TomlTable& station : table.tables("stations")) {
    settings.stations.push_back({station.required_name("name"), station.required_vector3("position_mm")});
  }
  for (const TomlTable& run : table.tables("runs")) {
    settings.runs.push_back({run.required_text("station"), run.required_text("tool"), read_points(run)});
  }
  read(table, "revisits", settings.revisits, 0);
  read_grid(table, settings.grid);
  require_bounded(table, table.has("revisits") ? "revisits" : "grid",
                  (settings.grid.cast<double>().prod() + static_cast<double>(settings.revisits)) *
                      static_cast<double>(std::max<std::size_t>(settings.runs.size(), 1)));
  if (const auto jitter = table.number("jitter", {0.0, 0.5})) settings.jitter = *jitter;
  read_rotary_motion(table, settings.rotary, settings.rotary_grid);
  settings.parallel_moves = table.choice("parallel", {"home", "random"}).value_or("home") == "random";
  read(table, "guess_error_mm", settings.station_guess_error);
  read(table, "station_sigma_mm", settings.station_sigma);
  read(table, "scale_sigma_um_per_m", settings.length_scale_sigma);
  read(table, "reading_s", settings.seconds_per_reading);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_laser_tracer(const TomlTable& table) {
  sim::Tracking settings = read_tracking(table);
  settings.instrument = sim::kLaserTracer;
  read(table, "dead_path_spread_mm", settings.dead_path_spread);
  return settings;
}

sim::MeasurementSettings read_laser_tracker(const TomlTable& table) {
  sim::Tracking settings = read_tracking(table);
  settings.instrument = sim::kLaserTracker;
  read(table, "station_rotation_spread_mrad", settings.station_rotation_spread);
  if (const auto inside = table.table("noise")) read(*inside, "angle_urad", settings.noise.angle);
  return settings;
}

/// Runs with their positions say themselves what these keys say of circles.
void refuse_keys_of_circles(const TomlTable& table) {
  for (const char* key : {"planes", "tool", "at", "radius_mm", "points_per_turn", "feed_mm_min"}) {
    if (!table.has(key)) continue;
    table.fail(key, table.path() + " has runs with their own positions, and " + key + " of circles",
               std::string("leave ") + key + " or the runs out");
  }
}

void read_ball_bar_runs(const TomlTable& table, sim::BallBarCircles& settings) {
  for (const TomlTable& run : table.tables("runs")) {
    settings.runs.push_back({run.required_name("name"), run.required_vector3("centre_mm"),
                             run.required_text("tool"), read_points(run), run.place()});
  }
  if (!settings.runs.empty()) refuse_keys_of_circles(table);
}

sim::MeasurementSettings read_ball_bar(const TomlTable& table) {
  sim::BallBarCircles settings;
  read_ball_bar_runs(table, settings);
  read_planes(table, settings.planes);
  read(table, "tool", settings.tool);
  read_at(table, settings.at);
  read(table, "radius_mm", settings.radius);
  read(table, "points_per_turn", settings.points_per_turn, 8);
  read(table, "feed_mm_min", settings.feed);
  read(table, "record_feed", settings.records_feed);
  read(table, "centre_error_um", settings.centre_error);
  read(table, "length_error_um", settings.length_error);
  read(table, "length_sigma_um", settings.length_sigma);
  read(table, "reading_s", settings.seconds_per_reading);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_diagonals(const TomlTable& table) {
  sim::Diagonals settings;
  if (table.choice("diagonals", {"body", "face"}).value_or("body") == "face") {
    settings.kind = sim::Diagonals::Kind::Face;
  }
  read(table, "steps", settings.steps);
  if (const auto margin = table.number("margin", {0.0, 0.45})) settings.margin = *margin;
  read(table, "bidirectional", settings.bidirectional);
  read(table, "offset_spread_um", settings.offset_spread);
  read_line_settings(table, settings);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_axis_lines(const TomlTable& table) {
  sim::AxisLines settings;
  read_linear_axes(table, settings.axes);
  settings.offset_per_line = table.choice("offset_per", {"setup", "line"}).value_or("setup") == "line";
  read(table, "offset_spread_um", settings.offset_spread);
  read_line_settings(table, settings);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_straightness(const TomlTable& table) {
  sim::StraightnessLines settings;
  read_linear_axes(table, settings.axes);
  read(table, "offset_spread_um", settings.offset_spread);
  read(table, "rotation_spread_urad", settings.rotation_spread);
  read_line_settings(table, settings);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_squares(const TomlTable& table) {
  sim::Squares settings;
  read_planes(table, settings.planes);
  read(table, "offset_spread_um", settings.offset_spread);
  read(table, "rotation_spread_urad", settings.rotation_spread);
  read_line_settings(table, settings);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_angles(const TomlTable& table) {
  sim::AngleLines settings;
  read_axes(
      table, [](AxisName) { return true; }, "list axes of the machine: [\"X\", \"C\"]", settings.axes);
  if (const auto body = table.choice("body", {"relative", "tool", "table"})) settings.body = *body;
  read(table, "offset_spread_urad", settings.offset_spread);
  read_line_settings(table, settings);
  if (const auto inside = table.table("noise")) {
    read(*inside, "constant_urad", settings.noise.constant);
    read_sealed_noise(*inside, "urad", settings.noise);
  }
  return settings;
}

sim::MeasurementSettings read_point_grid(const TomlTable& table) {
  sim::PointGrid settings;
  read_grid(table, settings.grid);
  read_rotary_motion(table, settings.rotary, settings.rotary_grid);
  settings.parallel_moves = table.choice("parallel", {"home", "random"}).value_or("home") == "random";
  read(table, "tool", settings.tool);
  settings.rigid_alignment = table.choice("alignment", {"rigid", "none"}).value_or("rigid") == "rigid";
  read(table, "alignment_shift_um", settings.alignment_shift);
  read(table, "alignment_rotation_urad", settings.alignment_rotation);
  read(table, "reading_s", settings.seconds_per_reading);
  read_length_noise(table, settings.noise);
  return settings;
}

/// Runs with their own positions, each on one of the spheres.
void read_sphere_runs(const TomlTable& table, sim::RotaryPoses& poses) {
  for (const TomlTable& run : table.tables("runs")) {
    poses.runs.push_back({run.required_name("name"), run.required_text("sphere"), run.required_text("tool"),
                          read_points(run), run.place()});
  }
  if (poses.runs.empty()) return;
  for (const char* key : {"tools", "positions", "range_deg", "poses", "bidirectional", "jitter"}) {
    if (!table.has(key)) continue;
    table.fail(key, table.path() + " has runs with their own positions, and " + key + " of a grid",
               std::string("leave ") + key + " or the runs out");
  }
}

sim::MeasurementSettings read_r_test(const TomlTable& table) {
  sim::RTest settings;
  settings.poses = read_rotary_poses(table);
  read_sphere_runs(table, settings.poses);
  if (const auto frame = table.choice("frame", {"workpiece", "tool", "machine"})) settings.frame = *frame;
  read(table, "offset_spread_um", settings.offset_spread);
  read(table, "reading_s", settings.seconds_per_reading);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_probed_sphere(const TomlTable& table) {
  sim::ProbedSphere settings;
  settings.poses = read_rotary_poses(table);
  read_sphere_runs(table, settings.poses);
  settings.contacts = table.choice("record", {"centres", "contacts"}).value_or("centres") == "contacts";
  for (const char* key : {"contacts", "radius_mm", "radius_error_um", "radius_sigma_um"}) {
    if (settings.contacts || !table.has(key)) continue;
    table.fail(key, table.path() + " records centres, and " + key + " is of single contacts",
               "write record = \"contacts\", or leave " + std::string(key) + " out");
  }
  if (const auto kinds = table.texts("contacts")) settings.kinds = *kinds;
  read(table, "place_error_um", settings.place_error);
  read(table, "radius_mm", settings.radius);
  read(table, "radius_error_um", settings.radius_error);
  read(table, "radius_sigma_um", settings.radius_sigma);
  read(table, "reading_s", settings.seconds_per_reading);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_ball_bar_poses(const TomlTable& table) {
  sim::BallBarPoses settings;
  settings.poses = read_rotary_poses(table);
  read(table, "length_mm", settings.length);
  if (const auto directions = table.texts("directions")) settings.directions = *directions;
  if (const auto frame = table.choice("frame", {"workpiece", "tool", "machine"})) settings.frame = *frame;
  read(table, "centre_error_um", settings.bar.centre_error);
  read(table, "length_error_um", settings.bar.length_error);
  read(table, "length_sigma_um", settings.bar.length_sigma);
  read(table, "reading_s", settings.bar.seconds_per_reading);
  read_length_noise(table, settings.bar.noise);
  return settings;
}

sim::MeasurementSettings read_axis_of_rotation(const TomlTable& table) {
  sim::AxisOfRotation settings;
  read_axes(table, is_rotary, "list rotary axes: [\"C\"]", settings.axes);
  if (const auto tools = table.texts("tools")) settings.tools = *tools;
  if (const auto heights = table.numbers("heights_mm")) settings.heights = *heights;
  if (const auto frame = table.choice("frame", {"workpiece", "tool", "machine"})) settings.frame = *frame;
  read_at(table, settings.at);
  read(table, "points", settings.points, 3);
  read(table, "runs", settings.runs, 1);
  require_bounded(table, table.has("runs") ? "runs" : "points",
                  2.0 * static_cast<double>(settings.points) * static_cast<double>(settings.runs));
  read(table, "bidirectional", settings.bidirectional);
  read(table, "offset_spread_um", settings.offset_spread);
  read(table, "reading_s", settings.seconds_per_reading);
  read_length_noise(table, settings.noise);
  return settings;
}

sim::MeasurementSettings read_drift_at_rest(const TomlTable& table) {
  sim::DriftAtRest settings;
  if (const auto tools = table.texts("tools")) settings.tools = *tools;
  read_at(table, settings.at);
  if (const auto duration = table.number("duration_s", {1.0, 1e8})) settings.duration = *duration;
  if (const auto seconds = table.number("reading_s", {1e-3, 1e6})) settings.seconds_per_reading = *seconds;
  require_bounded(table, "duration_s", settings.duration / settings.seconds_per_reading);
  read(table, "offset_spread_um", settings.offset_spread);
  read_length_noise(table, settings.noise);
  return settings;
}

struct MeasurementKind {
  const char* name;
  sim::MeasurementSettings (*read)(const TomlTable& table);
};

// One line per kind of measurement.
constexpr auto kMeasurementKinds = std::to_array<MeasurementKind>({
    {sim::kLaserTracer, read_laser_tracer},
    {sim::kLaserTracker, read_laser_tracker},
    {"ball-bar-circles", read_ball_bar},
    {"diagonals", read_diagonals},
    {"axis-lines", read_axis_lines},
    {"straightness-lines", read_straightness},
    {"squares", read_squares},
    {"angle-lines", read_angles},
    {"point-grid", read_point_grid},
    {sim::kRTest, read_r_test},
    {sim::kProbedSphere, read_probed_sphere},
    {"ball-bar-poses", read_ball_bar_poses},
    {"axis-of-rotation", read_axis_of_rotation},
    {"drift-at-rest", read_drift_at_rest},
});

}  // namespace

sim::Measurement read_measurement(const TomlTable& table) {
  std::vector<std::string> names;
  for (const MeasurementKind& kind : kMeasurementKinds) names.emplace_back(kind.name);
  const auto name = table.choice("kind", names);
  if (!name) table.fail_missing("kind");
  const auto* const kind = std::ranges::find_if(
      kMeasurementKinds, [&](const MeasurementKind& each) { return *name == each.name; });
  return {table.text("name").value_or(""), kind->read(table), table.place(),
          table.boolean("shuffled").value_or(false)};
}

}  // namespace volcal
