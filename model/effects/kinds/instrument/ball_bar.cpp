// What shows on circles: the length of the ball-bar, and axes that follow their commands late.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

bool has_bar(const Setup& setup) { return traits_of(setup).has_bar; }

/// Axes that follow their commands late show on the way round the centre ball alone.
bool reads_circles(const Setup& setup) { return has_bar(setup) && traits_of(setup).reads_in_motion; }

void check_bar(const Campaign& campaign, const SourcePlace& place) {
  if (std::ranges::any_of(campaign.setups, has_bar)) return;
  throw InputError(place, "no setup is a ball-bar", "remove the effect");
}

void check_circles(const Campaign& campaign, const SourcePlace& place) {
  if (std::ranges::any_of(campaign.setups, reads_circles)) return;
  throw InputError(place, "no setup is a ball-bar", "remove the effect");
}

std::unique_ptr<FormulaEffect> make_ball_bar_length(const EffectTable& table) {
  const std::string label = "ball-bar length";
  const Variable bar{.kind = Variable::Kind::Instrument, .subject = instrument_with_bar()};
  return std::make_unique<FormulaEffect>(
      EffectName{"ball-bar-length", TargetName::of_readings(), EffectDriver::called(bar.subject, {}, {bar}),
                 "step"},
      std::vector{reading_amplitude(table, label, "amplitude_um")},
      [](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return constant(view, has_bar(view.setup) ? 1.0 : 0.0);
      },
      check_bar);
}

std::vector<EffectSpec> ball_bar_lengths(const Campaign& campaign) {
  if (std::ranges::none_of(campaign.setups, has_bar)) return {};
  return {effect_spec("ball-bar-length", {})};
}

/// A tenth of the travel of the others: a circle in another plane moves along an axis by its centre's error.
bool moves(const Setup& setup, AxisName axis) {
  const auto travel = [&](AxisName each) {
    const auto& position = setup.readings.position[index_of(each)];
    if (position.empty()) return 0.0;
    const auto [low, high] = std::ranges::minmax_element(position);
    return *high - *low;
  };
  double largest = 0.0;
  for (const AxisName each : kAllAxes) {
    if (!is_rotary(each)) largest = std::max(largest, travel(each));
  }
  return travel(axis) > 0.1 * largest;
}

/// Setups with circles that move all of these axes.
std::vector<const Setup*> circles_with(const Campaign& campaign, const std::vector<AxisName>& axes) {
  std::vector<const Setup*> setups;
  for (const Setup& setup : campaign.setups) {
    if (reads_circles(setup) && std::ranges::all_of(axes, [&](AxisName axis) { return moves(setup, axis); }))
      setups.push_back(&setup);
  }
  return setups;
}

bool record_feed(const std::vector<const Setup*>& setups) {
  return std::ranges::all_of(setups, [](const Setup* setup) { return !setup->readings.feed.empty(); });
}

/// By enough to tell an effect that grows with the feed from one that does not.
bool vary_feed(const std::vector<const Setup*>& setups) {
  constexpr double kDiffer = 0.01;
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const Setup* setup : setups) {
    for (const double feed : setup->readings.feed) {
      low = std::min(low, feed);
      high = std::max(high, feed);
    }
  }
  return high > (1.0 + kDiffer) * low;
}

/// Whether the effect is in proportion to the feed: its amplitude is a time then, else a displacement.
bool by_feed(const EffectTable& table) {
  const auto by = table.spec.options.text("by");
  if (by && *by != "feed") table.fail("by = \"" + *by + "\"", "write by = \"feed\", or leave it out");
  return by.has_value();
}

/// Feed of every reading in m/s, 0 where not recorded; 1 for effects that do not depend on it.
Eigen::VectorXd feed_factor(const SetupView& view, bool feed) {
  if (!feed) return constant(view, 1.0);
  const auto& column = view.setup.readings.feed;
  if (column.empty()) return constant(view, 0.0);
  return Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
}

void check_feed(const Campaign& campaign, const std::string& label, const SourcePlace& place) {
  for (const Setup& setup : campaign.setups) {
    if (reads_circles(setup) && !setup.readings.feed.empty()) return;
  }
  throw InputError(place, label + ": no setup of a ball-bar records the feed",
                   "add the column feed_mm_min, or leave by = \"feed\" out");
}

FormulaEffect::Count without_feed() {
  return [](const SetupView& view) {
    return reads_circles(view.setup) && view.setup.readings.feed.empty() ? view.rows() : std::size_t{0};
  };
}

/// Twice the product of the coordinates in the circle's plane, over the square of the radius (sin 2 phi),
/// with the sense of the circle.
Eigen::VectorXd twice_per_turn(const SetupView& view, AxisName first, AxisName second) {
  Eigen::VectorXd driver = constant(view, 0.0);
  const auto centre = view.setup.options.vector("centre");
  if (!reads_circles(view.setup) || !centre) return driver;
  const Eigen::VectorXd dir_1 = directions(view, first), dir_2 = directions(view, second);
  for (Eigen::Index row = 0; row < driver.size(); ++row) {
    const Eigen::Vector3d radius = view.nominal_point_w[static_cast<std::size_t>(row)] - *centre;
    const double x = radius[direction_of(first)], y = radius[direction_of(second)];
    // Counter-clockwise, x falls where y is positive: the sense follows from either direction.
    const double sense = 0.5 * (dir_2[row] * (x > 0 ? 1 : -1) - dir_1[row] * (y > 0 ? 1 : -1));
    // By the whole bar: at the poles of a circle in another plane x and y are as small as the centre's error.
    driver[row] = sense * 2.0 * x * y / radius.squaredNorm();
  }
  return driver;
}

/// By what the directions of both axes say together, not by each.
EffectDriver sense_of_circle(AxisName first, AxisName second, bool feed) {
  std::vector<Variable> variables;
  if (feed) variables.push_back({Variable::Kind::Feed});
  return EffectDriver::called(
      feed ? "dir feed" : "dir", variables,
      {direction_of_approach(std::min(first, second)), direction_of_approach(std::max(first, second))});
}

/// A lag of one axis behind the other makes an ellipse at 45 degrees that turns with the sense of the circle;
/// its time constant less that of the other, dT, changes the radius by 1/2 v dT sin 2 phi.
std::unique_ptr<FormulaEffect> make_servo_mismatch(const EffectTable& table) {
  const AxisName first = table.axis("axis");
  const AxisName second = table.axis("second_axis");
  const bool feed = by_feed(table);
  const std::string plane{letter_of(std::min(first, second)), letter_of(std::max(first, second))};
  const std::string label = "servo mismatch " + plane + (feed ? " by feed" : "");
  if (first == second) table.fail("its two axes are the same", "name the two axes of the circle's plane");
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"servo-mismatch", TargetName::called(plane), sense_of_circle(first, second, feed),
                 "sin(2 phi)"},
      std::vector{reading_amplitude(table, label, feed ? "amplitude_ms" : "amplitude_um")},
      [first, second, feed](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const Eigen::VectorXd driver = twice_per_turn(view, first, second);
        return feed ? Eigen::VectorXd(0.5 * driver.cwiseProduct(feed_factor(view, feed))) : driver;
      },
      [feed, label](const Campaign& campaign, const SourcePlace& place) {
        check_circles(campaign, place);
        if (feed) check_feed(campaign, label, place);
      });
  if (feed) effect->count_unrecorded(without_feed());
  return effect;
}

std::vector<EffectSpec> servo_mismatches(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  const auto axes = campaign.machine.linear_axes();
  for (const AxisName first : axes) {
    for (const AxisName second : axes) {
      const auto circles = circles_with(campaign, {first, second});
      if (first >= second || circles.empty()) continue;
      EffectSpec spec = effect_spec("servo-mismatch", {{"axis", std::string(1, letter_of(first))},
                                                       {"second_axis", std::string(1, letter_of(second))}});
      specs.push_back(spec);
      if (!record_feed(circles) || !vary_feed(circles)) continue;
      spec.options.set("by", "feed");
      specs.push_back(spec);
    }
  }
  return specs;
}

/// Velocity of the axis as a share of that along the circle, with its sign: 0 where it turns.
Eigen::VectorXd share_of_velocity(const SetupView& view, AxisName axis) {
  Eigen::VectorXd share = constant(view, 0.0);
  const auto centre = view.setup.options.vector("centre");
  if (!reads_circles(view.setup) || !centre || !moves(view.setup, axis)) return share;
  const Eigen::VectorXd direction = directions(view, axis);
  for (Eigen::Index row = 0; row < share.size(); ++row) {
    const Eigen::Vector3d radius = view.nominal_point_w[static_cast<std::size_t>(row)] - *centre;
    const double along = radius[direction_of(axis)];
    share[row] = direction[row] * std::sqrt(std::max(0.0, 1.0 - along * along / radius.squaredNorm()));
  }
  return share;
}

std::unique_ptr<FormulaEffect> make_following_error(const EffectTable& table) {
  const AxisName axis = table.axis("axis");
  if (is_rotary(axis)) table.fail("circles move no rotary axis", "name a linear axis");
  const bool feed = by_feed(table);
  const ErrorSymbol symbol{positioning_component(axis), axis};
  const std::string label = std::string("following error ") + letter_of(axis) + (feed ? " by feed" : "");
  std::vector<Variable> driver{direction_of_approach(axis)};
  if (feed) driver.push_back({Variable::Kind::Feed});
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"following-error", symbol, EffectDriver(driver), "cos(phi)"},
      std::vector{EffectAmplitude{.label = label,
                                  .target = {TargetKind::Motion, symbol, 0},
                                  .key = feed ? "amplitude_ms" : "amplitude_um",
                                  .guess = table.number("amplitude", 0.0)}},
      [axis, feed](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return -share_of_velocity(view, axis).cwiseProduct(feed_factor(view, feed));
      },
      [axis, feed, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, axis, label, place);
        check_circles(campaign, place);
        if (feed) check_feed(campaign, label, place);
      });
  if (feed) effect->count_unrecorded(without_feed());
  return effect;
}

/// Of an axis that circles move in two planes: in one plane alone it is the servo mismatch.
std::vector<EffectSpec> following_errors(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  const auto axes = campaign.machine.linear_axes();
  for (const AxisName axis : axes) {
    const auto planes = std::ranges::count_if(axes, [&](AxisName other) {
      return other != axis && !circles_with(campaign, {axis, other}).empty();
    });
    if (planes < 2) continue;
    EffectSpec spec = effect_spec("following-error", {{"axis", std::string(1, letter_of(axis))}});
    if (record_feed(circles_with(campaign, {axis}))) spec.options.set("by", "feed");
    specs.push_back(spec);
  }
  return specs;
}

}  // namespace

const EffectKind& ball_bar_length_effect() {
  static const FormulaKind kind(
      {.kind = "ball-bar-length",
       .summary = "the calibrated length of the ball-bar is wrong",
       .plain = "All circles of the ball-bar are too large or too small by the same amount.",
       .usual_causes = "the bar was calibrated at another temperature; a seat or an extension was changed "
                       "after calibration; a worn ball or cup",
       .source = "ISO 230-4 (circular tests)",
       .keys = {amplitude_key("amplitude_um", "reading too long by this")}},
      make_ball_bar_length, ball_bar_lengths);
  return kind;
}

const EffectKind& servo_mismatch_effect() {
  static const FormulaKind kind(
      {.kind = "servo-mismatch",
       .summary = "one axis follows the other late: circles become ellipses at 45 degrees whose direction "
                  "depends on the sense of rotation",
       .plain = "Circles become ellipses at 45 degrees whose direction turns with the sense of the path: one "
                "axis follows its command later than the other.",
       .usual_causes = "position gains of the two axes that differ; feedforward set for one axis only; an "
                       "axis that carries more load than its drive was tuned for",
       .source = "ISO 230-4, annex; Kakino et al. (1993): servo mismatch in circular tests",
       .keys = {axis_key("axis", "first axis of the circle"), axis_key("second_axis", "second axis"),
                text_key("by", "\"feed\": in proportion to the feed; absent = the same at every feed", false),
                amplitude_key("amplitude_um", "amplitude of the radius, counter-clockwise"),
                amplitude_key("amplitude_ms", "by feed: time by which the first axis is later")}},
      make_servo_mismatch, servo_mismatches);
  return kind;
}

const EffectKind& following_error_effect() {
  static const FormulaKind kind(
      {.kind = "following-error",
       .summary = "an axis follows its command late, in every plane in which circles move it",
       .plain = "An axis is late on its path, by the more the faster it moves.",
       .usual_causes = "a low position gain; feedforward switched off or mistuned; friction or a load that "
                       "the drive was not tuned for",
       .source = "ISO 230-4, annex; Kakino et al. (1993): servo mismatch in circular tests",
       .keys = {axis_key("axis", "axis that is late"),
                text_key("by", "\"feed\": in proportion to its velocity; absent = to its share of the feed",
                         false),
                amplitude_key("amplitude_um", "how far it is behind at full feed along the axis"),
                amplitude_key("amplitude_ms", "by feed: how late it is")}},
      make_following_error, following_errors);
  return kind;
}

}  // namespace volcal
