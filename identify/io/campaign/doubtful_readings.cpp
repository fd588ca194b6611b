#include "volcal/identify/io/campaign/doubtful_readings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "volcal/identify/io/campaign/doubtful_angles.h"
#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/numeric/content_hash.h"
#include "volcal/identify/standards/approach.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/recorded_moves.h"

namespace volcal {
namespace {

constexpr std::size_t kFewestRepeats = 5;
constexpr double kShareOfRepeats = 0.3;
constexpr double kFineDigits = 0.01;  // of the stated noise: equal by chance is one of 300 readings, or fewer
constexpr double kRoundingOfDigits = 1e-3;
constexpr std::size_t kFewestMoves = 5;
constexpr double kShareAgainstOrder = 0.8;
constexpr double kBeyondChance = 3.0;      // standard deviations of moves against directions that are drawn
constexpr double kSlowestStep_s = 1000.0;  // median between readings, over more than a day
constexpr double kDay_s = 86400.0;
constexpr double kFastest = 5.0;  // m/s between readings

std::int64_t count(std::size_t number) { return static_cast<std::int64_t>(number); }

/// Whether most readings have digits below a hundredth of their stated noise, so that those that agree to the
/// last digit can hardly be measurements of their own.
bool has_fine_digits(const Setup& setup) {
  const double noise = setup.noise.number("constant").value_or(0.0);
  if (!(noise > 0.0) || setup.readings.value.empty()) return false;
  const double digit = std::pow(10.0, std::floor(std::log10(kFineDigits * noise)));
  const std::vector<double>& values = setup.readings.value.front();
  const auto fine = std::ranges::count_if(values, [&](double value) {
    const double digits = value / digit;
    return std::abs(digits - std::round(digits)) > kRoundingOfDigits;
  });
  return 2 * static_cast<std::size_t>(fine) > values.size();
}

/// What was read of a row; `of_time`: with its time, line, run and direction of approach.
std::vector<double> values_of_row(const Readings& readings, std::size_t row, bool of_time) {
  std::vector<double> all;
  for (const auto& column : readings.position) {
    if (!column.empty()) all.push_back(column[row]);
  }
  for (const auto& column : readings.value) all.push_back(column[row]);
  for (const auto& column : readings.given) all.push_back(column[row]);
  if (!of_time) return all;
  for (const auto& column : readings.direction) {
    if (!column.empty()) all.push_back(column[row]);
  }
  if (!readings.time.empty()) all.push_back(readings.time[row]);
  if (!readings.line.empty()) all.push_back(readings.line[row]);
  if (!readings.run.empty()) all.push_back(readings.run[row]);
  return all;
}

struct Repeats {
  std::size_t count = 0;
  std::size_t first = 0, second = 0;  ///< an example
  bool many(std::size_t rows) const {
    return count >= kFewestRepeats &&
           static_cast<double>(count) >= kShareOfRepeats * static_cast<double>(rows);
  }
};

std::uint64_t hash_of(const std::vector<double>& values) {
  ContentHash hash;
  for (const double value : values) hash.add(value + 0.0);  // -0 equals 0
  return hash.value();
}

/// By hashes of the rows: a file may have a million.
Repeats repeats_in(const Readings& readings, bool of_time) {
  std::unordered_map<std::uint64_t, std::size_t> first;
  first.reserve(readings.size());
  Repeats repeats;
  for (std::size_t row = 0; row < readings.size(); ++row) {
    const std::vector<double> values = values_of_row(readings, row, of_time);
    const auto [known, fresh] = first.emplace(hash_of(values), row);
    if (fresh || values != values_of_row(readings, known->second, of_time)) continue;
    if (repeats.count++ == 0) repeats = {1, known->second, row};
  }
  return repeats;
}

/// A time is read once: a row that repeats it is a copy. Without times equal readings may be chance, and so
/// are a few with other times.
std::optional<Finding> repeated_rows(const Setup& setup) {
  const Readings& readings = setup.readings;
  Repeats repeats = repeats_in(readings, true);
  bool at_other_times = false;
  if (!repeats.many(readings.size()) && (repeats.count == 0 || readings.time.empty())) {
    if (!has_fine_digits(setup)) return std::nullopt;
    repeats = repeats_in(readings, false);
    at_other_times = true;
    if (!repeats.many(readings.size())) return std::nullopt;
  }
  return Finding{FindingCode::ReadingsRowsRepeated,
                 {{"repeats", count(repeats.count)},
                  {"rows", count(readings.size())},
                  {"line", readings.source_line[repeats.second]},
                  {"first_line", readings.source_line[repeats.first]},
                  {"at_other_times", at_other_times}}};
}

/// Targets that scatter about a grid and approaches from one side hide the order of the moves: half of them
/// may go against directions that are right, hardly more than half.
bool are_against(std::size_t against, std::size_t moves) {
  if (moves < kFewestMoves) return false;
  const auto all = static_cast<double>(moves), some = static_cast<double>(against);
  return some >= kShareAgainstOrder * all || some - 0.5 * all > kBeyondChance * 0.5 * std::sqrt(all);
}

/// Recorded modulo a turn, half a turn and more may have been gone round the other way.
bool turned_either_way(const RecordedMoves& moves, double difference, std::size_t before, std::size_t now) {
  return moves.modulo_a_turn() &&
         (moves.either_way(before, now) || (moves.between(before, now) > 0.0) != (difference > 0.0));
}

/// Stated directions against the moves between neighbouring readings of a pass.
std::optional<Finding> against_order(const Machine& machine, const Readings& readings, AxisName axis) {
  const auto& stated = readings.direction[index_of(axis)];
  const auto& position = readings.position[index_of(axis)];
  if (stated.empty() || position.empty()) return std::nullopt;
  const RecordedMoves recorded(machine, readings, axis);
  std::size_t moves = 0, against = 0;
  for (const Pass& pass : passes(readings)) {
    for (std::size_t k = 1; k < pass.rows.size(); ++k) {
      const std::size_t now = pass.rows[k], before = pass.rows[k - 1];
      const double move = position[now] - position[before];
      const int direction = stated[now];
      if (direction == 0 || std::abs(move) <= kStandingRange ||
          turned_either_way(recorded, move, before, now))
        continue;
      ++moves;
      against += (move > 0.0) == (direction > 0) ? 0U : 1U;
    }
  }
  if (!are_against(against, moves)) return std::nullopt;
  return Finding{FindingCode::ReadingsAgainstDirection,
                 {{"against", count(against)},
                  {"moves", count(moves)},
                  {"axis", std::string(1, letter_of(axis))},
                  {"column", direction_column(axis)}}};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Distance along the linear axes between two rows.
double travelled(const Readings& readings, std::size_t from, std::size_t to) {
  double squares = 0.0;
  for (const AxisName axis : kAllAxes) {
    const auto& position = readings.position[index_of(axis)];
    if (is_rotary(axis) || position.empty()) continue;
    squares += std::pow(position[to] - position[from], 2);
  }
  return std::sqrt(squares);
}

std::optional<Finding> doubtful_time(const Readings& readings) {
  const auto& time = readings.time;
  if (time.size() < 3) return std::nullopt;
  std::vector<double> steps, speeds;
  for (std::size_t row = 1; row < time.size(); ++row) {
    const double step = time[row] - time[row - 1];
    if (!(step > 0.0)) continue;
    steps.push_back(step);
    const double way = travelled(readings, row - 1, row);
    if (way > kSamePosition) speeds.push_back(way / step);
  }
  if (steps.empty()) return std::nullopt;
  const auto [first, last] = std::ranges::minmax(time);
  const double step = median(steps);
  if (step >= kSlowestStep_s && last - first > kDay_s) {
    return Finding{FindingCode::ReadingsTimesFarApart,
                   {{"step", FindingNumber{step, "s"}}, {"span", FindingNumber{last - first, "s"}}}};
  }
  if (speeds.empty() || median(speeds) <= kFastest) return std::nullopt;
  return Finding{FindingCode::ReadingsMovesTooFast, {{"speed", FindingNumber{median(speeds), "m/s"}}}};
}

}  // namespace

std::vector<Finding> doubts_of(const Setup& setup, const Machine& machine) {
  std::vector<Finding> doubts;
  const auto add = [&](std::optional<Finding> doubt) {
    if (doubt) doubts.push_back(*std::move(doubt));
  };
  add(repeated_rows(setup));
  for (const Axis& axis : machine.axes) add(against_order(machine, setup.readings, axis.name));
  add(doubtful_time(setup.readings));
  add(doubtful_angles(setup, machine));
  return doubts;
}

bool same_readings(const Setup& one, const Setup& other) {
  const Readings &a = one.readings, &b = other.readings;
  return one.instrument == other.instrument && one.tool == other.tool && a.size() > 1 &&
         a.column_set == b.column_set && a.value == b.value && a.given == b.given &&
         a.position == b.position &&
         (a.time == b.time || (a.size() >= kFewestRepeats && has_fine_digits(one)));
}

}  // namespace volcal
