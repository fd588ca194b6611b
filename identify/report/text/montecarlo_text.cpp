#include "volcal/identify/report/text/montecarlo_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "volcal/identify/report/text/budget_text.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/fit_summary.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/quantity_groups.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

/// The values of one line.
struct QuantityLine {
  std::string name;
  std::string unit;
  std::vector<const QuantityResult*> values;
};

QuantityLine line_of(const MonteCarloResult& result, const QuantityGroup& group) {
  QuantityLine line{group.name, group.unit, {}};
  for (const std::size_t i : group.values) line.values.push_back(&result.quantities[i]);
  return line;
}

std::string ratio_words(const QuantityLine& line) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const QuantityResult* value : line.values) {
    if (!(value->u_linear > 0.0) || std::isnan(value->u)) return "-";
    low = std::min(low, value->u / value->u_linear);
    high = std::max(high, value->u / value->u_linear);
  }
  return line.values.size() == 1 ? fixed_number(low, 4)
                                 : fixed_number(low, 4) + " .. " + fixed_number(high, 4);
}

std::string verdict_words(const QuantityLine& line) {
  std::size_t validated = 0;
  LinearVerdict worst = LinearVerdict::Validated;
  for (const QuantityResult* value : line.values) {
    validated += value->verdict == LinearVerdict::Validated ? 1U : 0U;
    worst = std::max(worst, value->verdict);
  }
  if (worst == LinearVerdict::Validated || validated == 0) return std::string(to_string(worst));
  return fmt::format("{}, {} of {}", to_string(worst), line.values.size() - validated, line.values.size());
}

std::string quantity_table(const MonteCarloResult& result) {
  TextTable table(
      {{"quantity", Align::Left},
       {"values"},
       {"unit", Align::Left},
       {"u linear"},
       {"u"},
       {"u / u linear"},
       {"largest bias"},
       {"+-"},
       {"linear propagation", Align::Left}},
      "Standard uncertainties (the largest of each line) by linear propagation and by Monte Carlo");
  for (const QuantityGroup& group : quantity_groups(result)) {
    const QuantityLine line = line_of(result, group);
    const auto spread = [](const QuantityResult* value) {
      return value->u > 0.0 ? value->u : value->u_linear;
    };
    const auto by_u = [&](const QuantityResult* a, const QuantityResult* b) { return spread(a) < spread(b); };
    const auto by_bias = [](const QuantityResult* a, const QuantityResult* b) {
      return std::abs(a->bias) < std::abs(b->bias);
    };
    const QuantityResult& widest = **std::ranges::max_element(line.values, by_u);
    const QuantityResult& biased = **std::ranges::max_element(line.values, by_bias);
    const double unit = widest.quantity.si_per_unit;
    table.add_row({line.name, std::to_string(line.values.size()), line.unit,
                   short_number(widest.u_linear / unit), short_number(widest.u / unit), ratio_words(line),
                   short_number(biased.bias / unit, 2), short_number(biased.bias_error / unit, 1),
                   verdict_words(line)});
  }
  return table.text();
}

std::string refit_table(const RefitCheck& check) {
  TextTable table(
      {{"path", Align::Left},
       {"lengths [nm]"},
       {"angles [nrad]"},
       {"of tolerance"},
       {"most of it at", Align::Left}},
      fmt::format("Largest difference from full refits of the same {} draws", check.linear.draws));
  for (const auto& [name, path] : {std::pair("linear", &check.linear), std::pair("chord", &check.chord)}) {
    table.add_row({name, short_number(path->largest_length * 1e9, 2),
                   short_number(path->largest_angle * 1e9, 2), short_number(path->largest_share, 2),
                   path->where});
  }
  return table.text();
}

std::string tolerance_words(const MonteCarloResult& result) {
  std::string text = fmt::format(
      "  tolerance  {} significant digits of u, and no finer than {:.0f} nm or nrad: ", result.digits,
      kPracticalTolerance * 1e9);
  if (result.settled) return text + "reached for every value\n";
  const auto settled = std::ranges::count_if(
      result.quantities, [](const QuantityResult& value) { return value.scatter < value.tolerance; });
  text += fmt::format("reached for {} of {} values\n", settled, result.quantities.size());
  text += fmt::format("             about {} draws would settle all: ",
                      count_number(static_cast<long long>(result.would_settle)));
  if (result.most_draws == 0 || result.draws < result.most_draws)
    return text + "--resume goes on where this ended\n";
  return text + fmt::format("--most-draws {} ended it, give more\n", result.most_draws);
}

/// How many steps, and what they leave.
std::string steps_text(const MonteCarloResult& result) {
  std::string text = fmt::format("  steps      {:.2f} a draw; ",
                                 static_cast<double>(result.steps) / static_cast<double>(result.draws));
  const std::string held = held_by_steps_text(result);
  if (!held.empty()) return text + held + "\n";
  return text + fmt::format("further ones would change less than {} standard deviations\n",
                            short_number(result.to_come, 2));
}

std::string study_head(const MonteCarloResult& result) {
  static constexpr const char* kPathWords[] = {"", "linear: one matrix product, drawn among the parameters",
                                               "chord: readings drawn, steps with an exact gradient",
                                               "refit: readings drawn, the adjustment run again"};
  std::string text =
      fmt::format("Monte Carlo, {} draws, seed {}\n  path       {}\n  functions  {}\n",
                  count_number(static_cast<long long>(result.draws)), result.seed,
                  kPathWords[static_cast<int>(result.path)],
                  result.functions == FunctionRoughness::Drawn
                      ? "drawn: the prior of their roughness is drawn about the identified machine"
                      : "fixed: repeated campaigns on one machine, smoothing's bias apart");
  for (const std::string& disturbance : result.disturbances)
    text += "  disturbed  by " + disturbance + ", which the fit knows nothing of\n";
  if (result.adaptive) {
    text += tolerance_words(result);
  }
  if (result.path == DrawPath::Chord) {
    text += steps_text(result);
    if (result.refitted > 0)
      text += fmt::format("  refitted   {} draws that steps did not solve\n", result.refitted);
  }
  if (result.not_converged > 0)
    text += fmt::format("  WARNING    {} draws did not converge\n", result.not_converged);
  return text;
}

/// GUM Supplement 1, clause 8, over all values.
std::string verdict_text(const MonteCarloResult& result) {
  std::size_t counts[3] = {0, 0, 0};
  const QuantityResult* worst = nullptr;
  const auto share = [](const QuantityResult& value) { return value.difference / value.tolerance; };
  for (const QuantityResult& value : result.quantities) {
    ++counts[static_cast<int>(value.verdict)];
    if (worst == nullptr || share(value) > share(*worst)) worst = &value;
  }
  if (worst == nullptr) return "";
  const LinearVerdict overall = counts[2] > 0   ? LinearVerdict::NotValidated
                                : counts[1] > 0 ? LinearVerdict::Undecided
                                                : LinearVerdict::Validated;
  const double unit = worst->quantity.si_per_unit;
  std::string text = fmt::format(
      "Linear propagation (GUM Supplement 1, clause 8, {} digits): {}\n"
      "  {} of {} values validated, {} undecided, {} not\n"
      "  ends of the 95 % intervals differ most, against their tolerance, at {}:\n"
      "  {} {}, tolerance {}, standard error of the ends {}\n",
      result.digits, to_string(overall), counts[0], result.quantities.size(), counts[1], counts[2],
      worst->quantity.words(), short_number(worst->difference / unit, 2), worst->quantity.unit,
      short_number(worst->tolerance / unit, 2), short_number(worst->end_error / unit, 2));
  if (result.draws < kFewestForEnds)
    return text +
           fmt::format("  undecided: fewer than {} draws have no ends of a 95 % interval; more decide\n",
                       kFewestForEnds);
  if (counts[1] > 0)
    text += "  undecided: the scatter of the ends explains the difference; more draws decide\n";
  return text;
}

/// Of errors that can be exchanged: what switching them off would do to the fit.
std::string free_combination_text(const std::vector<Finding>& invisible) {
  std::vector<std::string> errors;
  for (const Finding& finding : invisible) {
    if (finding.code == FindingCode::NotVisibleExchangeable) errors.push_back(finding.text("error"));
  }
  if (errors.size() < 2) return "";
  const std::string names = list_in_words(errors);
  return "Only combinations of " + names +
         " are free; the readings determine the rest of them. Do not switch them off in the model: the fit "
         "would lose what the readings determine. [priors] state how large errors are and do not make them "
         "visible.\n";
}

}  // namespace

std::string held_by_steps_text(const MonteCarloResult& result) {
  const PathCheck& check = result.check.chord;
  if (result.path != DrawPath::Chord) return "";
  if (check.draws == 0)
    return "they hold the second order of the transforms at the identified machine; what that leaves out is "
           "not known without --refits";
  if (check.largest_share <= kShareOfTolerance) return "";
  return fmt::format(
      "they hold the second order of the transforms at the identified machine, and refits differ by {} times "
      "the tolerance where {} is allowed: take --path refit",
      short_number(check.largest_share, 2), kShareOfTolerance);
}

std::string montecarlo_text(const MonteCarloResult& result) {
  std::string text = study_head(result);
  if (result.check.linear.draws > 0) text += "\n" + refit_table(result.check);
  text += "\n" + stated_for_text(result.conditions) + findings_text(result.condition_findings);
  return text + quantity_table(result) + "\n" + verdict_text(result) + "\n" + budget_text(result) +
         findings_text(result.contradicted) + findings_text(result.notes);
}

std::string undetermined_text(const FitResult& fit) {
  return "Monte Carlo: nothing is drawn, the readings do not determine every error.\n" + rank_text(fit) +
         "\n" + findings_text(fit.rank.invisible) + free_combination_text(fit.rank.invisible) +
         "Measure what is named here and draw again.\n";
}

}  // namespace volcal
