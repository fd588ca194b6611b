#include "volcal/identify/program/tcp/tcp_rewriter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/program/program_header.h"
#include "volcal/identify/program/sample_shares.h"
#include "volcal/identify/program/tcp/tcp_words.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kShareOfSplits = 0.5;  // of the tolerance
constexpr double kShareOfTcpJumps = 0.25;
constexpr int kDeepest = 16;             // halvings of a block; what is not straight then is a step
constexpr int kMostStepsOfBlock = 1000;  // of a block
constexpr double kFewestChecks = 4.0;    // of a part
constexpr double kSameDigits = 1e-3;     // of the last digit
constexpr double kNearPole = 0.1;        // of the orientation error
constexpr double kHardlyTilted = 1e-7;   // rad
constexpr double kTcpTravelRounding = 1e-9;

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

double inverse_time(double feed, double share) { return feed / std::max(share, 1e-6); }

}  // namespace

TcpRewriter::TcpRewriter(const Machine& machine, ErrorsOfOffset errors, NcSetup setup,
                         FunctionalPoint functional_point, TcpRewriteOptions options, std::string file)
    : machine_(machine),
      machines_(machine, std::move(errors), options.orientation),
      interpreter_(machine, std::move(setup), std::move(functional_point), std::move(file)),
      options_(std::move(options)) {}

void TcpRewriter::require_identified(const TcpStep& step) const {
  for (const AxisName axis : machine_.rotary_axes()) {
    const auto k = static_cast<std::size_t>(direction_of(axis));
    if (options_.identified[k] ||
        stands_at_reference(step.to.rotary[direction_of(axis)], options_.reference[k]))
      continue;
    place().refuse(fmt::format("the errors of axis {} were not identified, and it does not stand at {:g} deg",
                               letter_of(axis), options_.reference[k] / kRadianPerDegree),
                   "measure with the axis turned, and fit");
  }
}

ApproachDirection TcpRewriter::directions_at(double t) const {
  return tcp_->directions(from_, to_, t, directions_);
}

TcpRewriter::Node TcpRewriter::node_at(double t) {
  return {t, tcp_->command(TcpPose::between(from_, to_, t), directions_at(t))};
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

/// Of a motion with turning axes: X, Y and Z go further than to its ends.
void TcpRewriter::require_path_reachable() {
  const double places = std::ceil(tcp_places(from_, to_));
  for (double i = 1.0; i < places; ++i) require_reachable(TcpPose::between(from_, to_, i / places));
}

double TcpRewriter::distance(const Node& node, const TcpPose& chord) const {
  return (node.sent.point_w - chord.point_w).norm() + kTcpLever * (node.sent.rotary - chord.rotary).norm();
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
  checks_of_block_ = tcp_places(from_, to_);
  steps_ = 0;
  split(0.0, begin, 1.0, end, 0, nodes);
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

void TcpRewriter::move(const TcpStep& step) {
  from_ = step.from;
  to_ = step.to;
  tcp_ = &machines_.with(interpreter_.tool_offset());
  if (step.first) stands_known_ = false;
  ++summary_.motions;
  std::vector<Node> nodes;
  if (!step.feed) {
    nodes.push_back(node_at(1.0));
  } else {
    require_path_reachable();
    const Node begin = node_at(0.0), end = node_at(1.0);
    if (distance(begin, stands_) > kShareOfTcpJumps * options_.tolerance) nodes.push_back(begin);
    split_block(begin, end, nodes);
  }
  for (const Node& node : nodes) {
    require_reachable(node.sent);
    note_node(node);
  }
  write_block(step, nodes);
  directions_ = directions_at(1.0);
  if (written_.size() > 1) ++summary_.split_lines;
}

/// Words of the axes that `kept` has, and of those that stand elsewhere; the control then stands there.
std::string TcpRewriter::coordinates(const Node& node, const NcCommands* kept) {
  const Eigen::Vector3d zero = interpreter_.origin();
  const double unit = interpreter_.state().unit;
  const int inch = unit == kMetrePerInch ? 1 : 0;
  std::string text;
  for (const AxisName axis : kAllAxes) {
    if (!machine_.has_axis(axis)) continue;
    const int k = direction_of(axis);
    const bool turns = is_rotary(axis);
    const double from = turns ? 0.0 : zero[k], per_unit = turns ? kRadianPerDegree : unit;
    const int decimals = turns ? options_.decimals_deg : options_.decimals_mm + inch;
    const double scale = std::pow(10.0, decimals);
    double& stands = turns ? stands_.rotary[k] : stands_.point_w[k];
    const double sent = turns ? node.sent.rotary[k] : node.sent.point_w[k];
    const double number = std::round((sent - from) / per_unit * scale) / scale + 0.0;
    const double reached = from + number * per_unit;
    const bool there = stands_known_ && std::abs(reached - stands) < kSameDigits * per_unit / scale;
    if (there && !(kept != nullptr && kept->has(letter_of(axis)))) continue;
    stands = reached;
    text += fmt::format("{}{}{:.{}f}", text.empty() ? "" : " ", letter_of(axis), number, decimals);
  }
  stands_known_ = true;
  return text;
}

/// The block's text with the node in place of its coordinates; its time is `timed_share` of the block's, or
/// that of the block where it is 0.
std::string TcpRewriter::first_line(const TcpStep& step, const Node& node, double timed_share) {
  const NcBlock& block = step.said.block;
  std::string line;
  std::size_t cursor = 0;
  bool placed = false;
  for (const NcWord& word : block.words) {
    line.append(block.text.substr(cursor, word.begin - cursor));
    cursor = word.end;
    if (kTcpLetters.find(word.letter) != std::string_view::npos) {
      if (!placed) line += coordinates(node, &step.said.commands);
      while (placed && !line.empty() && line.back() == ' ') line.pop_back();
      placed = true;
    } else if (word.letter == 'F' && timed_share > 0.0) {
      line += fmt::format("F{:.6g}", inverse_time(word.value, timed_share));
    } else {
      line.append(block.text.substr(word.begin, word.end - word.begin));
    }
  }
  return line.append(block.text.substr(cursor));
}

/// The block with the first node, then a line per further node.
void TcpRewriter::write_block(const TcpStep& step, const std::vector<Node>& nodes) {
  const NcBlock& block = step.said.block;
  if (step.said.commands.stop && nodes.size() > 1)
    place().refuse("the block stops the program and must become several lines",
                   "write M0, M1, M2, M30 or M60 in a block of its own");
  const bool timed =
      step.feed && nodes.size() > 1 && interpreter_.state().feed_mode == NcFeedMode::InverseTime;
  const std::string end = block.line_end.empty() ? "\n" : std::string(block.line_end);
  const double share = std::max(nodes.front().t, std::numeric_limits<double>::min());
  written_.push_back({first_line(step, nodes.front(), timed ? share : 0.0) + end, nodes.front().t});
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    std::string line = coordinates(nodes[i], nullptr);
    if (line.empty()) continue;
    if (timed)
      line +=
          fmt::format(" F{:.6g}", inverse_time(step.said.commands.value('F'), nodes[i].t - nodes[i - 1].t));
    written_.push_back({(block.deletable ? "/" : "") + line + end, nodes[i].t});
  }
}

/// Above the program, below its first %.
void TcpRewriter::write_header(std::string_view line) {
  if (is_compensated(line))
    place().refuse("the program has been compensated already", "compensate the original program");
  if (header_written_ || options_.header.empty()) return;
  header_written_ = true;
  put_header(options_.header, line, written_);
}

void TcpRewriter::rewrite(std::string_view line, const Sink& sink) {
  written_.clear();
  const TcpStep& step = interpreter_.execute(line);
  try {
    if (step.moves) {
      require_identified(step);
      move(step);
    } else {
      written_.push_back({std::string(line), 0.0});
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    place().refuse(error.what(), "check rotary positions and work offsets");
  }
  if (step.outside) ++summary_.copied_rapids;
  for (const NcWrittenLine& written : written_) require_readable(written.text, line, place());
  write_header(line);
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

ErrorsOfOffset tcp_errors_of(const FitResult& result, const std::string& tool, const Conditions& conditions) {
  Tool named;
  if (const auto index = result.machine.tool_index(tool)) named = result.machine.tools[*index];
  return [&result, named, conditions](const Eigen::Vector3d& offset) {
    Tool carried = named;
    carried.offset = offset;
    return joint_and_tool_errors(result, carried, conditions);
  };
}

}  // namespace volcal
