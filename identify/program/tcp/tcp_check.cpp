#include "volcal/identify/program/tcp/tcp_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace volcal {

TcpCheck::TcpCheck(const Machine& machine, ErrorsOfOffset errors, NcSetup setup,
                   FunctionalPoint functional_point)
    : machines_(machine, std::move(errors), false),
      original_(machine, setup, functional_point, "the program"),
      written_(machine, std::move(setup), std::move(functional_point), "the rewritten program") {}

void TcpCheck::Sum::take(const TcpMachine::Left& left, double weight, std::int64_t line) {
  squares += weight * left.point * left.point;
  axis_squares += weight * left.axis * left.axis;
  errors.axis_max = std::max(errors.axis_max, left.axis);
  if (left.point <= errors.max) return;
  errors.max = left.point;
  errors.line_of_max = line;
}

TcpErrors TcpCheck::figures(const Sum& sum) const {
  TcpErrors errors = sum.errors;
  if (!(weight_ > 0.0)) return errors;
  errors.rms = std::sqrt(sum.squares / weight_);
  errors.axis_rms = std::sqrt(sum.axis_squares / weight_);
  return errors;
}

/// The rewriting goes from `begin` to `end` where the original goes from t_from to t_to.
void TcpCheck::compare(const TcpStep& original, const TcpPose& begin, const TcpPose& end, double t_from,
                       double t_to) {
  const double part = t_to - t_from;
  if (part <= 0.0) return;
  const TcpMachine& machine = machines_.with(original_.tool_offset());
  const double length = (original.to.point_w - original.from.point_w).norm();
  const double turn = (original.to.rotary - original.from.rotary).norm();
  const double weight = part * std::hypot(length, kTcpLever * turn);
  length_ += part * length;
  weight_ += weight;
  const double places = std::ceil(part * tcp_places(original.from, original.to));
  weighted_shares(static_cast<std::size_t>(places), shares_);
  shares_.push_back({1.0, 0.0});  // the end counts for the maximum alone
  for (const auto& [share, share_of_weight] : shares_) {
    const double t = t_from + share * part;
    const TcpPose meant = TcpPose::between(original.from, original.to, t);
    const ApproachDirection directions = machine.directions(original.from, original.to, t, directions_);
    const std::int64_t line = original_.place().line;
    before_.take(machine.left(meant, meant, directions), share_of_weight * weight, line);
    after_.take(machine.left(TcpPose::between(begin, end, share), meant, directions),
                share_of_weight * weight, line);
  }
}

void TcpCheck::add(std::string_view line, std::span<const NcWrittenLine> written) {
  const TcpStep& original = original_.execute(line);
  double reached = 0.0;
  for (const NcWrittenLine& text : written) {
    const TcpPose stood = stands_;
    const TcpStep& step = written_.execute(text.text);
    if (step.moves) stands_ = step.to;
    if (original.feed) compare(original, step.first ? step.to : stood, stands_, reached, text.at);
    reached = std::max(reached, text.at);
  }
  if (original.feed) compare(original, stands_, stands_, reached, 1.0);
  if (!original.moves) return;
  const TcpMachine& machine = machines_.with(original_.tool_offset());
  directions_ = machine.directions(original.from, original.to, 1.0, directions_);
}

}  // namespace volcal
