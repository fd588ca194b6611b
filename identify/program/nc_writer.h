#pragma once
/// Writes motions into the text of their block: coordinates are replaced in place, everything else is kept.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_interpreter.h"

namespace volcal {

/// A straight motion that is to be written, or a dwell.
struct NcTarget {
  NcMotionKind kind = NcMotionKind::Rapid;            ///< not Arc
  Eigen::Vector3d command = Eigen::Vector3d::Zero();  ///< axis positions, m
  double dwell = 0.0;                                 ///< s
  double at = 0.0;  ///< place on the programmed path: index of the motion in its block + 0..1 along it
};

/// A written line with its line end; `at` as in NcTarget.
struct NcWrittenLine {
  std::string text;
  double at = 0.0;
};

/// What was added must not make a line longer than controls read; one that was so before is the user's.
/// Throws InputError.
void require_readable(std::string_view written, std::string_view original, const NcPlace& place);

/// Puts a program's header, lines of comments, above what its line `original` became: below the first % where
/// it is that.
void put_header(const std::vector<std::string>& header, std::string_view original,
                std::vector<NcWrittenLine>& written);

/// Keeps what the control that runs the written program holds: its positions, and with them its offsets.
class NcWriter {
 public:
  /// Digits behind the point of coordinates in mm and inch; at least 4 and 5.
  NcWriter(const NcSetup& setup, int decimals_mm);

  const NcState& state() const { return state_; }

  /// A block that moves nothing: copied.
  void copy(const NcStep& step, std::string_view line, const NcSetup& setup, const NcPlace& place,
            std::vector<NcWrittenLine>& lines);
  /// A block with motions; `known`: axes that may be written. Coordinates are rounded to the last digit each
  /// by itself: rounding does not add up, also under G91.
  void write(const NcStep& step, const NcSetup& setup, const NcPlace& place, const std::array<bool, 3>& known,
             std::span<const NcTarget> targets, std::vector<NcWrittenLine>& lines);

 private:
  struct AxisText {
    bool wanted = false;
    double value = 0.0;  ///< as written, in units of length
  };
  using AxisTexts = std::array<AxisText, 3>;
  /// How the block's own line is changed.
  struct FirstLine {
    std::string_view text;   ///< of the block
    int motion = kNoCode;    ///< that its coordinates belong to
    int needed = 0;          ///< G code of the target: 0 or 10
    bool has_code = false;   ///< the text holds a G code of a motion
    bool keeps_stop = true;  ///< it is the last line too
    double feed = 0.0;       ///< of this segment under G93, 0 = F stays

    std::string_view own(const NcWord& word) const { return text.substr(word.begin, word.end - word.begin); }
  };

  AxisTexts axis_texts(const NcStep& step, const NcTarget& target, bool first,
                       const std::array<bool, 3>& known, const NcPlace& place);
  void write_first(const NcBlock& block, const FirstLine& line, AxisTexts& axes, std::string& out);
  void write_word(const NcWord& word, const FirstLine& line, AxisTexts& axes, std::string& out);
  void write_axis_word(const NcWord& word, const FirstLine& line, AxisTexts& axes, std::string& out);
  void write_further(const NcStep& step, const NcTarget& target, const AxisTexts& axes, double feed,
                     std::string& out);
  void append_axis(std::size_t axis, AxisText& text, std::string& out) const;
  void append_motion_code(int needed, std::string& out);
  double feed_of_segment(const NcStep& step, double length, double total) const;
  double written_length(std::span<const NcTarget> targets) const;

  int decimals() const;
  NcState state_;
  int decimals_mm_;
  std::string line_end_ = "\n";
};

}  // namespace volcal
