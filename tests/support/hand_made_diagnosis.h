#pragma once
/// A diagnosis with numbers chosen by hand: a reversal of 4 um found, a second one that is hardly separated
/// from it, one effect that is not visible.

#include <cmath>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/variable.h"

namespace volcal::testing {

inline EffectFinding found_effect(const std::string& kind, const std::string& symbol, double value) {
  EffectFinding effect;
  effect.spec.kind = kind;
  effect.spec.options.set("symbol", symbol);
  effect.spec.options.set("amplitude", value);
  effect.label = kind + " " + symbol;
  effect.amplitudes = {{effect.label, value, 0.1e-6, 0.5e-6, "um", 1e-6}};
  effect.log10_p = -12.5;
  effect.lm = 70.25;
  effect.dof = 1;
  effect.gain = 60.0;
  effect.visible_fraction = 0.75;
  return effect;
}

inline Diagnosis hand_made_diagnosis() {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::NamedMoreRemains;
  diagnosis.findings = {
      verbatim("The missing effect is: reversal EXX"),
      {FindingCode::DiagnosisMoreOneOf, {{"effects", std::vector<std::string>{"reversal EYY"}}}}};
  EffectFinding reversal = found_effect("reversal", "EXX", 4e-6);
  reversal.name = EffectName::of_parts("reversal", "EXX", "dir_x", "step");
  EffectFinding other = found_effect("reversal", "EYY", 1e-6);
  other.name = EffectName::of_parts("reversal", "EYY", "dir_y", "step");
  EffectFinding third = found_effect("reversal", "EZZ", 0.25e-6);
  third.name = EffectName::of_parts("reversal", "EZZ", "dir_z", "step");
  third.visible_fraction = 0.01;
  third.amplitudes[0].mdb = std::nan("");
  EffectFinding finer;
  finer.name = EffectName::of_parts("resolution", "EYX", "x", "finer");
  finer.label = "EYX finer";
  finer.resolution = true;
  finer.log10_p = -3.0;
  finer.dof = 8;
  reversal.amplitudes[0].mib = 1.75e-6;
  reversal.amplitudes[0].mib_rival = other.label;
  diagnosis.effects = {reversal};
  diagnosis.one_of = {other};
  diagnosis.further_one_of = {{third, other}};
  const MemberFinding chosen{2e-6, 1e-6, 0.5e-6, 1.5e-6, 0.0, 0.0, {0.1, 0.2, 0.3}};
  diagnosis.sets.resize(2);
  diagnosis.sets[0].chosen = 0;
  diagnosis.sets[0].members = {chosen};
  diagnosis.sets[1].chosen = 1;
  diagnosis.sets[1].members = {
      {2.5e-6, 1.25e-6, 1e-6, 1.5e-6, 4e-6, 0.5e-6, {0.25, 0.5, 0.125}, {{temperature_of("air"), 21.5}}},
      chosen};
  diagnosis.sets[1].farthest = 0;
  diagnosis.sets[1].matters = true;
  diagnosis.ranking = {other, finer, third};
  diagnosis.not_visible = {third};
  diagnosis.unknown = {
      {variables_in("x t"), {}, ScanDirection::Z, ErrorSymbol{Component::B, AxisName::X}, 0.3e-6, -6.5},
      {variables_in("dir_y"), variables_in("T_air T_column"), ScanDirection::Y, {}, 0.2e-6, -5.0},
      {variables_in("y"), {}, ScanDirection::Y, {}, 0.1e-6, -4.0, 10.02e-3}};
  MeasurementProposal visit;
  visit.action = "revisit";
  visit.setup = "P1_short";
  visit.separates = {reversal.name, other.name};
  visit.readings = 48;
  visit.separation = 2.5;
  visit.gain = 3.0;
  visit.plain_gain = 1.25;
  visit.reached = 7.5;
  visit.plain = 3.125;
  visit.finding = {FindingCode::MeasurementSeparates,
                   {{"action", "revisit"},
                    {"measurement", "visit station P1 again after two hours"},
                    {"readings", std::int64_t{48}},
                    {"effects", std::vector<std::string>{"reversal EXX", "reversal EYY"}},
                    {"gain", FindingNumber{3.0}},
                    {"plain_gain", FindingNumber{1.25}}}};
  diagnosis.proposals = {visit};
  diagnosis.confounding.names = {reversal.name, other.name, third.name};
  diagnosis.confounding.labels = {reversal.label, other.label, third.label};
  diagnosis.confounding.cosine.setIdentity(3, 3);
  diagnosis.confounding.cosine(0, 1) = diagnosis.confounding.cosine(1, 0) = 0.96;
  diagnosis.confounding.cosine.row(2).setConstant(std::nan(""));
  diagnosis.confounding.cosine.col(2).setConstant(std::nan(""));
  LadderStep before;
  before.model = "0";
  before.rms_fit = 2e-6;
  before.rms_heldout = 2.5e-6;
  before.reduced_chi2 = 1.5;
  before.noise_floor = 2e-6;
  before.systematic = 1.5e-6;
  before.systematic_low = 1.25e-6;
  before.systematic_high = 1.75e-6;
  LadderStep after = before;
  after.model = "1";
  after.added = "reversal EXX";
  after.rms_heldout = 2e-6;
  after.systematic = 0.0;
  after.systematic_low = 0.0;
  after.systematic_high = 0.5e-6;
  after.heldout_loglik_gain = 33.5;
  diagnosis.ladder = {before, after};
  diagnosis.detectable = {{reversal.name, reversal.label, "", "um", 1e-6, 0.75, true, 0.5e-6, 0.25e-6},
                          {other.name, other.label, "", "um", 1e-6, 0.5, true, 0.75e-6, 0.375e-6},
                          {third.name, third.label, "", "um", 1e-6, 0.01, false, std::nan(""), std::nan("")},
                          {EffectName::of_parts("length-scale", "readings", "length", "linear"),
                           "length scale", "", "ppm", 1e-6, 0.9, true, 0.2e-6, std::nan("")}};
  diagnosis.noise = {{0, "white", "1", 1.25, 1.125, 1.375, std::nan(""), ""},
                     {0, "wander", "m or rad", 0.5e-6, 0.25e-6, 0.75e-6, 40.0, ""},
                     {1, "line", "m or rad", 0.0, 0.0, 0.0, 0.5, "off: not supported"}};
  diagnosis.noise_instruments = {"laser-tracer", "ball-bar"};
  diagnosis.removed_readings = {{"S1", 12, "length_mm"}, {"S1", 40, "length_mm"}, {"S2", 7, "length_mm"}};
  diagnosis.families = 120;
  diagnosis.generic_tests = 400;
  return diagnosis;
}

}  // namespace volcal::testing
