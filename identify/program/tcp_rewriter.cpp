#include "volcal/identify/program/tcp_rewriter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/program/program_header.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kLever = 0.1;          // m, at which turns count as displacements
constexpr double kShareOfSplits = 0.5;  // of the tolerance
constexpr double kShareOfTcpJumps = 0.25;
constexpr int kDeepest = 16;             // halvings of a block; what is not straight then is a step
constexpr int kMostStepsOfBlock = 1000;  // of a block
constexpr double kBetweenChecks = 1e-3;  // m
constexpr double kTurnBetweenChecks = 0.25 * kRadianPerDegree;
constexpr double kFewestChecks = 4.0, kMostChecks = 1e4;  // of a part, of a block
constexpr double kSlightlyOn = 1e-4;    // of a block: where the directions of its axes are looked at
constexpr double kTcpStill = 1e-12;     // m or rad
constexpr double kNearPole = 0.1;       // of the orientation error
constexpr double kHardlyTilted = 1e-7;  // rad
constexpr double kTcpTravelRounding = 1e-9;

/// G codes that are followed, in tenths.
constexpr std::array kTcpCodes = {0,   10,  40,  170, 180, 190, 200, 210, 400, 430, 434, 490, 530, 540, 550,
                                  560, 570, 580, 590, 591, 592, 593, 610, 640, 800, 900, 930, 940, 980};
/// Those of them that are followed outside the mode alone.
constexpr std::array kOutsideTcp = {430, 434, 530};

/// An axis on the tool's side that travels a turn stops at its ends where nothing else is stated.
std::string remedy_of_travel(const Axis& axis) {
  if (!axis.travels_a_turn() || axis.endless)
    return "check work offsets, tool lengths, units and rotary positions";
  return fmt::format(
      "{0} does not carry the workpiece and is taken to stop at the ends of its travel: write positions "
      "within it, or, where {0} turns without end, endless = true in [axes.{0}] of the machine file, and fit "
      "again",
      letter_of(axis.name));
}

bool is_stop(int m) { return m == 0 || m == 10 || m == 20 || m == 300 || m == 600; }

}  // namespace

TcpRewriter::TcpRewriter(const Machine& machine, JointErrorSource errors, NcSetup setup,
                         FunctionalPoint functional_point, TcpRewriteOptions options, std::string file)
    : machine_(machine),
      errors_(std::move(errors)),
      setup_(std::move(setup)),
      functional_point_(std::move(functional_point)),
      options_(std::move(options)),
      file_(std::move(file)),
      unit_(setup_.length_unit) {
  const bool rotary =
      std::ranges::any_of(machine.axes, [](const Axis& axis) { return is_rotary(axis.name); });
  if (!rotary)
    throw InputError({file_, 0}, "the program has tool centre point motion and the machine no rotary axis",
                     "give the result of the machine that the program is for");
}

bool TcpRewriter::is_tcp_axis(char letter) const {
  const auto axis = axis_from_letter(letter);
  return axis && machine_.has_axis(*axis);
}

Eigen::Vector3d TcpRewriter::origin() const {
  const auto& work = setup_.work_offsets[work_];
  if (!work)
    place().refuse(fmt::format("the program moves in {}, whose offset is not given", work_offset_name(work_)),
                   fmt::format("add --work-offset {}=X...,Y...,Z... in mm", work_offset_name(work_)));
  return *work + functional_point_.lengths_from;
}

void TcpRewriter::follow_settings(const TcpWords& words, const NcBlock& block) {
  if (block.deletable)
    place().refuse("the block is skipped or run by the control's block-delete switch",
                   "take the / or the block out");
  for (const int code : words.g) {
    const auto is_among = [code](const auto& codes) { return std::ranges::find(codes, code) != codes.end(); };
    const bool inside = tcp_ != nullptr;
    const bool right = is_among(kTcpCodes) && !(inside && is_among(kOutsideTcp));
    if (!right)
      place().refuse(fmt::format("{} is not followed {} tool centre point motion", g_code_name(code),
                                 inside ? "in" : "in a program with"),
                     "write G0 and G1 under G90, lines alone; arcs and cycles as short lines");
    if (code == 0 || code == 10) motion_ = code;
    if (code == 200 || code == 210) unit_ = code == 200 ? kMetrePerInch : kMetrePerMillimetre;
    if (code == 930 || code == 940) inverse_time_ = code == 930;
    for (std::size_t i = 0; i < kWorkOffsets; ++i) {
      if (g_code_name(code) == work_offset_name(i)) work_ = i;
    }
  }
  for (const char letter : std::string_view("DEIJKLPQRUVW")) {
    const bool dwell = letter == 'P' && (words.has_g(40) || words.has_g(640));
    if (words.has(letter) && !dwell)
      place().refuse(fmt::format("{} is not followed in tool centre point motion", letter),
                     "write positions of X, Y, Z and the rotary axes, or take it out");
  }
  if (words.has_g(40) && words.moves())
    place().refuse("coordinates in the block of G4", "write them in two blocks");
  for (const char letter : kTcpLetters) {
    if (words.has(letter) && !is_tcp_axis(letter))
      place().refuse(fmt::format("the machine has no axis {}", letter),
                     "give the result of the machine that the program is for");
  }
  if (words.has('H') && !words.on && !words.has_g(430))
    place().refuse("H belongs to no code of the block", "take it out");
}

void TcpRewriter::begin_mode(const TcpWords& words) {
  if (tcp_ != nullptr) place().refuse("tool centre point motion is active already", "end it by G49 first");
  Eigen::Vector3d offset = functional_point_.without_length;
  if (!words.by_name) {
    if (!words.has('H')) place().refuse("G43.4 stands without H", "write G43.4 H and the number of the tool");
    const auto length =
        std::find_if(setup_.tool_lengths.begin(), setup_.tool_lengths.end(),
                     [&](const std::pair<const int, double>& tool) { return tool.first == words.of('H'); });
    if (length == setup_.tool_lengths.end())
      place().refuse(fmt::format("the length of tool H{:g} is not given", words.of('H')),
                     fmt::format("add --tool-length H{:g}=LENGTH in mm", words.of('H')));
    offset = functional_point_.lengths_from - Eigen::Vector3d(0.0, 0.0, length->second);
  }
  auto& machine = machines_[fmt::format("{:.9f} {:.9f} {:.9f}", offset.x(), offset.y(), offset.z())];
  if (machine == nullptr)
    machine = std::make_unique<TcpMachine>(machine_, offset, errors_, options_.orientation);
  tcp_ = machine.get();
  point_known_.fill(false);
  sent_known_ = false;
  written_words_.fill("");
}

/// Outside the mode the axes go where they are sent; the rotary ones are kept in mind.
void TcpRewriter::rapid_outside(const TcpWords& words) {
  if (motion_ != 0)
    place().refuse("a feed motion stands outside tool centre point motion",
                   "write it behind G43.4 H or TRAORI; a program of X, Y and Z with the rotary axes at 0 is "
                   "compensated by itself");
  for (const AxisName axis : kAllAxes) {
    if (!is_rotary(axis) || !words.has(letter_of(axis))) continue;
    const auto k = static_cast<std::size_t>(direction_of(axis));
    to_.rotary[direction_of(axis)] = words.of(letter_of(axis)) * kRadianPerDegree;
    rotary_known_[k] = true;
  }
  ++summary_.copied_rapids;
}

void TcpRewriter::set_target(const TcpWords& words) {
  if (unit_ == 0.0)
    place().refuse("the unit of length is not known here", "write G21 or G20 before it, or give --units");
  from_ = to_;
  const Eigen::Vector3d zero = origin();
  const auto was_known = point_known_;
  for (const AxisName axis : kAllAxes) {
    if (!machine_.has_axis(axis)) continue;
    const auto k = static_cast<std::size_t>(direction_of(axis));
    const bool given = words.has(letter_of(axis));
    if (is_rotary(axis)) {
      if (given) to_.rotary[direction_of(axis)] = words.of(letter_of(axis)) * kRadianPerDegree;
      rotary_known_[k] = rotary_known_[k] || given;
      if (!options_.identified[k] &&
          !stands_at_reference(to_.rotary[direction_of(axis)], options_.reference[k]))
        place().refuse(
            fmt::format("the errors of axis {} were not identified, and it does not stand at {:g} deg",
                        letter_of(axis), options_.reference[k] / kRadianPerDegree),
            "measure with the axis turned, and fit");
    } else {
      if (given)
        to_.point_w[direction_of(axis)] = zero[direction_of(axis)] + words.of(letter_of(axis)) * unit_;
      point_known_[k] = point_known_[k] || given;
    }
    if (!(is_rotary(axis) ? rotary_known_ : point_known_)[k])
      place().refuse(fmt::format("the position of {} is not known here", letter_of(axis)),
                     "move every axis by G0 first; X, Y and Z after tool centre point motion has begun");
  }
  if (motion_ != 0 && was_known != point_known_)
    place().refuse("a feed motion begins before the positions of X, Y and Z are known",
                   "go to them by G0 behind G43.4 or TRAORI first");
}

/// By the nominal way of every axis; one that stands keeps its direction.
ApproachDirection TcpRewriter::directions_at(double t) {
  const double begin = std::clamp(t - 0.5 * kSlightlyOn, 0.0, 1.0 - kSlightlyOn);
  const AxisPosition before = tcp_->axes_at(TcpPose::between(from_, to_, begin));
  const AxisPosition after = tcp_->axes_at(TcpPose::between(from_, to_, begin + kSlightlyOn));
  ApproachDirection directions = directions_;
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    const double moved = after[i] - before[i];
    if (std::abs(moved) > kTcpStill) directions[i] = moved > 0.0 ? 1 : -1;
  }
  return directions;
}

TcpRewriter::Node TcpRewriter::node_at(double t) {
  last_directions_ = directions_at(t);
  return {t, tcp_->command(TcpPose::between(from_, to_, t), last_directions_)};
}

/// Notes what turns beyond its travel without a word of the machine's owner.
void TcpRewriter::require_reachable(const TcpPose& sent) {
  const AxisPosition position = tcp_->axes_at(sent);
  for (const Axis& axis : machine_.axes) {
    const double q = position[index_of(axis.name)];
    const bool inside =
        q >= axis.travel_min - kTcpTravelRounding && q <= axis.travel_max + kTcpTravelRounding;
    if (inside) continue;
    if (machine_.is_endless(axis.name)) {
      if (!axis.endless) summary_.assumed_endless.insert(axis.name);
      continue;
    }
    const Unit unit = position_unit(axis.name);
    place().refuse(
        fmt::format("the block takes {} to {:.4f} {} in machine coordinates, outside its travel {:g} "
                    "to {:g} {}",
                    letter_of(axis.name), q / unit.si_per_unit, unit.suffix,
                    axis.travel_min / unit.si_per_unit, axis.travel_max / unit.si_per_unit, unit.suffix),
        remedy_of_travel(axis));
  }
}

double TcpRewriter::distance(const Node& node, const TcpPose& chord) const {
  return (node.sent.point_w - chord.point_w).norm() + kLever * (node.sent.rotary - chord.rotary).norm();
}

bool TcpRewriter::is_straight(double t_from, const Node& from, double t_to, const Node& to,
                              const Node& middle) {
  const double allowed = kShareOfSplits * options_.tolerance;
  if (distance(middle, TcpPose::between(from.sent, to.sent, 0.5)) > allowed) return false;
  const double checks = std::max(kFewestChecks, std::ceil((t_to - t_from) * checks_of_block_));
  for (std::size_t i = 0; i < static_cast<std::size_t>(checks); ++i) {
    const double share = sample_share(i);
    const Node node = node_at(t_from + share * (t_to - t_from));
    if (distance(node, TcpPose::between(from.sent, to.sent, share)) > allowed) return false;
  }
  return true;
}

/// Nodes behind `from` up to `to`.
void TcpRewriter::split(double t_from, const Node& from, double t_to, const Node& to, int depth,
                        std::vector<Node>& nodes) {
  const Node middle = node_at(0.5 * (t_from + t_to));
  const bool straight = is_straight(t_from, from, t_to, to, middle);
  if (!straight && depth < kDeepest) {
    split(t_from, from, middle.t, middle, depth + 1, nodes);
    split(middle.t, middle, t_to, to, depth + 1, nodes);
    return;
  }
  if (!straight && ++steps_ > kMostStepsOfBlock)
    place().refuse("the identified errors change in waves too short for the block to be split",
                   "write the block as several, allow more by --tolerance-um, or leave the effect with these "
                   "waves out of the model");
  nodes.push_back(to);
}

/// Nodes of a feed motion behind its first.
void TcpRewriter::split_block(const Node& begin, const Node& end, std::vector<Node>& nodes) {
  const double way = (to_.point_w - from_.point_w).norm() / kBetweenChecks +
                     (to_.rotary - from_.rotary).norm() / kTurnBetweenChecks;
  checks_of_block_ = std::clamp(way, 1.0, kMostChecks);
  steps_ = 0;
  split(0.0, begin, 1.0, end, 0, nodes);
}

TcpPose TcpRewriter::rounded(const TcpPose& pose) const {
  const double mm = std::pow(10.0, -options_.decimals_mm) * kMetrePerMillimetre;
  const double length = unit_ == kMetrePerInch ? mm * 0.1 * 25.4 : mm;
  const double angle = std::pow(10.0, -options_.decimals_deg) * kRadianPerDegree;
  const Eigen::Vector3d zero = origin();
  TcpPose result;
  for (int k = 0; k < 3; ++k) {
    result.point_w[k] = zero[k] + length * std::round((pose.point_w[k] - zero[k]) / length);
    result.rotary[k] = angle * std::round(pose.rotary[k] / angle);
  }
  return result;
}

void TcpRewriter::note_node(const Node& node) {
  const TcpPose meant = TcpPose::between(from_, to_, node.t);
  summary_.largest_correction =
      std::max(summary_.largest_correction, (node.sent.point_w - meant.point_w).norm());
  summary_.largest_turn =
      std::max(summary_.largest_turn, (node.sent.rotary - meant.rotary).cwiseAbs().maxCoeff());
  if (options_.measured && options_.measured->is_beyond(tcp_->counted(tcp_->axes_at(meant)))) {
    if (options_.within_readings)
      place().refuse("the motion goes beyond the positions that were measured",
                     "measure there, or leave --no-extrapolation out: the last measured error is then held");
    if (summary_.beyond_readings++ == 0) summary_.first_beyond = place().line;
  }
  if (!options_.orientation) return;
  const double before = tcp_->left(meant, meant, directions_).axis;
  const double after = tcp_->left(node.sent, meant, directions_).axis;
  if (before < kHardlyTilted || after < kNearPole * before) return;
  if (summary_.near_poles++ == 0) summary_.first_near_pole = place().line;
}

/// As the written numbers have it.
void TcpRewriter::note_errors(const std::vector<Node>& nodes) {
  const double length = (to_.point_w - from_.point_w).norm();
  summary_.length += length;
  TcpPose begin = sent_;
  double t_begin = 0.0;
  for (const Node& node : nodes) {
    const TcpPose end = rounded(node.sent);
    const double part = node.t - t_begin;
    weighted_shares(static_cast<std::size_t>(std::ceil(part * checks_of_block_)), shares_);
    for (const auto& [share, share_of_weight] : shares_) {
      const double t = t_begin + share * part;
      const TcpPose meant = TcpPose::between(from_, to_, t);
      const ApproachDirection directions = directions_at(t);
      const TcpMachine::Left before = tcp_->left(meant, meant, directions);
      const TcpMachine::Left after = tcp_->left(TcpPose::between(begin, end, share), meant, directions);
      const double weight = share_of_weight * part * length;
      square_before_ += weight * before.point * before.point;
      square_after_ += weight * after.point * after.point;
      axis_before_ += weight * before.axis * before.axis;
      axis_after_ += weight * after.axis * after.axis;
      if (before.point > summary_.before.max) summary_.before.line_of_max = place().line;
      if (after.point > summary_.after.max) summary_.after.line_of_max = place().line;
      summary_.before.max = std::max(summary_.before.max, before.point);
      summary_.after.max = std::max(summary_.after.max, after.point);
      summary_.before.axis_max = std::max(summary_.before.axis_max, before.axis);
      summary_.after.axis_max = std::max(summary_.after.axis_max, after.axis);
    }
    begin = end;
    t_begin = node.t;
  }
}

void TcpRewriter::move(const TcpWords& words, const NcBlock& block) {
  if (motion_ == kNoCode)
    place().refuse("coordinates stand without G0 or G1", "write the G code of the motion");
  set_target(words);
  ++summary_.motions;
  std::vector<Node> nodes;
  if (motion_ == 0) {
    if (!sent_known_) from_ = to_;
    nodes.push_back(node_at(1.0));
  } else {
    const Node begin = node_at(0.0), end = node_at(1.0);
    const double jump =
        (begin.sent.point_w - sent_.point_w).norm() + kLever * (begin.sent.rotary - sent_.rotary).norm();
    if (jump > kShareOfTcpJumps * options_.tolerance) nodes.push_back(begin);
    split_block(begin, end, nodes);
    if (options_.check) note_errors(nodes);
  }
  for (const Node& node : nodes) {
    require_reachable(node.sent);
    note_node(node);
  }
  write_block(words, block, nodes);
  directions_ = directions_at(1.0);
  sent_ = rounded(nodes.back().sent);
  sent_known_ = true;
  if (written_.size() > 1) ++summary_.split_lines;
}

/// Words of the axes whose number changes.
std::string TcpRewriter::coordinates(const Node& node) {
  const TcpPose sent = rounded(node.sent);
  const Eigen::Vector3d zero = origin();
  std::string text;
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    const AxisName axis = kAllAxes[i];
    if (!machine_.has_axis(axis)) continue;
    const int k = direction_of(axis);
    const int inch = unit_ == kMetrePerInch ? 1 : 0;
    const std::string word =
        is_rotary(axis) ? fmt::format("{}{:.{}f}", letter_of(axis), sent.rotary[k] / kRadianPerDegree + 0.0,
                                      options_.decimals_deg)
                        : fmt::format("{}{:.{}f}", letter_of(axis), (sent.point_w[k] - zero[k]) / unit_ + 0.0,
                                      options_.decimals_mm + inch);
    if (word == written_words_[i]) continue;
    written_words_[i] = word;
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

/// The block's text with the first node in place of its coordinates, then a line per further node.
void TcpRewriter::write_block(const TcpWords& words, const NcBlock& block, const std::vector<Node>& nodes) {
  const bool stops = std::ranges::any_of(words.m, is_stop);
  if (stops && nodes.size() > 1)
    place().refuse("the block stops the program and must become several lines",
                   "write M0, M1, M2, M30 or M60 in a block of its own");
  const bool timed = inverse_time_ && motion_ != 0;
  if (timed && !words.has('F'))
    place().refuse("the block has no F, which every feed motion under G93 needs",
                   "write F, one over minutes");
  const auto feed = [&](double share) {
    return fmt::format("F{:.6g}", words.of('F') / std::max(share, 1e-6));
  };
  std::string first;
  std::size_t cursor = 0;
  bool placed = false;
  for (const NcWord& word : block.words) {
    first.append(block.text.substr(cursor, word.begin - cursor));
    cursor = word.end;
    const bool coordinate = kTcpLetters.find(word.letter) != std::string_view::npos;
    if (!coordinate) {
      const bool new_feed = word.letter == 'F' && timed && nodes.size() > 1;
      first.append(new_feed ? std::string_view() : block.text.substr(word.begin, word.end - word.begin));
      if (new_feed) first += feed(nodes.front().t);
      continue;
    }
    const std::string written = placed ? std::string() : coordinates(nodes.front());
    placed = true;
    first += written;
    while (written.empty() && !first.empty() && first.back() == ' ') first.pop_back();
  }
  first.append(block.text.substr(cursor));
  const std::string end = block.line_end.empty() ? "\n" : std::string(block.line_end);
  written_.push_back(first + end);
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    std::string line = coordinates(nodes[i]);
    if (line.empty() && !timed) continue;
    if (timed) line += (line.empty() ? "" : " ") + feed(nodes[i].t - nodes[i - 1].t);
    written_.push_back(line + end);
  }
}

void TcpRewriter::rewrite(std::string_view line, const Sink& sink) {
  written_.clear();
  if (is_compensated(line))
    place().refuse("the program has been compensated already", "compensate the original program");
  NcBlock block;
  try {
    if (ended_) {
      written_.emplace_back(line);
    } else {
      const TcpWords words(line, place(), block);
      if (block.percent) {
        ended_ = percent_seen_;
        percent_seen_ = true;
      }
      follow_settings(words, block);
      if (words.on) begin_mode(words);
      if (tcp_ != nullptr && words.moves()) {
        if (words.off) place().refuse("coordinates in the block of G49", "write them in a block after it");
        move(words, block);
      } else {
        if (words.moves()) rapid_outside(words);
        written_.emplace_back(line);
      }
      if (words.off) tcp_ = nullptr;
      ended_ = ended_ || std::ranges::any_of(words.m, [](int m) { return m == 20 || m == 300; });
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    place().refuse(error.what(), "check rotary positions and work offsets");
  }
  if (!header_written_ && !options_.header.empty()) {
    header_written_ = true;
    const std::string end = line.ends_with("\r\n") ? "\r\n" : "\n";
    std::vector<std::string> header;
    for (const std::string& comment : options_.header) header.push_back(comment + end);
    written_.insert(written_.begin() + (block.percent ? 1 : 0), header.begin(), header.end());
  }
  ++summary_.lines_read;
  summary_.lines_written += static_cast<std::int64_t>(written_.size());
  sink(line, written_);
}

TcpRewriteOptions tcp_options_of(const FitResult& result) {
  TcpRewriteOptions options;
  options.measured = MeasuredTravel(result);
  options.identified.fill(false);
  for (const AxisName axis : identified_rotary_axes(result))
    options.identified[static_cast<std::size_t>(direction_of(axis))] = true;
  for (const AxisName axis : result.machine.rotary_axes())
    options.reference[static_cast<std::size_t>(direction_of(axis))] = reference_of(result, axis);
  return options;
}

TcpSummary TcpRewriter::summary() const {
  TcpSummary summary = summary_;
  if (!(summary.length > 0.0)) return summary;
  summary.before.rms = std::sqrt(square_before_ / summary.length);
  summary.after.rms = std::sqrt(square_after_ / summary.length);
  summary.before.axis_rms = std::sqrt(axis_before_ / summary.length);
  summary.after.axis_rms = std::sqrt(axis_after_ / summary.length);
  return summary;
}

}  // namespace volcal
