#include "volcal/identify/program/nc_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace volcal {
namespace {

Eigen::Vector3d value_of(const DisplacementField& field, const Eigen::Vector3d& at,
                         const ApproachDirection& directions) {
  return field({at.x(), at.y(), at.z(), 0.0, 0.0, 0.0}, directions);
}

void add_time(const NcStep& step, PathErrors& errors) {
  for (const NcMotion& motion : step.motions) {
    if (motion.kind != NcMotionKind::Rapid) errors.feed_time += motion.duration;
  }
  const bool dwell = step.commands.non_modal == 40;
  if (dwell) errors.feed_time += step.commands.value_or_zero('P');
}

}  // namespace

NcCheck::NcCheck(ProgramErrors errors, NcSetup setup, FunctionalPoint functional_point)
    : errors_(std::move(errors)),
      functional_point_(std::move(functional_point)),
      original_(setup, "the program"),
      written_(std::move(setup), "the rewritten program") {}

void NcCheck::Sum::take(const Eigen::Vector3d& error, double weight, std::int64_t line,
                        const Eigen::Vector3d& place) {
  squares += weight * error.squaredNorm();
  if (error.norm() <= errors.max) return;
  errors.max = error.norm();
  errors.line_of_max = line;
  errors.place_of_max = place;
}

PathErrors NcCheck::figures(const Sum& sum) const {
  PathErrors errors = sum.errors;
  errors.rms = length_ > 0.0 ? std::sqrt(sum.squares / length_) : 0.0;
  return errors;
}

void NcCheck::use_functional_point() {
  const Eigen::Vector3d point = functional_point_.at(original_.state());
  if (field_point_ && *field_point_ == point) return;
  field_point_ = point;
  field_ = errors_.field(point);
}

/// Directions in which the original moves at t.
void NcCheck::turn_at(const NcMotion& original, double t) {
  if (original.kind == NcMotionKind::Arc) {
    turn_directions(original.arc.tangent(t), directions_);
  } else {
    turn_directions(original.to - original.from, directions_);
  }
}

/// Errors along one written feed motion, which stands for the original from t_from to t_to. A jump from the
/// command of one direction to that of the next stands for no path.
void NcCheck::compare(const NcMotion& original, const NcMotion& written, double t_from, double t_to) {
  if (t_to <= t_from) return;
  const double length = (t_to - t_from) * original.length();
  const std::int64_t line = original_.place().line;
  turn_at(original, 0.5 * (t_from + t_to));
  weighted_shares(parts_of_length(length), shares_);
  shares_.push_back({1.0, 0.0});  // the end counts for the maximum alone
  for (const auto& [share, weight] : shares_) {
    const Eigen::Vector3d place = original.point(t_from + share * (t_to - t_from));
    const Eigen::Vector3d command = written.point(share);
    before_.take(value_of(field_, place, directions_), weight * length, line, place);
    after_.take(command + value_of(field_, command, directions_) - place, weight * length, line, place);
  }
  length_ += length;
}

/// The direction that a rapid leaves behind.
void NcCheck::pass(const NcMotion& motion, const std::array<bool, 3>& known_before) {
  if (motion.kind != NcMotionKind::Rapid) return;
  Eigen::Vector3d moved = motion.to - motion.from;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!known_before[k]) moved[static_cast<Eigen::Index>(k)] = 0.0;
  }
  turn_directions(moved, directions_);
}

/// Nothing is written for the original from t_from to t_to.
void NcCheck::stand(const NcMotion& original, const Eigen::Vector3d& at, double t_from, double t_to) {
  if (original.kind != NcMotionKind::Feed && original.kind != NcMotionKind::Arc) return;
  NcMotion still;
  still.kind = NcMotionKind::Feed;
  still.from = still.to = at;
  compare(original, still, t_from, t_to);
}

void NcCheck::add(std::string_view line, std::span<const NcWrittenLine> written) {
  const std::array<bool, 3> known_before = original_.state().known;
  const NcStep& original = original_.execute(line);
  add_time(original, before_.errors);
  if (!original.motions.empty()) use_functional_point();
  double reached = 0.0;
  std::size_t passed = 0;
  const auto pass_until = [&](std::size_t end, const Eigen::Vector3d& stood) {
    for (; passed < end; ++passed) {
      const NcMotion& motion = original.motions.at(passed);
      pass(motion, known_before);
      stand(motion, stood, std::max(reached - static_cast<double>(passed), 0.0), 1.0);
    }
  };
  for (const NcWrittenLine& text : written) {
    const NcStep& step = written_.execute(text.text);
    add_time(step, after_.errors);
    bool feeds = false;
    for (const NcMotion& motion : step.motions) {
      if (motion.kind != NcMotionKind::Feed) continue;
      feeds = true;
      const double index = text.at > reached ? std::ceil(text.at) - 1.0 : std::floor(text.at);
      const auto i = static_cast<std::size_t>(index);
      pass_until(i, motion.from);
      compare(original.motions.at(i), motion, std::max(reached - index, 0.0), text.at - index);
    }
    if (!feeds && text.at > reached) {
      const double index = std::ceil(text.at) - 1.0;
      const auto i = static_cast<std::size_t>(index);
      pass_until(i, written_.state().position);
      stand(original.motions.at(i), written_.state().position, std::max(reached - index, 0.0),
            text.at - index);
    }
    reached = text.at;
  }
  pass_until(original.motions.size(), written_.state().position);
}

}  // namespace volcal
