#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/compensation/formats/fanuc_pitch.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& fanuc_format();

namespace {

constexpr std::array<TableSetting, 8> kPitchSettings = {
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
     {"detection_unit_um", "detection unit of linear axes, um", "1", "1"},
     {"detection_unit_deg", "detection unit of rotary axes, deg", "0.001", "0.001"},
     {"largest_value", "largest value of a point: 7, or up to 127 where the control has the wider range", "7",
      "7"},
     {"first_number", "number of the first compensation point, 0 to 1023", "0", "0"}}};

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
  head.rotary_unit = table_setting_number(kPitchSettings, options, "detection_unit_deg") * kRadianPerDegree;
  if (!(head.rotary_unit > 0.0))
    throw InputError({}, "--set detection_unit_deg must be above 0",
                     "give the detection unit, usually 0.001");
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

/// One axis as it is sampled, values as the control takes them: sign applied, m or rad.
struct PitchCurve {
  AxisName axis = AxisName::X;
  double home = 0.0;
  double interval = 0.0;
  std::size_t reference = 0;  ///< position of the reference
  std::vector<double> towards_plus, towards_minus;
  double zero_plus = 0.0, zero_minus = 0.0;  ///< taken off: of one direction its amount at the reference,
  int reference_amount = 0;                  ///< of the other that and what 3627 adds, in detection units
  bool turns_round = false;
};

/// Throws InputError for a reversal out of range.
void set_zeros(PitchCurve& curve, const PitchHead& head) {
  const double plus = curve.towards_plus[curve.reference], minus = curve.towards_minus[curve.reference];
  const double unit = head.unit_of(curve.axis);
  const double amount = std::round((head.reference_negative ? minus - plus : plus - minus) / unit);
  if (std::abs(amount) > kLargestReferenceAmount)
    throw InputError({}, fmt::format("fanuc: the reversal of axis {} is out of range", letter_of(curve.axis)),
                     "give --set directions=mean");
  curve.reference_amount = static_cast<int>(amount);
  curve.zero_plus = head.reference_negative ? plus : minus + amount * unit;
  curve.zero_minus = head.reference_negative ? plus + amount * unit : minus;
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

/// Positions with the reference position among them: from it to a turn above it, or over the travel.
std::vector<double> rotary_pitch_positions(const AxisTable& table, const Axis& axis, double interval) {
  const bool turns_round = table.beyond == BeyondEnds::Repeat;
  const auto steps = [interval](double length) {
    constexpr double kSamePoint = 1e-9;  // of an interval
    return static_cast<int>(std::ceil(length / interval - kSamePoint));
  };
  const int below = turns_round ? 0 : steps(axis.home - table.position.front());
  const int above =
      turns_round ? static_cast<int>(table.position.size()) - 1 : steps(table.position.back() - axis.home);
  std::vector<double> positions;
  for (int i = -below; i <= above; ++i) positions.push_back(axis.home + i * interval);
  return positions;
}

PitchCurve rotary_pitch_curve(const SampledTable& sampled, const Axis& axis, const PitchHead& head,
                              bool both) {
  const double interval = sampled.table.position[1] - sampled.table.position[0];
  SampledTable moved = sampled;
  moved.table.position = rotary_pitch_positions(sampled.table, axis, interval);
  for (const int towards : {1, -1}) {
    std::vector<double>& column = towards > 0 ? moved.table.forward : moved.table.backward;
    column.clear();
    for (const double position : moved.table.position) {
      AxisPosition at{};
      at[index_of(axis.name)] = position;
      ApproachDirection direction{};
      direction[index_of(axis.name)] = static_cast<std::int8_t>(towards);
      column.push_back(sampled.table.value(at, direction));
    }
    if (sampled.table.beyond == BeyondEnds::Repeat) column.back() = column.front();
  }
  PitchCurve curve = pitch_curve(moved, axis, interval, head, both);
  curve.turns_round = sampled.table.beyond == BeyondEnds::Repeat;
  return curve;
}

std::vector<SampledTable> rotary_pitch_tables(const FitResult& result, const TableFormatOptions& options) {
  if (!options.type.has(CompensationPart::RotaryPositioning)) return {};
  return sample_rotary_positioning(fanuc_format(), result, options);
}

std::vector<int> increments_plus(const PitchCurve& curve, double step) {
  return increments_of(curve.towards_plus, curve.zero_plus, curve.reference, step);
}

std::vector<int> increments_minus(const PitchCurve& curve, double step) {
  return increments_of(curve.towards_minus, curve.zero_minus, curve.reference, step);
}

int magnification_of(const PitchCurve& curve, const PitchHead& head) {
  for (int magnification = 1; magnification <= kLargestMagnification; ++magnification) {
    const double step = head.unit_of(curve.axis) * magnification;
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
    const double step = head_.unit_of(curve.axis) * magnification;
    auto plus = increments_plus(curve, step), minus = increments_minus(curve, step);
    if (curve.turns_round) {
      plus.front() = plus.back();
      minus.front() = minus.back();
    }
    const bool both = plus != minus || curve.reference_amount != 0;
    const char letter = letter_of(curve.axis);
    const double length = pitch_length(curve.axis);
    const int count = static_cast<int>(plus.size());
    parameters_ += fmt::format(
        "REFERENCE {0} {1:.4f}\n3605#0 {0} {2}\n3620 {0} {3}\n3621 {0} {4}\n3622 {0} {5}\n"
        "3623 {0} {6}\n3624 {0} {7:.4f}\n",
        letter, without_negative_zero(curve.home) / length, both ? 1 : 0,
        next_ + static_cast<int>(curve.reference), next_, next_ + count - 1, magnification,
        curve.interval / length);
    if (curve.turns_round) parameters_ += fmt::format("3625 {} 360.0000\n", letter);
    if (is_rotary(curve.axis))
      parameters_ += fmt::format("SHIFT {} {:.8f}\n", letter,
                                 without_negative_zero(head_.sign * shift_of(curve)) / length);
    rotary_ = rotary_ || is_rotary(curve.axis);
    add_values(plus);
    if (!both) return;
    parameters_ += fmt::format("3626 {0} {1}\n3627 {0} {2}\n", letter, next_, curve.reference_amount);
    add_values(minus);
    bidirectional_ = true;
  }

  bool bidirectional() const { return bidirectional_; }
  std::string text() const {
    std::string head = fmt::format(
        "; For the parameter and pitch error screens, mm and deg\nVALUES {}\nOUTPUT {}\n"
        "DETECTION_UNIT_UM {:g}\nLARGEST_VALUE {}\n",
        head_.sign > 0.0 ? "COMPENSATIONS" : "ERRORS", head_.output == PitchOutput::Even ? "EVEN" : "MIDDLE",
        head_.unit / kMetrePerMicrometre, head_.largest);
    if (rotary_) head += fmt::format("DETECTION_UNIT_DEG {:g}\n", head_.rotary_unit / kRadianPerDegree);
    if (bidirectional_)
      head += fmt::format("REFERENCE_AMOUNT {}\n", head_.reference_negative ? "NEGATIVE" : "POSITIVE");
    return head + "PARAMETER AXIS VALUE\n" + parameters_ + std::string(kPitchRowsHeader) + "\n" + values_;
  }

 private:
  /// What both directions have in common at the reference position, where the table is 0.
  double shift_of(const PitchCurve& curve) const {
    return head_.reference_negative ? curve.zero_plus : curve.zero_minus;
  }

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
  bool rotary_ = false;
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
  for (const SampledTable& sampled : rotary_pitch_tables(result, options))
    writer.add(rotary_pitch_curve(sampled, result.machine.axis(sampled.output), head, both));
  if (writer.bidirectional() && amount.empty())
    throw InputError({}, "reference_amount is not confirmed publicly and must be given",
                     "find it out on the machine (--list says how), then give --set "
                     "reference_amount=negative or =positive, or --set directions=mean");
  return {{std::string(kPitchFile), writer.text()}};
}

}  // namespace

const TableFormat& fanuc_format() {
  static const TableFormat format = {
      .name = "fanuc",
      .summary =
          "FANUC stored pitch error compensation: parameters 3605#0, 3620 to 3624, 3626, 3627 and increments "
          "of the compensation points, of linear axes and of rotary axes (3625), as rows of the control's "
          "screens",
      .source =
          "FANUC, Series 0i-PB Parameter Manual B-63980EN/01, page 100: the value of point n belongs to the "
          "interval from n-1 to n and is a difference, the amount is 0 at the reference position, example 2: "
          "the values of a turn of a rotary axis add up to 0; Technical "
          "Report A-77810E edition 03, Bidirectional pitch error compensation function, page 2: "
          "parameters",
      .verified =
          "read back by volcal; not tried on a controller. The sign, where within an interval a value is put "
          "out and the direction of 3627 are NOT confirmed: they must be given. Neither confirmed: that "
          "values reach 7, numbers 1023, 3623 100 and a table 128 points, that differences of the negative "
          "direction count from - to +, that 3623 does not multiply 3627. The text of data files is not "
          "public: the rows are to be entered on the screens. Of rotary axes the manual's example has one "
          "direction; an axis that travels part of a turn is written as a linear one, in deg",
      .supported = CompensationPart::Positioning,
      .rotary = CompensationPart::RotaryPositioning,
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
