#include "volcal/identify/program/nc_rewriter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "volcal/identify/program/program_header.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kShareOfJumps = 0.25;    ///< of the tolerance
constexpr double kTravelRounding = 1e-9;  // m

void check_tolerance_of_path(const char* option, double tolerance) {
  if (std::isfinite(tolerance) && tolerance > 0.0) return;
  throw InputError({}, fmt::format("{} {:g} is out of range", option, tolerance / kMetrePerMicrometre),
                   "give a positive number of um");
}

NcRewriteOptions checked_options(NcRewriteOptions options) {
  check_rewrite_options(options);
  return options;
}

}  // namespace

void check_rewrite_options(const NcRewriteOptions& options) {
  check_tolerance_of_path("--tolerance-um", options.tolerance);
  check_tolerance_of_path("--arc-tolerance-um", options.arc_tolerance);
  if (options.decimals_mm < kFewestDecimals || options.decimals_mm > kMostDecimals)
    throw InputError({}, fmt::format("--decimals {} is out of range", options.decimals_mm),
                     fmt::format("give {} to {}", kFewestDecimals, kMostDecimals));
}

NcRewriter::NcRewriter(ProgramErrors errors, NcSetup setup, FunctionalPoint functional_point,
                       NcRewriteOptions options, std::string file)
    : errors_(std::move(errors)),
      interpreter_(std::move(setup), std::move(file)),
      functional_point_(std::move(functional_point)),
      options_(checked_options(std::move(options))),
      writer_(interpreter_.setup(), options_.decimals_mm) {
  for (const AxisName axis : kLinearAxes) {
    if (!errors_.machine.has_axis(axis)) continue;
    low_[direction_of(axis)] = errors_.machine.axis(axis).travel_min;
    high_[direction_of(axis)] = errors_.machine.axis(axis).travel_max;
  }
  commanded_ = writer_.state().position;
}

void NcRewriter::use_functional_point() {
  const Eigen::Vector3d offset = functional_point_.at(interpreter_.state());
  auto& points = summary_.functional_points;
  const auto found = std::ranges::find(points, offset);
  const auto index = static_cast<std::size_t>(found - points.begin());
  if (found == points.end()) {
    points.push_back(offset);
    splitters_.push_back(std::make_unique<PathSplitter>(errors_, offset, options_.tolerance));
  }
  splitter_ = splitters_[index].get();
}

Eigen::Vector3d NcRewriter::solve(const Eigen::Vector3d& position) {
  if (last_.splitter == splitter_ && last_.position == position && last_.directions == directions_)
    return last_.command;
  return splitter_->solver().command(position, directions_);
}

void NcRewriter::require_inside(const Eigen::Vector3d& position, const char* what) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!interpreter_.state().known[i]) continue;
    const bool below = position[k] < low_[k] - kTravelRounding;
    if (!below && !(position[k] > high_[k] + kTravelRounding)) continue;
    interpreter_.place().refuse(
        fmt::format(
            "{} is at {} = {:.4f} mm in machine coordinates, outside the identified travel {:g} to {:g} mm",
            what, kNcAxisLetters[i], position[k] / kMetrePerMillimetre, low_[k] / kMetrePerMillimetre,
            high_[k] / kMetrePerMillimetre),
        "check work offsets, tool lengths and units; errors are not known there");
  }
}

/// Commands of feeds must stay inside the travel; rapids are held at its ends.
void NcRewriter::add_target(NcMotionKind kind, const Eigen::Vector3d& position,
                            const Eigen::Vector3d& command, double at) {
  NcTarget& target = targets_.emplace_back();
  target.kind = kind;
  target.command = command;
  target.at = at;
  if (kind == NcMotionKind::Rapid) {
    for (int k = 0; k < 3; ++k) {
      if (interpreter_.state().known[static_cast<std::size_t>(k)])
        target.command[k] = std::clamp(command[k], low_[k], high_[k]);
    }
    if (target.command != command) ++summary_.clamped;
  } else {
    require_inside(command, "the corrected command");
  }
  summary_.largest_correction = std::max(summary_.largest_correction, (target.command - position).norm());
  commanded_ = target.command;
}

void NcRewriter::correct_rapid(const NcMotion& motion, double at, const std::array<bool, 3>& known_before) {
  require_inside(motion.to, "the end of the rapid");
  Eigen::Vector3d moved = motion.to - motion.from;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!known_before[i]) moved[static_cast<Eigen::Index>(i)] = 0.0;
  }
  turn_directions(moved, directions_);
  Eigen::Vector3d command = solve(motion.to);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!interpreter_.state().known[i]) command[k] = motion.to[k];
  }
  add_target(NcMotionKind::Rapid, motion.to, command, at + 1.0);
}

/// A straight piece in one set of directions.
void NcRewriter::correct_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double at,
                              double t_from, double t_to) {
  require_inside(to, "the path");
  turn_directions(to - from, directions_);
  const Eigen::Vector3d begin = solve(from);
  if ((begin - commanded_).norm() > kShareOfJumps * options_.tolerance)
    add_target(NcMotionKind::Feed, from, begin, at + t_from);
  nodes_.clear();
  splitter_->split(from, to, directions_, t_from, t_to, nodes_);
  last_ = {splitter_, to, directions_, nodes_.back().command};
  for (const PathNode& node : nodes_) {
    const double share = (node.t - t_from) / (t_to - t_from);
    add_target(NcMotionKind::Feed, from + share * (to - from), node.command, at + node.t);
  }
}

void NcRewriter::correct_arc(const NcArc& arc, double at) {
  ++summary_.arcs;
  const std::vector<double> ends = chord_ends(arc, options_.arc_tolerance);
  Eigen::Vector3d from = arc.start;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const Eigen::Vector3d to = arc.point(ends[i + 1]);
    correct_line(from, to, at, ends[i], ends[i + 1]);
    from = to;
  }
}

/// Where the program leaves the measured positions.
void NcRewriter::note_place(const NcMotion& motion) {
  const Eigen::Vector3d& to = motion.to;
  const std::int64_t line = summary_.lines_read + 1;
  if (!errors_.measured.is_beyond({to.x(), to.y(), to.z(), 0.0, 0.0, 0.0})) return;
  if (options_.within_readings)
    interpreter_.place().refuse("the motion ends beyond the positions that were measured",
                                "measure there, or leave --no-extrapolation out: the last measured error is "
                                "then held");
  if (summary_.beyond_readings++ == 0) summary_.first_beyond = line;
}

void NcRewriter::correct_motions(const NcStep& step, const std::array<bool, 3>& known_before) {
  targets_.clear();
  use_functional_point();
  for (std::size_t i = 0; i < step.motions.size(); ++i) {
    const NcMotion& motion = step.motions[i];
    const auto at = static_cast<double>(i);
    if (motion.kind == NcMotionKind::Dwell) {
      NcTarget& pause = targets_.emplace_back();
      pause.kind = NcMotionKind::Dwell;
      pause.dwell = motion.duration;
      pause.command = commanded_;
      pause.at = at + 1.0;
      continue;
    }
    ++summary_.motions;
    note_place(motion);
    if (motion.kind == NcMotionKind::Rapid) {
      correct_rapid(motion, at, known_before);
    } else if (motion.kind == NcMotionKind::Arc) {
      correct_arc(motion.arc, at);
    } else {
      correct_line(motion.from, motion.to, at, 0.0, 1.0);
    }
  }
}

/// Above the program, below its first %.
void NcRewriter::write_header(std::string_view line) {
  if (is_compensated(line))
    interpreter_.place().refuse("the program has been compensated already",
                                "compensate the original program");
  if (header_written_ || options_.header.empty()) return;
  header_written_ = true;
  put_header(options_.header, line, written_);
}

void NcRewriter::rewrite(std::string_view line, const Sink& sink) {
  written_.clear();
  const std::array<bool, 3> known_before = interpreter_.state().known;
  const NcStep& step = interpreter_.execute(line);
  const NcPlace place = interpreter_.place();
  try {
    if (step.motions.empty()) {
      writer_.copy(step, line, interpreter_.setup(), place, written_);
    } else {
      correct_motions(step, known_before);
      writer_.write(step, interpreter_.setup(), place, interpreter_.state().known, targets_, written_);
    }
  } catch (const InputError&) {
    throw;
  } catch (const PathTooLong& error) {
    place.refuse(error.what(), PathTooLong::remedy());
  } catch (const std::runtime_error& error) {
    place.refuse(error.what(), "look at the result's error tables");
  }
  if (written_.size() > 1) ++summary_.split_lines;
  for (const NcWrittenLine& written : written_) require_readable(written.text, line, place);
  write_header(line);
  ++summary_.lines_read;
  summary_.lines_written += static_cast<std::int64_t>(written_.size());
  sink(line, written_);
}

}  // namespace volcal
