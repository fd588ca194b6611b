#include "volcal/identify/report/text/criticism/tried_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/text/uncertain_number.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

std::string tried_value_text(const TriedValue& value) {
  const std::string unit = value.unit.empty() ? "" : " " + value.unit;
  if (std::isnan(value.u))
    return fmt::format("{} {}{} (held)", value.name, short_number(value.value, 4), unit);
  return fmt::format("{} {}{}", value.name, value_with_u(value.value, kCoverageFactor * value.u), unit);
}

std::string size_text(const Comparison& without, const Comparison& with) {
  std::string text;
  const auto add = [&](const ResidualSize& before, const ResidualSize& after, const char* unit) {
    if (before.count == 0) return;
    text +=
        fmt::format("{}RMS {} -> {} {}", text.empty() ? "" : ", ", short_number(before.rms * kPerMicro, 3),
                    short_number(after.rms * kPerMicro, 3), unit);
  };
  add(without.total.lengths, with.total.lengths, "um");
  add(without.total.angles, with.total.angles, "urad");
  return text;
}

/// Of chi2: two fits that end where they should differ by less than this.
constexpr double kRoundingOfChi2 = 1e-6;

std::string chi2_verdict(const TriedEffect& tried) {
  const HeldOutGain& gain = tried.gain;
  const double rounding = kRoundingOfChi2 * std::max(tried.without.total.chi2, tried.with.total.chi2);
  const bool is_same = std::abs(gain.chi2) <= rounding;
  const std::string change = is_same ? std::string("chi2 the same")
                                     : fmt::format("chi2 {} by {}", gain.chi2 > 0.0 ? "less" : "more",
                                                   short_number(std::abs(gain.chi2), 3));
  if (!tried.not_visible.empty()) return change + ": no verdict on an effect that is not visible";
  if (is_same) return change + ": it predicts neither better nor worse";
  return fmt::format("{}, by chance up to {}: {}", change, short_number(gain.by_chance, 2),
                     gain.is_better()  ? "it predicts better"
                     : gain.is_worse() ? "it predicts worse"
                                       : "no difference that the held-out readings could show");
}

std::string heldout_line(const TriedEffect& tried) {
  if (!tried.judged) return "the setups have too few lines to hold some out";
  return fmt::format("{} on {} readings that neither fit has seen, {}", size_text(tried.without, tried.with),
                     count_number(static_cast<long long>(tried.with.total.observations)),
                     chi2_verdict(tried));
}

/// What a scan or a test of the catalogue still sees, strongest first.
std::vector<std::string> above_the_noise(const Diagnosis& diagnosis) {
  std::vector<std::string> found;
  const auto add = [&](const std::string& what, double log10_p) {
    found.push_back(fmt::format("{} (log10 p {:.1f})", what, log10_p));
  };
  for (const EffectFinding& effect : diagnosis.effects) add(effect.label, effect.log10_p);
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    std::string names;
    for (const EffectFinding& effect : *set) names += (names.empty() ? "" : " or ") + effect.label;
    if (!set->empty()) add(names, set->front().log10_p);
  }
  for (const UnknownFinding& unknown : diagnosis.unknown)
    add("something in " + unknown.dependence() + " along " + unknown.action(), unknown.log10_p);
  return found;
}

std::string remains_line(const Diagnosis& diagnosis) {
  const auto found = above_the_noise(diagnosis);
  if (found.empty()) {
    return diagnosis.verdict == Verdict::NothingAbove
               ? "nothing above the noise"
               : (diagnosis.findings.empty() ? to_string(diagnosis.verdict)
                                             : sentence(diagnosis.findings.front()));
  }
  std::string text = "still above the noise: ";
  for (std::size_t i = 0; i < found.size() && i < 4; ++i) text += (i > 0 ? "; " : "") + found[i];
  return found.size() > 4 ? text + fmt::format("; and {} more", found.size() - 4) : text;
}

nlohmann::ordered_json judged_json(const Comparison& comparison) {
  return {{"observations", comparison.total.observations},
          {"chi2", comparison.total.chi2},
          {"rms_um", comparison.total.lengths.rms * kPerMicro},
          {"rms_urad", comparison.total.angles.rms * kPerMicro}};
}

}  // namespace

std::string tried_text(const std::string& effect, const TriedEffect& tried) {
  std::string values;
  for (const TriedValue& value : tried.values)
    values += (values.empty() ? "" : ", ") + tried_value_text(value);
  if (!tried.not_visible.empty()) values = "NOT VISIBLE: " + tried.not_visible;
  if (tried.status == FitStatus::NotConverged) values += " (the fit has not converged)";
  return fmt::format("{}: {}\nheld out: {}\nremains: {}\n{}", effect, values, heldout_line(tried),
                     remains_line(tried.remains), findings_text(tried.remains.notes));
}

std::string tried_json(const std::string& effect, const TriedEffect& tried) {
  nlohmann::ordered_json values = nlohmann::ordered_json::array();
  for (const TriedValue& value : tried.values) {
    nlohmann::ordered_json u = nullptr;
    if (!std::isnan(value.u)) u = value.u;
    values.push_back({{"name", value.name}, {"value", value.value}, {"u", u}, {"unit", value.unit}});
  }
  nlohmann::ordered_json json = {{"effect", effect},
                                 {"status", std::string(to_string(tried.status))},
                                 {"visible", tried.not_visible.empty()},
                                 {"values", values}};
  json["held_out"] = nullptr;
  if (tried.judged)
    json["held_out"] = {{"without", judged_json(tried.without)},
                        {"with", judged_json(tried.with)},
                        {"chi2_less_by", tried.gain.chi2},
                        {"chi2_by_chance", tried.gain.by_chance}};
  json["verdict_of_what_remains"] = to_string(tried.remains.verdict);
  json["remains"] = above_the_noise(tried.remains);
  add_notes(tried.remains.notes, json);
  return json.dump(2) + "\n";
}

}  // namespace volcal
