#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& fanuc_format();

namespace {

constexpr std::string_view kPitchFile = "pitch_error.txt";
constexpr std::string_view kPitchRowsHeader = "NUMBER VALUE";
constexpr int kMostPitchPoints = 128;           // of one axis and direction
constexpr int kLargestPitchNumber = 1023;       // of a point
constexpr int kLargestMagnification = 100;      // 3623
constexpr int kWidestPitchValue = 127;          // of controls with the wider range
constexpr int kLargestReferenceAmount = 32767;  // 3627

constexpr std::array<TableSetting, 7> kPitchSettings = {
    {{"sign",
      "compensation or error: what a positive value does. Not confirmed publicly: enter one large value, "
      "move past its point towards + and look which way the axis goes; towards + means compensation",
      "", "compensation"},
     {"output",
      "even or middle: where within an interval the control puts its value out. Not confirmed publicly: "
      "enter one large value, move slowly through its interval under an indicator; spread over the interval "
      "means even, at once in its middle means middle; where it is neither these tables do not fit",
      "", "even"},
     {"directions",
      "both: bidirectional compensation (3605#0 = 1, an option of the control) where there is reversal; "
      "mean: one value for both directions",
      "both", "both"},
     {"reference_amount",
      "negative or positive: the direction of travel in which parameter 3627 holds the amount at the "
      "reference position, in detection units; the amount in the other direction is 0 there. Not confirmed "
      "publicly; asked for where there is reversal: enter 3627 alone and look from which side the reference "
      "position is off",
      "", "negative"},
     {"detection_unit_um", "detection unit of the axes, um", "1", "1"},
     {"largest_value", "largest value of a point: 7, or up to 127 where the control has the wider range", "7",
      "7"},
     {"first_number", "number of the first compensation point, 0 to 1023", "0", "0"}}};

// ---- What a file says

enum class PitchOutput { Even, Middle };

struct PitchHead {
  double sign = 0.0;  ///< +1 where values are compensations, -1 where they are errors
  PitchOutput output = PitchOutput::Even;
  double unit = 0.0;  ///< detection unit, m
  int largest = 0;
  bool reference_negative = true;  ///< 3627 is for travel in the negative direction
};

/// Parameters of one axis; lengths in m.
struct PitchAxis {
  AxisName axis = AxisName::X;
  double reference = 0.0;      ///< machine coordinate of the reference position
  bool bidirectional = false;  ///< 3605#0
  int reference_number = 0;    ///< 3620
  int lowest = 0;              ///< 3621
  int highest = 0;             ///< 3622
  int magnification = 1;       ///< 3623
  double interval = 0.0;       ///< 3624
  int lowest_negative = 0;     ///< 3626
  int reference_amount = 0;    ///< 3627, detection units
};

using PitchValues = std::map<int, int>;  ///< by number of the point

// ---- Writing

int whole_setting(const TableFormatOptions& options, std::string_view name, int least, int most) {
  const double value = table_setting_number(kPitchSettings, options, name);
  if (value != std::floor(value) || value < least || value > most)
    throw InputError({}, fmt::format("--set {}={:g}", name, value),
                     fmt::format("give a whole number from {} to {}", least, most));
  return static_cast<int>(value);
}

PitchHead pitch_head(const TableFormatOptions& options) {
  PitchHead head;
  head.sign = is_first_word(kPitchSettings, options, "sign", "compensation", "error") ? 1.0 : -1.0;
  head.output = is_first_word(kPitchSettings, options, "output", "even", "middle") ? PitchOutput::Even
                                                                                   : PitchOutput::Middle;
  head.unit = table_setting_number(kPitchSettings, options, "detection_unit_um") * kMetrePerMicrometre;
  if (!(head.unit > 0.0))
    throw InputError({}, fmt::format("--set detection_unit_um={:g}", head.unit / kMetrePerMicrometre),
                     "give the detection unit in um, usually 1");
  head.largest = whole_setting(options, "largest_value", 1, kWidestPitchValue);
  return head;
}

/// The curve of one direction less `zero` in whole steps, 0 at the reference position, then its differences:
/// sums of them are off by half a step at most, however many they are. The first has nothing before it.
std::vector<int> increments_of(const std::vector<double>& curve, double zero, std::size_t reference,
                               double step) {
  std::vector<int> increments = {0};
  const auto rounded = [&](std::size_t i) {
    return i == reference ? 0 : static_cast<int>(std::lround((curve[i] - zero) / step));
  };
  for (std::size_t i = 1; i < curve.size(); ++i) increments.push_back(rounded(i) - rounded(i - 1));
  return increments;
}

bool fits(const std::vector<int>& increments, int largest) {
  return std::ranges::all_of(increments, [&](int value) { return std::abs(value) <= largest; });
}

/// One axis as it is sampled, values as the control takes them: sign applied, m.
struct PitchCurve {
  AxisName axis = AxisName::X;
  double home = 0.0;
  double interval = 0.0;
  std::size_t reference = 0;  ///< position of the reference
  std::vector<double> towards_plus, towards_minus;
  double zero_plus = 0.0, zero_minus = 0.0;  ///< taken off: of one direction its amount at the reference,
  int reference_amount = 0;                  ///< of the other that and what 3627 adds, in detection units
};

/// Throws InputError for a reversal out of range.
void set_zeros(PitchCurve& curve, const PitchHead& head) {
  const double plus = curve.towards_plus[curve.reference], minus = curve.towards_minus[curve.reference];
  const double amount = std::round((head.reference_negative ? minus - plus : plus - minus) / head.unit);
  if (std::abs(amount) > kLargestReferenceAmount)
    throw InputError({}, fmt::format("fanuc: the reversal of axis {} is out of range", letter_of(curve.axis)),
                     "give --set directions=mean");
  curve.reference_amount = static_cast<int>(amount);
  curve.zero_plus = head.reference_negative ? plus : minus + amount * head.unit;
  curve.zero_minus = head.reference_negative ? plus + amount * head.unit : minus;
}

PitchCurve pitch_curve(const SampledTable& sampled, const Axis& axis, double interval, const PitchHead& head,
                       bool both) {
  PitchCurve curve;
  curve.axis = axis.name;
  curve.home = axis.home;
  curve.interval = interval;
  const AxisTable& table = sampled.table;
  curve.reference = static_cast<std::size_t>(std::lround((axis.home - table.position.front()) / interval));
  for (std::size_t i = 0; i < table.position.size(); ++i) {
    const double mean = 0.5 * (table.forward[i] + table.backward[i]);
    curve.towards_plus.push_back(head.sign * (both ? table.forward[i] : mean));
    curve.towards_minus.push_back(head.sign * (both ? table.backward[i] : mean));
  }
  set_zeros(curve, head);
  return curve;
}

std::vector<int> increments_plus(const PitchCurve& curve, double step) {
  return increments_of(curve.towards_plus, curve.zero_plus, curve.reference, step);
}

std::vector<int> increments_minus(const PitchCurve& curve, double step) {
  return increments_of(curve.towards_minus, curve.zero_minus, curve.reference, step);
}

int magnification_of(const PitchCurve& curve, const PitchHead& head) {
  for (int magnification = 1; magnification <= kLargestMagnification; ++magnification) {
    const double step = head.unit * magnification;
    if (fits(increments_plus(curve, step), head.largest) && fits(increments_minus(curve, step), head.largest))
      return magnification;
  }
  throw InputError({},
                   fmt::format("fanuc: axis {} changes by more than {} x {} detection units between points",
                               letter_of(curve.axis), head.largest, kLargestMagnification),
                   "give a smaller --step, or --set largest_value=N as the control has");
}

class PitchWriter {
 public:
  PitchWriter(const PitchHead& head, int first_number) : head_(head), next_(first_number) {}

  void add(const PitchCurve& curve) {
    const int magnification = magnification_of(curve, head_);
    const double step = head_.unit * magnification;
    const auto plus = increments_plus(curve, step), minus = increments_minus(curve, step);
    const bool both = plus != minus || curve.reference_amount != 0;
    const char letter = letter_of(curve.axis);
    const int count = static_cast<int>(plus.size());
    parameters_ += fmt::format(
        "REFERENCE {0} {1:.4f}\n3605#0 {0} {2}\n3620 {0} {3}\n3621 {0} {4}\n3622 {0} {5}\n"
        "3623 {0} {6}\n3624 {0} {7:.4f}\n",
        letter, without_negative_zero(curve.home) / kMetrePerMillimetre, both ? 1 : 0,
        next_ + static_cast<int>(curve.reference), next_, next_ + count - 1, magnification,
        curve.interval / kMetrePerMillimetre);
    add_values(plus);
    if (!both) return;
    parameters_ += fmt::format("3626 {0} {1}\n3627 {0} {2}\n", letter, next_, curve.reference_amount);
    add_values(minus);
    bidirectional_ = true;
  }

  bool bidirectional() const { return bidirectional_; }
  std::string text() const {
    std::string head = fmt::format(
        "; For the parameter and pitch error screens, mm\nVALUES {}\nOUTPUT {}\nDETECTION_UNIT_UM {:g}\n"
        "LARGEST_VALUE {}\n",
        head_.sign > 0.0 ? "COMPENSATIONS" : "ERRORS", head_.output == PitchOutput::Even ? "EVEN" : "MIDDLE",
        head_.unit / kMetrePerMicrometre, head_.largest);
    if (bidirectional_)
      head += fmt::format("REFERENCE_AMOUNT {}\n", head_.reference_negative ? "NEGATIVE" : "POSITIVE");
    return head + "PARAMETER AXIS VALUE\n" + parameters_ + std::string(kPitchRowsHeader) + "\n" + values_;
  }

 private:
  void add_values(const std::vector<int>& increments) {
    for (const int value : increments) values_ += fmt::format("{} {}\n", next_++, value);
    if (next_ - 1 > kLargestPitchNumber)
      throw InputError({},
                       fmt::format("fanuc: points up to number {} are needed, the control has {}", next_ - 1,
                                   kLargestPitchNumber),
                       "give a larger --step or a smaller --set first_number=N");
  }

  PitchHead head_;
  int next_;
  bool bidirectional_ = false;
  std::string parameters_, values_;
};

std::vector<TableFile> write_pitch(const FitResult& result, const TableFormatOptions& options) {
  PitchHead head = pitch_head(options);
  const bool both = is_first_word(kPitchSettings, options, "directions", "both", "mean");
  const std::string amount = table_setting(kPitchSettings, options, "reference_amount");
  if (!amount.empty())
    head.reference_negative =
        is_first_word(kPitchSettings, options, "reference_amount", "negative", "positive");
  PitchWriter writer(head, whole_setting(options, "first_number", 0, kLargestPitchNumber));
  for (const SampledTable& sampled : sample_axis_tables(fanuc_format(), result, options))
    writer.add(pitch_curve(sampled, result.machine.axis(sampled.output), options.step, head, both));
  if (writer.bidirectional() && amount.empty())
    throw InputError({}, "reference_amount is not confirmed publicly and must be given",
                     "find it out on the machine (--list says how), then give --set "
                     "reference_amount=negative or =positive, or --set directions=mean");
  return {{std::string(kPitchFile), writer.text()}};
}

// ---- Reading

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
      if (!axis || is_rotary(*axis))
        lines_.fail("the line is no parameter of an axis", "write number, X, Y or Z, and value");
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
      pitch.reference = lines_.number(words_[2], "the reference position") * kMetrePerMillimetre;
    } else if (words_[0] == "3624") {
      pitch.interval = lines_.number(words_[2], "the interval") * kMetrePerMillimetre;
    } else if (words_[0] == "3605#0") {
      pitch.bidirectional = lines_.integer(words_[2], "the bit") == 1;
    } else {
      lines_.fail("the parameter is not read here", "there are 3605#0, 3620 to 3624, 3626, 3627, REFERENCE");
    }
  }

  void read_values() {
    while (next_row()) {
      if (words_.size() != 2) lines_.fail("the row is no number and value", "complete or delete the row");
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
    if (pitch.bidirectional) check_directions(pitch);
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
      return head_.sign * head_.unit * pitch.magnification * (sum - at_reference);
    });
    return result;
  }

  CorrectionTerm term_of(const PitchAxis& pitch) const {
    AxisTable table{.input = pitch.axis, .position = {}, .forward = {}, .backward = {}};
    table.forward = amounts(pitch, pitch.lowest);
    table.backward = pitch.bidirectional ? amounts(pitch, pitch.lowest_negative) : table.forward;
    auto& moved = head_.reference_negative ? table.backward : table.forward;
    for (double& amount : moved)
      amount += pitch.bidirectional ? head_.sign * head_.unit * pitch.reference_amount : 0.0;
    for (int i = 0; i < static_cast<int>(table.forward.size()); ++i)
      table.position.push_back(pitch.reference +
                               (pitch.lowest - 1 + i - pitch.reference_number) * pitch.interval);
    if (head_.output == PitchOutput::Even) return axis_term(pitch.axis, std::move(table));
    return stepped_term(pitch, std::move(table));
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

CompensationTables read_pitch(std::span<const TableFile> files) {
  return PitchReader(file_named(files, kPitchFile)).read();
}

}  // namespace

const TableFormat& fanuc_format() {
  static const TableFormat format = {
      .name = "fanuc",
      .summary =
          "FANUC stored pitch error compensation: parameters 3605#0, 3620 to 3624, 3626, 3627 and increments "
          "of the compensation points, as rows of the control's screens",
      .source =
          "FANUC, Series 0i-PB Parameter Manual B-63980EN/01, page 100: the value of point n belongs to the "
          "interval from n-1 to n and is a difference, the amount is 0 at the reference position; Technical "
          "Report A-77810E edition 03, Bidirectional pitch error compensation function, page 2: "
          "parameters",
      .verified =
          "read back by volcal; not tried on a controller. The sign, where within an interval a value is put "
          "out and the direction of 3627 are NOT confirmed: they must be given. Neither confirmed: that "
          "values reach 7, numbers 1023, 3623 100 and a table 128 points, that differences of the negative "
          "direction count from - to +, that 3623 does not multiply 3627. The text of data files is not "
          "public: the rows are to be entered on the screens",
      .supported = CompensationPart::Positioning,
      .refusal =
          "stored pitch error compensation acts on its own axis only; straightness and three-dimensional "
          "error compensation are other options of the control",
      .limits = {.points_per_table = kMostPitchPoints,
                 .resolution = 1e-6,
                 .both_directions = true,
                 .equidistant = true},
      .settings = kPitchSettings,
      .write = write_pitch,
      .read = read_pitch};
  return format;
}

}  // namespace volcal
