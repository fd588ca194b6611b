// Periodic errors of drive and scale: lead error of a ball screw, pinion on a rack, interpolation of an
// encoder.
#include <cmath>
#include <numbers>
#include <vector>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/sines.h"

namespace volcal {
namespace {

struct PeriodRange {
  const char* kind;
  const char* label;
  double usual;  ///< m
  double min;
  double max;
  double finest_scan = 4e-3;  ///< m: ranges above are scanned evenly, others at the usual signal periods
  bool grows = false;         ///< in proportion to the travel from home
  double least_travel = 0.0;  ///< m: shorter axes have no such drive
};
constexpr PeriodRange kLead = {"lead-error", "lead error", 10e-3, 4e-3, 60e-3};
constexpr PeriodRange kGrowingLead = {.kind = "growing-lead-error",
                                      .label = "growing lead error",
                                      .usual = 10e-3,
                                      .min = 4e-3,
                                      .max = 60e-3,
                                      .grows = true};
/// Circumference of the pitch circle, pi times module times teeth: 20 teeth of module 1 to 32 of module 6.
/// Ball screws end where they whip, at some 2.5 m.
constexpr PeriodRange kRack = {.kind = "rack-error",
                               .label = "rack error",
                               .usual = 125e-3,
                               .min = 60e-3,
                               .max = 600e-3,
                               .least_travel = 2.5};
constexpr PeriodRange kEncoder = {"encoder-subdivision", "subdivision error", 1e-3, 20e-6, 3e-3};

/// Evenly spaced frequencies, half a period over the travel apart: no line can hide between them.
std::vector<Eigen::VectorXd> periods(double travel, const PeriodRange& range) {
  std::vector<Eigen::VectorXd> values;
  const double step = 0.5 / travel;
  for (double frequency = 1.0 / range.max; frequency <= 1.0 / range.min; frequency += step) {
    values.emplace_back(Eigen::VectorXd::Constant(1, 1.0 / frequency));
  }
  return values;
}

/// Signal periods of common scales, and their second harmonics; what lies between is not looked for.
std::vector<Eigen::VectorXd> usual_periods() {
  std::vector<Eigen::VectorXd> values;
  for (const double micrometres : {10.0, 20.0, 40.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0}) {
    values.emplace_back(Eigen::VectorXd::Constant(1, micrometres * kMetrePerMicrometre));
  }
  return values;
}

/// Cosine and sine at every position, rows x 2.
Eigen::MatrixXd waves(const Eigen::ArrayXd& position, double period) {
  const Eigen::ArrayXd angle = position * (2.0 * std::numbers::pi / period);
  Eigen::MatrixXd values(position.size(), 2);
  write_cosines_and_sines(angle.data(), static_cast<std::size_t>(angle.size()), values.col(0).data(),
                          values.col(1).data());
  return values;
}

KeySchema wave_key(const std::string& stem, const std::string& unit, const PeriodRange& range) {
  const std::string name = stem == "cos" ? "cosine" : "sine";
  return {.key = stem + "_" + unit + (range.grows ? "_per_m" : ""),
          .help = "amplitude of the " + name + (range.grows ? " per metre of travel" : "") +
                  (unit == "um" ? ", displacements" : ", rotations"),
          .plausible_min = 1e-6,
          .plausible_max = 1e4};
}

std::vector<KeySchema> periodic_keys(const PeriodRange& range) {
  return joined({{symbol_key("error motion: EXX, EYY, EZZ, or another motion of the axis")},
                 shape_keys("period", "mm", "period in positions of the axis"),
                 {wave_key("cos", "um", range), wave_key("cos", "urad", range), wave_key("sin", "um", range),
                  wave_key("sin", "urad", range)}});
}

std::unique_ptr<FormulaEffect> make_periodic(const EffectTable& table, const PeriodRange& range) {
  const ErrorSymbol symbol = table.symbol();
  const std::string label = range.label + (" " + symbol.name());
  const std::string per = range.grows ? "per_m" : "";
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{range.kind, symbol, position_of(symbol.axis), range.grows ? "growing wave" : "periodic"},
      std::vector{motion_amplitude(table, label, symbol, per, "cos"),
                  motion_amplitude(table, label, symbol, per, "sin")},
      [symbol, grows = range.grows](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        const Eigen::ArrayXd position = positions_from_home(view, symbol.axis).array();
        Eigen::MatrixXd drivers = waves(position, shape[0]);
        if (grows) drivers.array().colwise() *= position;
        return drivers;
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
  const EffectShape period =
      shape_parameter(table, label + ": period", "period", "mm", range.usual, range.min, range.max);
  if (!(period.value > 0.0)) table.fail("its period is not positive", "give period_mm = 10.0");
  effect->add_shape(period);
  effect->scan_by([axis = symbol.axis, range](const Campaign& campaign) {
    return range.max > range.finest_scan ? periods(campaign.machine.axis(axis).travel(), range)
                                         : usual_periods();
  });
  return effect;
}

std::vector<EffectSpec> positioning_motions(const Campaign& campaign, const char* kind,
                                            double least_travel = 0.0) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    if (symbol.is_positioning() && campaign.machine.axis(symbol.axis).travel() >= least_travel)
      specs.push_back(effect_spec(kind, {{"symbol", symbol.name()}}));
  }
  return specs;
}

}  // namespace

const EffectKind& lead_error_effect() {
  static const FormulaKind kind(
      {.kind = kLead.kind,
       .summary = "a ball screw repeats its error with its lead and the lead's fractions",
       .plain = "The position repeats its error with every turn of the ball screw.",
       .usual_causes = "a screw that wobbles because it or its bearing is not centred; a "
                       "coupling or motor encoder that sits off centre; a bent screw",
       .source = "ISO 3408-3 (periodic travel deviation of ball screws)",
       .keys = periodic_keys(kLead)},
      [](const EffectTable& table) { return make_periodic(table, kLead); },
      [](const Campaign& campaign) { return positioning_motions(campaign, kLead.kind); });
  return kind;
}

const EffectKind& growing_lead_error_effect() {
  static const FormulaKind kind(
      {.kind = kGrowingLead.kind,
       .summary = "the error that repeats with a screw's lead grows in proportion to the travel from home: a "
                  "nut that is out of line with its screw, a bearing at one end",
       .plain = "The position repeats its error with every turn of the ball screw, and the error grows "
                "along the travel.",
       .usual_causes = "a bent screw; a screw whose free end whips; a bearing seat out of line at one end",
       .source = "ISO 3408-3 (periodic travel deviation of ball screws)",
       .keys = periodic_keys(kGrowingLead)},
      [](const EffectTable& table) { return make_periodic(table, kGrowingLead); },
      [](const Campaign& campaign) { return positioning_motions(campaign, kGrowingLead.kind); });
  return kind;
}

const EffectKind& rack_error_effect() {
  static const FormulaKind kind(
      {.kind = kRack.kind,
       .summary = "a rack repeats its error with every turn of the pinion that runs on it",
       .plain = "The position repeats its error with every turn of the pinion on its rack.",
       .usual_causes = "a pinion that is not centred on its shaft; a gear box or motor encoder that sits off "
                       "centre; racks that were joined at a wrong pitch, where the period is a rack's length",
       .source = "ISO 1328-1 (total cumulative pitch deviation of a gear, over a turn)",
       .keys = periodic_keys(kRack)},
      [](const EffectTable& table) { return make_periodic(table, kRack); },
      [](const Campaign& campaign) { return positioning_motions(campaign, kRack.kind, kRack.least_travel); },
      [](const Campaign& campaign) { return positioning_motions(campaign, kRack.kind); });
  return kind;
}

const EffectKind& encoder_subdivision_effect() {
  static const FormulaKind kind(
      {.kind = kEncoder.kind,
       .summary = "a scale's interpolation repeats its error within each signal period",
       .plain = "The position repeats its error within every signal period of the scale.",
       .usual_causes = "a dirty scale; a reading head at a wrong distance or angle; signals whose "
                       "offset, gain or phase was not adjusted; wrong interpolation in the control",
       .source = "Heydemann, Appl. Opt. 20 (1981) 3382: errors of quadrature signals",
       .keys = periodic_keys(kEncoder)},
      [](const EffectTable& table) { return make_periodic(table, kEncoder); },
      [](const Campaign& campaign) { return positioning_motions(campaign, kEncoder.kind); });
  return kind;
}

}  // namespace volcal
