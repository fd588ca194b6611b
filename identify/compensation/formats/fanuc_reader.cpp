#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "volcal/identify/compensation/formats/fanuc_pitch.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kWholeTurn = 1e-6;  // share of an interval

/// Parameters of one axis; lengths in m or rad.
struct PitchAxis {
  AxisName axis = AxisName::X;
  double reference = 0.0;      ///< machine coordinate of the reference position
  bool bidirectional = false;  ///< 3605#0
  int reference_number = 0;    ///< 3620
  int lowest = 0;              ///< 3621
  int highest = 0;             ///< 3622
  int magnification = 1;       ///< 3623
  double interval = 0.0;       ///< 3624
  double turn = 0.0;           ///< 3625; 0 = the axis does not turn round
  double shift = 0.0;          ///< of the reference position, rad
  int lowest_negative = 0;     ///< 3626
  int reference_amount = 0;    ///< 3627, detection units
};

using PitchValues = std::map<int, int>;  ///< by number of the point

class PitchReader {
 public:
  explicit PitchReader(const TableFile& file) : lines_(file) {}

  CompensationTables read() {
    read_head();
    read_parameters();
    read_values();
    CompensationTables tables;
    for (const auto& [axis, pitch] : axes_) tables.terms.push_back(term_of(checked(pitch)));
    return tables;
  }

 private:
  bool next_row() {
    while (lines_.advance_to_content()) {
      words_ = words_of(lines_.current());
      if (words_[0].front() != ';') return true;
    }
    return false;
  }

  /// Whether the second word is the first of two.
  bool either(std::string_view first, std::string_view second) {
    if (words_[1] != first && words_[1] != second)
      lines_.fail(fmt::format("{} is neither {} nor {}", words_[0], first, second), "write one of them");
    return words_[1] == first;
  }

  void read_head() {
    while (next_row()) {
      if (words_.size() != 2) break;
      if (words_[0] == "VALUES") {
        head_.sign = either("COMPENSATIONS", "ERRORS") ? 1.0 : -1.0;
      } else if (words_[0] == "OUTPUT") {
        head_.output = either("EVEN", "MIDDLE") ? PitchOutput::Even : PitchOutput::Middle;
      } else if (words_[0] == "DETECTION_UNIT_UM") {
        head_.unit = lines_.number(words_[1], "the detection unit") * kMetrePerMicrometre;
      } else if (words_[0] == "DETECTION_UNIT_DEG") {
        head_.rotary_unit = lines_.number(words_[1], "the detection unit") * kRadianPerDegree;
      } else if (words_[0] == "LARGEST_VALUE") {
        head_.largest = lines_.integer(words_[1], "the largest value");
      } else if (words_[0] == "REFERENCE_AMOUNT") {
        head_.reference_negative = either("NEGATIVE", "POSITIVE");
        direction_given_ = true;
      } else {
        break;
      }
    }
    if (trimmed_text(lines_.current()) != "PARAMETER AXIS VALUE")
      lines_.fail("the line PARAMETER AXIS VALUE is missing", "write the tables again");
    if (head_.sign == 0.0 || !(head_.unit > 0.0) || head_.largest < 1 || head_.largest > kWidestPitchValue)
      lines_.fail("VALUES, DETECTION_UNIT_UM or LARGEST_VALUE is missing or out of range",
                  "write them above the parameters");
  }

  void read_parameters() {
    while (next_row()) {
      if (trimmed_text(lines_.current()) == kPitchRowsHeader) return;
      const auto axis =
          words_.size() == 3 && words_[1].size() == 1 ? axis_from_letter(words_[1][0]) : std::nullopt;
      if (!axis || is_parallel(*axis))
        lines_.fail("the line is not a parameter of an axis", "write number, letter of the axis, value");
      const std::string key = std::string(words_[0]) + letter_of(*axis);
      if (!seen_.insert(key).second)
        lines_.fail("the parameter is given a second time", "delete one of the lines");
      axes_[*axis].axis = *axis;
      set_parameter(axes_[*axis]);
      places_[*axis] = lines_.place();
    }
    lines_.fail(fmt::format("the line {} is missing", kPitchRowsHeader), "write the tables again");
  }

  void set_parameter(PitchAxis& pitch) {
    const std::map<std::string_view, int PitchAxis::*> whole = {
        {"3620", &PitchAxis::reference_number}, {"3621", &PitchAxis::lowest},
        {"3622", &PitchAxis::highest},          {"3623", &PitchAxis::magnification},
        {"3626", &PitchAxis::lowest_negative},  {"3627", &PitchAxis::reference_amount}};
    const auto found = whole.find(words_[0]);
    if (found != whole.end()) {
      pitch.*found->second = lines_.integer(words_[2], "the parameter");
    } else if (words_[0] == "REFERENCE") {
      pitch.reference = lines_.number(words_[2], "the reference position") * pitch_length(pitch.axis);
    } else if (words_[0] == "3624") {
      pitch.interval = lines_.number(words_[2], "the interval") * pitch_length(pitch.axis);
    } else if (words_[0] == "3625" && is_rotary(pitch.axis)) {
      pitch.turn = lines_.number(words_[2], "the travel of a turn") * kRadianPerDegree;
    } else if (words_[0] == "SHIFT" && is_rotary(pitch.axis)) {
      pitch.shift = lines_.number(words_[2], "the shift") * kRadianPerDegree;
    } else if (words_[0] == "3605#0") {
      pitch.bidirectional = lines_.integer(words_[2], "the bit") == 1;
    } else {
      lines_.fail("the parameter is not read here",
                  "there are 3605#0, 3620 to 3624, 3626, 3627, REFERENCE; of rotary axes 3625 and SHIFT");
    }
  }

  void read_values() {
    while (next_row()) {
      if (words_.size() != 2)
        lines_.fail("the row is not a number and a value", "complete or delete the row");
      const int number = lines_.integer(words_[0], "the number");
      const int value = lines_.integer(words_[1], "the value");
      if (number < 0 || number > kLargestPitchNumber)
        lines_.fail("the point number is out of range",
                    fmt::format("numbers go from 0 to {}", kLargestPitchNumber));
      if (std::abs(value) > head_.largest)
        lines_.fail(fmt::format("the value is beyond {}", head_.largest), "write the tables again");
      if (!values_.emplace(number, value).second)
        lines_.fail("the point is given a second time", "delete one of the rows");
    }
    if (values_.empty()) lines_.fail("no point has a value", "write the tables again");
  }

  [[noreturn]] void fail_axis(AxisName axis, const std::string& problem, const std::string& remedy) const {
    throw InputError(places_.at(axis), fmt::format("axis {}: {}", letter_of(axis), problem), remedy);
  }

  bool given(std::string_view parameter, AxisName axis) const {
    return seen_.contains(std::string(parameter) + letter_of(axis));
  }

  /// Of an axis that turns round: its points are one turn, which the values lead back from.
  void check_turn(const PitchAxis& pitch) const {
    const double intervals = pitch.turn / pitch.interval;
    if (pitch.turn < 0.0 || std::abs(intervals - (pitch.highest - pitch.lowest)) > kWholeTurn ||
        pitch.reference_number != pitch.lowest)
      fail_axis(pitch.axis, "3620 to 3625 are not a turn from the reference position",
                "write 3620 = 3621, and 3622 as many points above it as a turn (3625) has intervals (3624)");
    for (const int lowest : {pitch.lowest, pitch.bidirectional ? pitch.lowest_negative : pitch.lowest}) {
      int sum = 0;
      for (int number = lowest + 1; number <= lowest + pitch.highest - pitch.lowest; ++number) {
        const auto value = values_.find(number);
        sum += value == values_.end() ? 0 : value->second;
      }
      if (sum != 0)
        fail_axis(pitch.axis, "the values of a turn do not add up to 0",
                  "write the tables again: the error would grow from turn to turn");
    }
  }

  void check_directions(const PitchAxis& pitch) const {
    if (!given("3626", pitch.axis) || !given("3627", pitch.axis) || !direction_given_)
      fail_axis(pitch.axis, "3626, 3627 or REFERENCE_AMOUNT is missing",
                "both directions (3605#0 = 1) need them");
    if (pitch.lowest_negative < 0 || pitch.lowest_negative > kLargestPitchNumber ||
        std::abs(pitch.reference_amount) > kLargestReferenceAmount)
      fail_axis(pitch.axis, "3626 or 3627 is out of range", "write the tables again");
  }

  PitchAxis checked(const PitchAxis& pitch) const {
    for (const char* parameter : {"REFERENCE", "3605#0", "3620", "3621", "3622", "3623", "3624"}) {
      if (!given(parameter, pitch.axis))
        fail_axis(pitch.axis, std::string(parameter) + " is missing", "every axis needs it");
    }
    const bool ordered = pitch.lowest >= 0 && pitch.lowest <= pitch.highest &&
                         pitch.highest <= kLargestPitchNumber && pitch.reference_number >= pitch.lowest - 1 &&
                         pitch.reference_number <= pitch.highest;
    if (!ordered)
      fail_axis(pitch.axis, "3620, 3621 and 3622 are out of order", "the reference lies from 3621 to 3622");
    if (pitch.highest - pitch.lowest >= kMostPitchPoints)
      fail_axis(pitch.axis, "more than 128 points", "give a larger interval");
    if (pitch.magnification < 1 || pitch.magnification > kLargestMagnification || !(pitch.interval > 0.0))
      fail_axis(pitch.axis, "3623 or 3624 is out of range", "3623 is 1 to 100, 3624 above 0");
    if (is_rotary(pitch.axis) && !(head_.rotary_unit > 0.0))
      fail_axis(pitch.axis, "DETECTION_UNIT_DEG is missing or out of range", "write it above the parameters");
    if (pitch.bidirectional) check_directions(pitch);
    if (pitch.turn != 0.0) check_turn(pitch);
    return pitch;
  }

  /// Amounts at the points from the one before `lowest`, m: 0 at the reference position.
  std::vector<double> amounts(const PitchAxis& pitch, int lowest) const {
    const int reference = lowest + pitch.reference_number - pitch.lowest;
    const int highest = lowest + pitch.highest - pitch.lowest;
    std::vector<int> sums = {0};
    for (int number = lowest; number <= highest; ++number) {
      const auto value = values_.find(number);
      if (value == values_.end())
        throw InputError(lines_.place(), fmt::format("point {} has no value", number),
                         "give every point from 3621 to 3622, and as many from 3626");
      sums.push_back(sums.back() + value->second);
    }
    const int at_reference = *(sums.begin() + (reference - lowest + 1));
    std::vector<double> result(sums.size());
    std::ranges::transform(sums, result.begin(), [&](int sum) {
      return head_.sign * head_.unit_of(pitch.axis) * pitch.magnification * (sum - at_reference);
    });
    return result;
  }

  CorrectionTerm term_of(const PitchAxis& pitch) const {
    AxisTable table{.input = pitch.axis, .position = {}, .forward = {}, .backward = {}};
    table.forward = amounts(pitch, pitch.lowest);
    table.backward = pitch.bidirectional ? amounts(pitch, pitch.lowest_negative) : table.forward;
    auto& moved = head_.reference_negative ? table.backward : table.forward;
    for (double& amount : moved)
      amount += pitch.bidirectional ? head_.sign * head_.unit_of(pitch.axis) * pitch.reference_amount : 0.0;
    for (int i = 0; i < static_cast<int>(table.forward.size()); ++i)
      table.position.push_back(pitch.reference +
                               (pitch.lowest - 1 + i - pitch.reference_number) * pitch.interval);
    for (auto* const column : {&table.forward, &table.backward}) {
      for (double& amount : *column) amount += pitch.shift;
    }
    if (pitch.turn > 0.0) keep_one_turn(table);
    if (head_.output == PitchOutput::Even) return axis_term(pitch.axis, std::move(table));
    return stepped_term(pitch, std::move(table));
  }

  /// The point before the lowest is that of the turn before.
  static void keep_one_turn(AxisTable& table) {
    for (auto* const column : {&table.position, &table.forward, &table.backward})
      column->erase(column->begin());
    table.beyond = BeyondEnds::Repeat;
  }

  /// The amount of the nearest point.
  static CorrectionTerm stepped_term(const PitchAxis& pitch, AxisTable table) {
    const std::size_t axis = index_of(pitch.axis);
    return [axis, linear = axis_term(pitch.axis, std::move(table)), reference = pitch.reference,
            interval = pitch.interval](const AxisPosition& at, const ApproachDirection& direction) {
      AxisPosition nearest = at;
      nearest[axis] = reference + std::floor((at[axis] - reference) / interval + 0.5) * interval;
      return linear(nearest, direction);
    };
  }

  TableLines lines_;
  std::vector<std::string_view> words_;
  PitchHead head_;
  bool direction_given_ = false;
  std::map<AxisName, PitchAxis> axes_;
  std::map<AxisName, SourcePlace> places_;
  std::set<std::string> seen_;
  PitchValues values_;
};

}  // namespace

double pitch_length(AxisName axis) { return is_rotary(axis) ? kRadianPerDegree : kMetrePerMillimetre; }

CompensationTables read_pitch(std::span<const TableFile> files) {
  return PitchReader(file_named(files, kPitchFile)).read();
}

}  // namespace volcal
