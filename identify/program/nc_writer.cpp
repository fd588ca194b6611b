#include "volcal/identify/program/nc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "volcal/identify/program/nc_cycles.h"
#include "volcal/identify/program/program_header.h"

namespace volcal {
namespace {

constexpr int kRapidCode = 0, kFeedCode = 10;
constexpr int kInchDecimalsBeyond = 1;

bool is_motion_word(const NcWord& word) {
  if (word.letter != 'G') return false;
  const int code = word.code();
  return code == 0 || code == 10 || code == 20 || code == 30 || is_cycle(code);
}

bool is_stop_word(const NcWord& word) {
  const int code = word.code();
  return word.letter == 'M' && (code == 0 || code == 10 || code == 20 || code == 300 || code == 600);
}

int axis_of_letter(char letter) { return letter >= 'X' && letter <= 'Z' ? letter - 'X' : -1; }

/// Words that arcs and cycles have and lines do not.
bool belongs_to_curve(char letter, int motion) {
  if (is_cycle(motion)) return letter == 'R' || letter == 'P' || letter == 'Q' || letter == 'L';
  const bool arc = motion == 20 || motion == 30;
  return arc && (letter == 'I' || letter == 'J' || letter == 'K' || letter == 'R' || letter == 'P');
}

constexpr std::array<double, 11> kPowersOfTen = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10};

/// With `decimals` digits behind the point, 0 to 10; |value| below 1e8.
void append_number(double value, int decimals, std::string& out) {
  const double scale = kPowersOfTen[static_cast<std::size_t>(decimals)];
  long long steps = std::llround(value * scale);
  if (steps < 0) out += '-';
  steps = std::abs(steps);
  char digits[24];
  char* const end = digits + sizeof digits;
  char* first = end;
  for (int i = 0; i < decimals || steps > 0 || i == decimals; ++i) {
    if (i == decimals && decimals > 0) *--first = '.';
    *--first = static_cast<char>('0' + steps % 10);
    steps /= 10;
  }
  out.append(first, end);
}

double rounded(double value, int decimals) {
  const double scale = kPowersOfTen[static_cast<std::size_t>(decimals)];
  return std::round(value * scale) / scale + 0.0;  // no negative zero
}

void append_feed(double feed, std::string& out) {
  constexpr int kDigits = 7;
  const int whole = feed >= 1.0 ? static_cast<int>(std::floor(std::log10(feed))) + 1 : 0;
  append_number(feed, std::max(kDigits - whole, 1), out);
}

/// M0, M1, M2, M30 and M60 of the block.
void append_stops(const NcBlock& block, std::string& out) {
  for (const NcWord& word : block.words) {
    if (is_stop_word(word)) out.append(" ").append(block.text.substr(word.begin, word.end - word.begin));
  }
}

/// Blanks before a word that is taken out go with it.
void drop_blanks(std::string& out) {
  while (!out.empty() && (out.back() == ' ' || out.back() == '\t')) out.pop_back();
}

std::size_t length_without_end(std::string_view line) {
  const std::size_t last = line.find_last_not_of("\r\n");
  return last == std::string_view::npos ? 0 : last + 1;
}

}  // namespace

void require_readable(std::string_view written, std::string_view original, const NcPlace& place) {
  const std::size_t length = length_without_end(written);
  if (length <= kLongestLine || length <= length_without_end(original)) return;
  place.refuse(
      fmt::format("the rewritten block has {} characters, and controls read {}", length, kLongestLine),
      "write its comment on a line of its own");
}

void put_header(const std::vector<std::string>& header, std::string_view original,
                std::vector<NcWrittenLine>& written) {
  const bool percent = !written.empty() && written.front().text.starts_with('%');
  const std::string end = original.ends_with("\r\n") ? "\r\n" : "\n";
  std::vector<NcWrittenLine> lines;
  for (const std::string& comment : header) lines.push_back({comment + end, 0.0});
  written.insert(written.begin() + (percent ? 1 : 0), lines.begin(), lines.end());
}

NcWriter::NcWriter(const NcSetup& setup, int decimals_mm)
    : state_(initial_state(setup)), decimals_mm_(decimals_mm) {}

int NcWriter::decimals() const {
  constexpr double kLongestMillimetre = 2e-3;
  return state_.unit < kLongestMillimetre ? decimals_mm_ : decimals_mm_ + kInchDecimalsBeyond;
}

void NcWriter::copy(const NcStep& step, std::string_view line, const NcSetup& setup, const NcPlace& place,
                    std::vector<NcWrittenLine>& lines) {
  lines.push_back({std::string(line), 0.0});
  if (!step.executed) return;
  if (!step.block.line_end.empty()) line_end_ = step.block.line_end;
  apply_settings(step.commands, setup, place, state_);
  if (step.commands.motion != kNoCode)
    state_.motion = step.commands.motion <= kFeedCode ? step.commands.motion : kNoCode;
}

/// What is written for each axis, and where the control then stands.
NcWriter::AxisTexts NcWriter::axis_texts(const NcStep& step, const NcTarget& target, bool first,
                                         const std::array<bool, 3>& known, const NcPlace& place) {
  AxisTexts texts;
  if (target.kind == NcMotionKind::Dwell) return texts;
  const bool incremental = state_.incremental && !step.machine_axes;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (!step.machine_axes) origin = program_origin(state_, place);
  const bool keeps_words = first && !is_cycle(step.motion);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!known[i]) continue;
    const auto k = static_cast<Eigen::Index>(i);
    const double from = incremental ? state_.position[k] : origin[k];
    AxisText& text = texts[i];
    text.value = rounded((target.command[k] - from) / state_.unit, decimals());
    const double reached = from + text.value * state_.unit;
    const double still = 0.4 * state_.unit / kPowersOfTen[static_cast<std::size_t>(decimals())];
    text.wanted = (keeps_words && step.commands.has(kNcAxisLetters[i])) ||
                  std::abs(reached - state_.position[k]) > still || !state_.known[i];
    if (!text.wanted) continue;
    state_.position[k] = reached;
    state_.known[i] = true;
  }
  return texts;
}

void NcWriter::append_axis(std::size_t axis, AxisText& text, std::string& out) const {
  if (!text.wanted) return;
  if (!out.empty() && out.back() != ' ') out += ' ';
  out += kNcAxisLetters[axis];
  append_number(text.value, decimals(), out);
  text.wanted = false;
}

void NcWriter::append_motion_code(int needed, std::string& out) {
  if (state_.motion == needed) return;
  state_.motion = needed;
  if (!out.empty() && out.back() != ' ' && out.back() != '/') out += ' ';
  out += needed == kRapidCode ? "G0" : "G1";
}

/// An axis word of the block: its new value, its own text where that is the same, or nothing.
void NcWriter::write_axis_word(const NcWord& word, const FirstLine& line, AxisTexts& axes, std::string& out) {
  if (!line.has_code && state_.motion != line.needed) {
    append_motion_code(line.needed, out);
    out += ' ';
  }
  const auto axis = static_cast<std::size_t>(axis_of_letter(word.letter));
  AxisText& text = axes[axis];
  if (!text.wanted) {
    drop_blanks(out);
  } else if (text.value == word.value && !is_cycle(line.motion)) {
    out.append(line.own(word));
    text.wanted = false;
  } else {
    append_axis(axis, text, out);
  }
}

void NcWriter::write_word(const NcWord& word, const FirstLine& line, AxisTexts& axes, std::string& out) {
  if (is_motion_word(word)) {
    state_.motion = line.needed;
    out.append(word.code() == line.needed ? line.own(word) : line.needed == kRapidCode ? "G0" : "G1");
  } else if (axis_of_letter(word.letter) >= 0) {
    write_axis_word(word, line, axes, out);
  } else if (word.letter == 'F' && line.feed > 0.0) {
    out += 'F';
    append_feed(line.feed, out);
  } else if (belongs_to_curve(word.letter, line.motion) || (is_stop_word(word) && !line.keeps_stop)) {
    drop_blanks(out);
  } else {
    out.append(line.own(word));
  }
}

/// The block's text with the first target in it; new words go behind the last axis word, else behind the last
/// word.
void NcWriter::write_first(const NcBlock& block, const FirstLine& line, AxisTexts& axes, std::string& out) {
  const auto is_axis = [](const NcWord& word) { return axis_of_letter(word.letter) >= 0; };
  const auto last_axis = std::find_if(block.words.rbegin(), block.words.rend(), is_axis);
  const NcWord& place = last_axis != block.words.rend() ? *last_axis : block.words.back();
  std::uint32_t cursor = 0;
  for (const NcWord& word : block.words) {
    out.append(block.text.substr(cursor, word.begin - cursor));
    cursor = word.end;
    write_word(word, line, axes, out);
    if (&word != &place) continue;
    if (!line.has_code) append_motion_code(line.needed, out);
    for (std::size_t i = 0; i < 3; ++i) append_axis(i, axes[i], out);
  }
  out.append(block.text.substr(cursor));
}

void NcWriter::write_further(const NcStep& step, const NcTarget& target, const AxisTexts& axes, double feed,
                             std::string& out) {
  if (step.block.deletable) out += '/';
  if (target.kind == NcMotionKind::Dwell) {
    out += "G4 P";
    append_number(target.dwell, 4, out);
    return;
  }
  if (step.machine_axes) out += "G53";
  append_motion_code(target.kind == NcMotionKind::Rapid ? kRapidCode : kFeedCode, out);
  for (std::size_t i = 0; i < 3; ++i) {
    AxisText text = axes[i];
    if (text.wanted && (out.empty() || out.back() == '/')) {
      out += kNcAxisLetters[i];
      append_number(text.value, decimals(), out);
    } else {
      append_axis(i, text, out);
    }
  }
  if (feed > 0.0) {
    out += " F";
    append_feed(feed, out);
  }
}

/// Along the targets from where the control stands.
double NcWriter::written_length(std::span<const NcTarget> targets) const {
  double length = 0.0;
  Eigen::Vector3d at = state_.position;
  for (const NcTarget& target : targets) {
    length += (target.command - at).norm();
    at = target.command;
  }
  return length;
}

/// Under G93 the segments share the time of their block by length.
double NcWriter::feed_of_segment(const NcStep& step, double length, double total) const {
  const double feed = step.commands.value('F');
  constexpr double kShortest = 1e-9;  // m: a control needs a finite F
  return total > 0.0 ? feed * total / std::max(length, kShortest) : feed;
}

void NcWriter::write(const NcStep& step, const NcSetup& setup, const NcPlace& place,
                     const std::array<bool, 3>& known, std::span<const NcTarget> targets,
                     std::vector<NcWrittenLine>& lines) {
  apply_settings(step.commands, setup, place, state_);
  if (!step.block.line_end.empty()) line_end_ = step.block.line_end;
  const bool timed =
      state_.feed_mode == NcFeedMode::InverseTime && step.motion != kRapidCode && targets.size() > 1;
  const double total = timed ? written_length(targets) : 0.0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const bool first = i == 0, last = i + 1 == targets.size();
    const Eigen::Vector3d before = state_.position;
    AxisTexts axes = axis_texts(step, targets[i], first, known, place);
    const bool nothing = std::ranges::none_of(axes, [](const AxisText& text) { return text.wanted; });
    if (nothing && !first && targets[i].kind != NcMotionKind::Dwell && !(last && step.commands.stop))
      continue;
    const double feed = timed ? feed_of_segment(step, (state_.position - before).norm(), total) : 0.0;
    NcWrittenLine& line = lines.emplace_back();
    line.at = targets[i].at;
    if (first) {
      const int needed = targets[i].kind == NcMotionKind::Rapid ? kRapidCode : kFeedCode;
      const bool has_code = std::ranges::any_of(step.block.words, is_motion_word);
      write_first(step.block, {step.block.text, step.motion, needed, has_code, last, feed}, axes, line.text);
    } else {
      write_further(step, targets[i], axes, feed, line.text);
      if (last) append_stops(step.block, line.text);
    }
    line.text += line_end_;
  }
  if (step.block.line_end.empty() && !lines.empty()) {
    std::string& text = lines.back().text;
    text.resize(text.size() - line_end_.size());
  }
}

}  // namespace volcal
