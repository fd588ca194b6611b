#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/io/import/column_meaning.h"
#include "volcal/identify/io/import/import_format.h"
#include "volcal/identify/io/import/table_layout.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

constexpr double kWorstFit = 5e-3;       // m, RMS; errors of machines are far below
constexpr double kLeastWidth = 1e-3;     // of a cloud of points across its longest direction, of its length
constexpr std::size_t kLeastPoints = 3;  // that fix a rigid alignment

/// Coordinates of a point in a list: of a corner frame, or polar.
enum class Coordinate { X, Y, Z, Horizontal, Vertical, Distance };
constexpr std::array kCartesian = {Coordinate::X, Coordinate::Y, Coordinate::Z};
constexpr std::array kPolar = {Coordinate::Horizontal, Coordinate::Vertical, Coordinate::Distance};

std::optional<Coordinate> coordinate_in(const HeaderWords& header) {
  if (header.has({"hz", "horizontal", "azimuth", "azimut", "theta"})) return Coordinate::Horizontal;
  if (header.has({"v", "vz", "vertical", "zenith", "zenit", "elevation"})) return Coordinate::Vertical;
  if (header.has({"d", "sd", "distance", "distanz", "range", "strecke", "slope", "length"}))
    return Coordinate::Distance;
  switch (header.letter()) {
    case 'x':
      return Coordinate::X;
    case 'y':
      return Coordinate::Y;
    case 'z':
      return Coordinate::Z;
    default:
      return std::nullopt;
  }
}

bool names_points(const HeaderWords& header) {
  return header.has({"name", "point", "pt", "punkt", "id", "nr", "no", "number", "target"});
}

/// Where the coordinates of a list stand, and the columns that make a point's name.
struct PointColumns {
  std::map<Coordinate, std::size_t> column;
  std::map<Coordinate, HeaderWords> words;
  std::vector<std::size_t> name;

  bool has(const std::array<Coordinate, 3>& all) const {
    return std::ranges::all_of(all, [&](Coordinate one) { return column.contains(one); });
  }
};

/// By the header, or by `names` of the columns of numbers where the list has none.
PointColumns point_columns(const TableLayout& layout, const std::vector<std::string>& names) {
  PointColumns found;
  std::size_t number = 0;
  for (std::size_t k = 0; k < layout.numeric.size(); ++k) {
    std::string header = layout.header.empty() ? "" : layout.header[k];
    if (header.empty() && layout.numeric[k] && number < names.size()) header = names[number];
    number += layout.numeric[k] ? 1 : 0;
    const HeaderWords words = header_words(header);
    const auto coordinate = layout.numeric[k] ? coordinate_in(words) : std::nullopt;
    if (coordinate && !found.column.contains(*coordinate)) {
      found.column[*coordinate] = k;
      found.words[*coordinate] = words;
    } else if (!layout.numeric[k] || names_points(words)) {
      found.name.push_back(k);
    }
  }
  return found;
}

std::string name_of_point(const TableRow& row, const std::vector<std::size_t>& columns) {
  std::string name;
  for (const std::size_t k : columns) name += (name.empty() ? "" : "::") + row.cells[k];
  return name;
}

std::string behind_groups(const std::string& name) {
  const std::size_t at = name.rfind("::");
  return at == std::string::npos ? name : name.substr(at + 2);
}

/// Commanded positions by the names of points.
class NominalPoints {
 public:
  NominalPoints(const ImportSource& source, const ImportAnswers& answers, const Machine& machine)
      : path_(source.path) {
    const TableLayout layout = guess_table_layout(source);
    std::vector<std::size_t> name;
    for (std::size_t k = 0; k < layout.header.size(); ++k) {
      if (!layout.numeric[k] || names_points(header_words(layout.header[k]))) name.push_back(k);
    }
    if (name.empty())
      throw InputError({path_, layout.header_line}, "no column names the points",
                       "a header as name,x_mm,y_mm,z_mm is expected");
    for (const Axis& axis : machine.axes) find_axis(axis.name, layout, answers);
    for (const auto& [axis, column] : column_) find_shift(axis, column, layout, answers);
    for (const TableRow& row : layout.rows) {
      AxisPosition position{};
      for (const auto& [axis, column] : column_)
        position[index_of(axis)] =
            (layout.number(row, column) + shift_[axis]) * position_unit(axis).si_per_unit;
      for (const auto& [axis, value] : standing_)
        position[index_of(axis)] = value * position_unit(axis).si_per_unit;
      if (!position_.emplace(name_of_point(row, name), position).second)
        throw InputError({path_, row.line},
                         "point " + printable(name_of_point(row, name)) + " is commanded twice",
                         "give every point its own name");
    }
  }

  const AxisPosition& of(const std::string& name, const SourcePlace& place) const {
    auto found = position_.find(name);
    if (found == position_.end()) found = position_.find(behind_groups(name));
    if (found == position_.end())
      throw InputError(place, "point " + printable(name) + " has no commanded position in " + path_,
                       "add a row for it there, or delete this one");
    return found->second;
  }
  std::size_t size() const { return position_.size(); }
  /// By `--at`, of axes that move, mm or deg.
  const std::map<AxisName, double>& shift() const { return shift_; }

 private:
  void find_axis(AxisName axis, const TableLayout& layout, const ImportAnswers& answers) {
    const std::string name = position_column(axis);
    const auto found = std::ranges::find(layout.header, name);
    const auto standing = answers.at.find(axis);
    if (found != layout.header.end() &&
        layout.numeric[static_cast<std::size_t>(found - layout.header.begin())]) {
      column_[axis] = static_cast<std::size_t>(found - layout.header.begin());
    } else if (standing != answers.at.end()) {
      standing_[axis] = standing->second;
    } else {
      throw InputError(
          {path_, layout.header_line}, "column " + name + " of commanded positions is missing",
          "a header as name,x_mm,y_mm,z_mm is expected; an axis that stood still may be given by --at");
    }
  }

  void find_shift(AxisName axis, std::size_t column, const TableLayout& layout,
                  const ImportAnswers& answers) {
    std::vector<double> positions;
    for (const TableRow& row : layout.rows) positions.push_back(layout.number(row, column));
    shift_[axis] = shift_of(axis, positions, {path_, layout.rows.front().line}, answers);
  }

  std::string path_;
  std::map<AxisName, std::size_t> column_;
  std::map<AxisName, double> standing_, shift_;
  std::map<std::string, AxisPosition> position_;
};

class TrackerPoints {
 public:
  TrackerPoints(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
                std::size_t tool)
      : source_(source),
        answers_(answers),
        machine_(machine),
        tool_(tool),
        layout_(guess_table_layout(source)) {}

  ImportedReadings read() {
    find_columns();
    for (const TableRow& row : layout_.rows) readings_.source_line.push_back(row.line);
    add_fact("rows",
             std::to_string(layout_.rows.size()) + ", cells separated by " +
                 delimiter_name(layout_.delimiter) + ", decimal " +
                 (layout_.decimal == ',' ? "comma" : "point"),
             "the numbers");
    if (const std::string beside = lines_beside(layout_); !beside.empty())
      add_fact("beside the list", beside, "units are looked for");
    const std::vector<Eigen::Vector3d> measured_s = polar_ ? from_polar() : from_cartesian();
    const std::vector<Eigen::Vector3d> commanded_w = commanded_points();
    const Eigen::Isometry3d pose_ws = best_fit(measured_s, commanded_w);
    if (polar_) {
      add_polar_readings(pose_ws.translation());
    } else {
      add_error_vectors(pose_ws, measured_s, commanded_w);
    }
    for (const Axis& axis : machine_.axes)
      readings_.columns.push_back(
          {direction_column(axis.name), std::vector<double>(layout_.rows.size(), 0.0)});
    add_fact("directions of approach", "unknown", "a list has none");
    return std::move(readings_);
  }

 private:
  void add_fact(const std::string& what, const std::string& value, const std::string& said_by) {
    readings_.facts.push_back({what, value, said_by});
  }

  void find_columns() {
    std::vector<std::string> names;
    if (answers_.columns) {
      for (std::string_view rest = *answers_.columns; !rest.empty();) {
        const std::size_t end = std::min(rest.find(','), rest.size());
        names.emplace_back(without_blanks(rest.substr(0, end)));
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
    } else if (layout_.header.empty()) {
      ask_for(source_, "what its columns of numbers are",
              "--columns x,y,z or --columns hz,v,distance, in their order");
    }
    columns_ = point_columns(layout_, names);
    polar_ = columns_.has(kPolar);
    const SourcePlace place{source_.path, layout_.header_line};
    if (!polar_ && !columns_.has(kCartesian))
      throw InputError(place, "the list has neither x, y, z nor two angles and a distance",
                       "name its columns of numbers with --columns x,y,z or --columns hz,v,distance");
    if (polar_ && columns_.has(kCartesian))
      throw InputError(place, "the list has coordinates and angles",
                       "leave one of the two out; readings would count twice");
    if (columns_.name.empty())
      throw InputError(place, "no column names the points",
                       "commanded positions are found by the names of points");
    add_fact("coordinates", polar_ ? "two angles and a distance" : "x, y, z",
             answers_.columns && layout_.header.empty() ? "--columns"
                                                        : "line " + std::to_string(layout_.header_line));
  }

  /// A unit that a comment above the list names: "Units: Millimeters, Degrees".
  std::optional<std::pair<std::string, int>> unit_in_comments(bool angle) const {
    using Words = std::pair<std::string_view, std::string_view>;
    constexpr auto kLengths = std::to_array<Words>(
        {{"millimet", "mm"}, {"micromet", "um"}, {"inch", "inch"}, {"meter", "m"}, {"metre", "m"}});
    constexpr auto kAngles =
        std::to_array<Words>({{"degree", "deg"}, {"gon", "gon"}, {"grad", "gon"}, {"radian", "rad"}});
    for (const TextLine& line : layout_.above) {
      const std::string text = lower_case(line.text);
      if (text.find("unit") == std::string::npos) continue;
      const auto says = [&](const Words& words) { return text.find(words.first) != std::string::npos; };
      const auto found = angle ? std::ranges::find_if(kAngles, says) : std::ranges::find_if(kLengths, says);
      const bool any = angle ? found != std::end(kAngles) : found != std::end(kLengths);
      if (any) return std::pair(std::string(found->second), line.number);
    }
    return std::nullopt;
  }

  /// SI per unit of a coordinate.
  double unit_of(Coordinate coordinate, bool angle) {
    const std::string& header = columns_.words.at(coordinate).unit;
    const auto& answer = angle ? answers_.angle_unit : answers_.unit;
    const auto comment = unit_in_comments(angle);
    const std::string option = angle ? "--angle-unit" : "--unit";
    std::string unit = header, said_by = "line " + std::to_string(layout_.header_line);
    if (answer) {
      unit = *answer;
      said_by = option;
    } else if (header.empty() && comment) {
      unit = comment->first;
      said_by = "line " + std::to_string(comment->second);
    }
    if (unit.empty())
      ask_for(source_, std::string("the unit of its ") + (angle ? "angles" : "lengths"),
              option + (angle ? " gon, deg or rad" : " mm, m or inch"));
    const auto si = angle ? angle_unit(unit) : length_unit(unit);
    if (!si)
      throw InputError({source_.path, layout_.header_line},
                       "\"" + printable(unit) + "\" is not a unit of " + (angle ? "an angle" : "a length"),
                       "give " + option + (angle ? " gon, deg or rad" : " mm, m or inch"));
    const std::string what = angle ? "unit of the angles" : "unit of the lengths";
    const bool known = std::ranges::any_of(
        readings_.facts, [&](const ImportFact& fact) { return fact.what == what && fact.value == unit; });
    if (!known) add_fact(what, unit, said_by);
    return *si;
  }

  std::vector<double> values_of(Coordinate coordinate, bool angle) {
    const double si = unit_of(coordinate, angle);
    std::vector<double> values;
    for (const TableRow& row : layout_.rows)
      values.push_back(layout_.number(row, columns_.column.at(coordinate)) * si);
    return values;
  }

  std::vector<Eigen::Vector3d> from_cartesian() {
    std::vector<Eigen::Vector3d> points(layout_.rows.size());
    for (std::size_t k = 0; k < kCartesian.size(); ++k) {
      const std::vector<double> values = values_of(kCartesian[k], false);
      for (std::size_t row = 0; row < points.size(); ++row)
        points[row][static_cast<Eigen::Index>(k)] = values[row];
    }
    return points;
  }

  /// Answer of an option where the header's words do not decide.
  std::string decided(const std::optional<std::string>& answer, const std::string& by_header,
                      const std::string& what, const std::string& option,
                      const std::vector<std::string>& choices) {
    if (answer) require_choice(option, *answer, choices);
    const std::string value = answer.value_or(by_header);
    if (value.empty()) ask_for(source_, what, option + " " + choices[0] + " or " + choices[1]);
    add_fact(option.substr(2) + " angle", value,
             answer ? option : "line " + std::to_string(layout_.header_line));
    return value;
  }

  std::vector<Eigen::Vector3d> from_polar() {
    const HeaderWords& horizontal = columns_.words.at(Coordinate::Horizontal);
    const HeaderWords& vertical = columns_.words.at(Coordinate::Vertical);
    const std::string turns =
        decided(answers_.horizontal, horizontal.has({"azimuth", "azimut", "theta"}) ? "counterclockwise" : "",
                "in which sense the horizontal angle counts, seen from above", "--horizontal",
                {"clockwise", "counterclockwise"});
    const std::string counts =
        decided(answers_.vertical,
                vertical.has({"zenith", "zenit"}) ? "zenith"
                : vertical.has({"elevation"})     ? "elevation"
                                                  : "",
                "whether the vertical angle counts from the zenith or from the horizon", "--vertical",
                {"zenith", "elevation"});
    azimuth_ = values_of(Coordinate::Horizontal, true);
    elevation_ = values_of(Coordinate::Vertical, true);
    length_ = values_of(Coordinate::Distance, false);
    std::vector<Eigen::Vector3d> points;
    for (std::size_t row = 0; row < length_.size(); ++row) {
      if (turns == "clockwise") azimuth_[row] = -azimuth_[row];
      if (counts == "zenith")
        elevation_[row] = std::remainder(90.0 * kRadianPerDegree - elevation_[row], 360.0 * kRadianPerDegree);
      if (std::abs(elevation_[row]) > 90.0 * kRadianPerDegree)
        throw InputError({source_.path, layout_.rows[row].line},
                         "the vertical angle lies beyond the vertical",
                         "is it in the second face? bring it to the first; or is --vertical or the unit of "
                         "angles another?");
      points.push_back(length_[row] * Eigen::Vector3d(std::cos(elevation_[row]) * std::cos(azimuth_[row]),
                                                      std::cos(elevation_[row]) * std::sin(azimuth_[row]),
                                                      std::sin(elevation_[row])));
    }
    return points;
  }

  std::vector<Eigen::Vector3d> commanded_points() {
    if (!answers_.nominal)
      ask_for(source_, "where the machine was sent to",
              "--nominal FILE, commanded positions by the names of the points (name,x_mm,y_mm,z_mm)");
    const NominalPoints nominal(*answers_.nominal, answers_, machine_);
    const KinematicChain chain(machine_);
    std::vector<Eigen::Vector3d> points_w;
    std::map<AxisName, std::vector<double>> columns;
    for (const TableRow& row : layout_.rows) {
      const AxisPosition& position = nominal.of(name_of_point(row, columns_.name), {source_.path, row.line});
      points_w.push_back(chain.nominal_point_w(position, machine_.tools.at(tool_).offset));
      for (const Axis& axis : machine_.axes)
        columns[axis.name].push_back(position[index_of(axis.name)] / position_unit(axis.name).si_per_unit);
    }
    for (auto& [axis, values] : columns)
      readings_.columns.push_back({position_column(axis), std::move(values)});
    add_fact("commanded positions", std::to_string(nominal.size()) + " points", "--nominal");
    for (const auto& [axis, shift] : nominal.shift()) {
      if (shift != 0.0) add_fact(std::string(1, letter_of(axis)), shift_text(axis, shift), "--at");
    }
    return points_w;
  }

  /// Rigid motion of the list's frame onto the commanded points (Umeyama 1991, without scale).
  Eigen::Isometry3d best_fit(const std::vector<Eigen::Vector3d>& measured_s,
                             const std::vector<Eigen::Vector3d>& commanded_w) {
    const auto count = static_cast<Eigen::Index>(measured_s.size());
    if (measured_s.size() < kLeastPoints)
      fail_fit("the list has " + std::to_string(count) + " points",
               "give at least three that do not lie on one line");
    Eigen::Matrix3Xd from(3, count), to(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      from.col(i) = measured_s[static_cast<std::size_t>(i)];
      to.col(i) = commanded_w[static_cast<std::size_t>(i)];
    }
    const Eigen::Matrix3Xd centred = to.colwise() - to.rowwise().mean();
    const Eigen::Vector3d widths =
        Eigen::JacobiSVD<Eigen::Matrix3d>(centred * centred.transpose()).singularValues().cwiseSqrt();
    if (!(widths[1] > kLeastWidth * widths[0]))
      fail_fit("the commanded points lie on a line", "give at least three that do not lie on one line");
    const Eigen::Isometry3d pose(Eigen::umeyama(from, to, false));
    const double rms = std::sqrt((pose * from - to).squaredNorm() / static_cast<double>(count));
    if (!(rms < kWorstFit)) {
      fail_fit(
          "the points do not fit the commanded positions: RMS " + number_text(rms / kMetrePerMillimetre, 4) +
              " mm after the best rigid motion",
          polar_
              ? "check --horizontal, --vertical, --angle-unit, --unit, the tool and the names of the points"
              : "check --unit, the order of the coordinates, the tool and the names of the points");
    }
    add_fact("best fit to the commanded positions", "RMS " + number_text(rms / kMicro, 4) + " um",
             "the readings");
    return pose;
  }

  [[noreturn]] void fail_fit(const std::string& problem, const std::string& remedy) const {
    throw InputError({source_.path, layout_.rows.front().line}, problem, remedy);
  }

  void add_polar_readings(const Eigen::Vector3d& station_w) {
    for (const Instrument* instrument : instruments()) {
      if (readings_.instrument == nullptr && instrument->schema().traits.encoders.size() == 2)
        readings_.instrument = &instrument->schema();
    }
    std::string station;
    for (const double x : station_w)
      station += (station.empty() ? "" : ", ") + number_text(x / kMetrePerMillimetre, 9);
    readings_.keys["station_mm"] = "[" + station + "]";
    add_column("length_mm", length_, kMetrePerMillimetre);
    add_column("azimuth_deg", azimuth_, kRadianPerDegree);
    add_column("elevation_deg", elevation_, kRadianPerDegree);
    add_fact("station", station + " mm, a first guess", "best fit");
  }

  void add_column(const std::string& name, const std::vector<double>& si, double factor) {
    std::vector<double> values;
    for (const double value : si) values.push_back(value / factor);
    readings_.columns.push_back({name, std::move(values)});
  }

  void add_error_vectors(const Eigen::Isometry3d& pose_ws, const std::vector<Eigen::Vector3d>& measured_s,
                         const std::vector<Eigen::Vector3d>& commanded_w) {
    for (const Instrument* instrument : instruments()) {
      if (readings_.instrument == nullptr && instrument->schema().traits.reads_error_vectors)
        readings_.instrument = &instrument->schema();
    }
    readings_.keys["alignment"] = "\"rigid\"";
    constexpr std::array kNames = {"ex_um", "ey_um", "ez_um"};
    for (Eigen::Index k = 0; k < 3; ++k) {
      std::vector<double> values;
      for (std::size_t row = 0; row < measured_s.size(); ++row)
        values.push_back((pose_ws * measured_s[row] - commanded_w[row])[k] / kMicro);
      readings_.columns.push_back({kNames[static_cast<std::size_t>(k)], std::move(values)});
    }
  }

  const ImportSource& source_;
  const ImportAnswers& answers_;
  const Machine& machine_;
  std::size_t tool_;
  TableLayout layout_;
  PointColumns columns_;
  bool polar_ = false;
  std::vector<double> length_, azimuth_, elevation_;
  ImportedReadings readings_;
};

class TrackerPointsFormat final : public ImportFormat {
 public:
  std::string_view name() const override { return "tracker"; }
  std::string_view summary() const override {
    return "point lists of trackers: names with x, y, z, or with two angles and a distance";
  }
  bool recognises(const ImportSource& source) const override {
    try {
      const TableLayout layout = guess_table_layout(source);
      const auto numbers = std::ranges::count(layout.numeric, true);
      const bool named = numbers < static_cast<std::ptrdiff_t>(layout.numeric.size());
      if (layout.header.empty()) return named && numbers == 3;
      const PointColumns columns = point_columns(layout, {});
      const auto others = static_cast<std::ptrdiff_t>(layout.numeric.size() - columns.name.size() - 3);
      return !columns.name.empty() && others == 0 && (columns.has(kPolar) || columns.has(kCartesian));
    } catch (const InputError&) {
      return false;
    }
  }
  ImportedReadings read(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
                        std::size_t tool) const override {
    return TrackerPoints(source, answers, machine, tool).read();
  }
};

}  // namespace

const ImportFormat& tracker_points_format() {
  static const TrackerPointsFormat format;
  return format;
}

}  // namespace volcal
