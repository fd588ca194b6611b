#include "volcal/identify/solve/priors/resolution.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/kinematics/rotary_datum.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

constexpr double kDistinctShare = 1.0 / 200.0;  // of the stretch
constexpr double kLeastMoved = 1e-3;            // of the travel: less is an axis that stands still
constexpr double kLeastRange = 1e-12;           // m or rad: an axis that did not move
constexpr double kGrowth = 2.0;                 // of a piece outside the measured part, to the next

/// Of readings that are not left out.
template <class Visit>
void for_each_measured_position(const Campaign& campaign, AxisName axis, const Visit& visit) {
  for (const Setup& setup : campaign.setups) {
    const std::vector<bool> left_out = setup.rows_left_out();
    const std::vector<double>& own = setup.readings.position[index_of(axis)];
    for (std::size_t row = 0; row < own.size(); ++row) {
      if (!left_out[row]) visit(own[row]);
    }
  }
}

int distinct_intervals(const Campaign& campaign, AxisName axis, double stretch) {
  const double resolution = stretch * kDistinctShare;
  std::set<long> distinct;
  for_each_measured_position(campaign, axis, [&](double q) { distinct.insert(std::lround(q / resolution)); });
  return std::clamp(static_cast<int>(distinct.size()) - 1, 1, kMaxAutomaticIntervals);
}

/// Positions that differ by more than a share of a turn, whole turns apart being the same.
int distinct_angles(const Campaign& campaign, AxisName axis) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const long steps = std::lround(1.0 / kDistinctShare);
  std::set<long> distinct;
  for_each_measured_position(campaign, axis, [&](double q) {
    const long step = std::lround((q / kTurn - std::floor(q / kTurn)) * static_cast<double>(steps));
    distinct.insert(step % steps);
  });
  return static_cast<int>(distinct.size());
}

/// As many harmonics as angles can tell apart.
int automatic_harmonics(const Campaign& campaign, AxisName axis) {
  return std::clamp((distinct_angles(campaign, axis) - 1) / 2, 1, kMostAutomaticHarmonics);
}

/// Of a function that was smoothed when its values were identified, the choice that led to them.
FunctionSpec as_chosen(FunctionSpec function) {
  if (!function.smoothed) return function;
  function.smoothed = false;
  function.coefficients.clear();
  if (find_basis(function.basis)->has_automatic_degree) {
    function.automatic_degree = true;
  } else {
    function.knots = KnotChoice::Automatic;
    function.breakpoints.clear();
  }
  return function;
}

FunctionSpec resolved(FunctionSpec function, ErrorSymbol symbol, const Campaign& campaign) {
  function = as_chosen(std::move(function));
  if (function.automatic_degree) function.degree = automatic_harmonics(campaign, symbol.axis);
  const BasisKind* kind = find_basis(function.basis);
  if (kind == nullptr || !kind->uses_knots || function.knots == KnotChoice::Explicit) return function;
  const Axis& axis = campaign.machine.axis(symbol.axis);
  function.breakpoints = function.knots == KnotChoice::IntervalCount
                             ? uniform_breakpoints(axis, function.intervals)
                             : resolved_stretch(campaign, symbol.axis).breakpoints(axis);
  return function;
}

/// Ends of pieces from `edge` on towards `end`, that included; the first is longer than `piece`.
std::vector<double> growing_pieces(double edge, double end, double piece) {
  std::vector<double> ends;
  const double sense = end > edge ? 1.0 : -1.0;
  for (double left = std::abs(end - edge); left > 0.0;) {
    piece *= kGrowth;
    const double length = left < (1.0 + kGrowth) * piece ? left : piece;
    left -= length;
    ends.push_back(left > 0.0 ? end - sense * left : end);
  }
  return ends;
}

}  // namespace

std::vector<double> ResolvedStretch::breakpoints(const Axis& axis) const {
  if (is_whole(axis)) return uniform_breakpoints(axis, intervals);
  const double piece = (max - min) / intervals;
  std::vector<double> all = growing_pieces(min, axis.travel_min, piece);
  std::ranges::reverse(all);
  for (int i = 0; i <= intervals; ++i) all.push_back(i < intervals ? min + piece * i : max);
  std::ranges::copy(growing_pieces(max, axis.travel_max, piece), std::back_inserter(all));
  return all;
}

ResolvedStretch resolved_stretch(const Campaign& campaign, AxisName name) {
  const Axis& axis = campaign.machine.axis(name);
  ResolvedStretch whole{axis.travel_min, axis.travel_max, distinct_intervals(campaign, name, axis.travel())};
  const MeasuredRange measured = measured_range(campaign, name);
  if (!(measured.max - measured.min > kLeastMoved * axis.travel())) return whole;
  ResolvedStretch part{measured.min, measured.max,
                       distinct_intervals(campaign, name, measured.max - measured.min)};
  const double gap = std::max(measured.min - axis.travel_min, axis.travel_max - measured.max);
  if (part.intervals == 1 || gap <= axis.travel() / whole.intervals) return whole;
  const double piece = (part.max - part.min) / part.intervals;
  if (part.min - axis.travel_min <= piece) part.min = axis.travel_min;
  if (axis.travel_max - part.max <= piece) part.max = axis.travel_max;
  return part;
}

ResolvedStretch resolved_stretch(const Campaign& campaign, AxisName axis,
                                 const std::vector<double>& breakpoints) {
  const ResolvedStretch stretch = resolved_stretch(campaign, axis);
  const Axis& own = campaign.machine.axis(axis);
  if (stretch.breakpoints(own) == breakpoints) return stretch;
  return {own.travel_min, own.travel_max, static_cast<int>(breakpoints.size()) - 1};
}

int automatic_intervals(const Campaign& campaign, AxisName axis) {
  return resolved_stretch(campaign, axis).intervals;
}

namespace {

/// What effects leave to the readings.
void resolve_effects(const Campaign& campaign, ModelSpec& spec) {
  const auto is_open = [](const EffectSpec& effect) {
    const EffectKind* kind = find_effect(effect.kind);
    return kind != nullptr && kind->is_open(effect);
  };
  if (std::ranges::none_of(spec.effects, is_open)) return;
  ModelSpec alone = spec;
  alone.effects.clear();
  const MeasurementModel model(campaign, alone);
  const std::vector<SetupView> views = setup_views(campaign, model.binding(), model.chain());
  for (EffectSpec& effect : spec.effects) {
    if (is_open(effect)) effect = find_effect(effect.kind)->resolved(effect, views, spec.file);
  }
}

}  // namespace

ModelSpec resolve_knots(const ModelSpec& spec, const Campaign& campaign) {
  const Machine& machine = campaign.machine;
  const std::vector<AxisName> moving = moving_rotary_axes(campaign);
  ModelSpec result = spec;
  if (!moving.empty()) result = with_rotary_errors(machine, spec, moving, independent_locations(machine));
  for (const ErrorSymbol symbol : modelled_motions(machine, result))
    result.functions[symbol] = resolved(result.function(symbol), symbol, campaign);
  resolve_effects(campaign, result);
  result.measured.clear();  // what is measured is the campaign's
  return result;
}

MeasuredRange measured_range(const Campaign& campaign, AxisName axis) {
  MeasuredRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for_each_measured_position(campaign, axis, [&](double q) {
    range.min = std::min(range.min, q);
    range.max = std::max(range.max, q);
  });
  return range;
}

double MeasuredRange::scaled(double position) const {
  return std::clamp(2.0 * (position - min) / std::max(kLeastRange, max - min) - 1.0, -1.0, 1.0);
}

}  // namespace volcal
