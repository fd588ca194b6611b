/// What was measured and identified, whether it can be trusted, and what it says about the machine.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

struct StatusWords {
  const char* level;  ///< colour of the status line: good, warning, bad
  const char* headline;
  const char* meaning;
};

constexpr double kSeveralTimes = 3.0;   // the stated sigma
constexpr double kNoMoreScatter = 1.1;  // sigma0: the readings scatter as stated

bool is_noisier_than_stated(const FitResult& result) {
  return std::ranges::any_of(result.variance_components, [](const VarianceComponent& component) {
    return component.scale > kSeveralTimes;
  });
}

StatusWords status_words(const FitResult& result) {
  switch (result.status) {
    case FitStatus::LackOfFit:
      if (result.sigma0 <= kNoMoreScatter) {
        return {"warning", "The residuals hold something that the model lacks.",
                "They scatter no more than stated, and yet follow something that was recorded: the messages "
                "below say what. Uncertainties do not cover it; volcal diagnose tells which effect it is."};
      }
      return {"warning", "The readings scatter more than their stated noise allows.",
              "Either the stated noise is too small or the model lacks an effect. Uncertainties rest on the "
              "noise found in the readings; systematic structure in the residuals is not covered by them."};
    case FitStatus::RankDeficient:
      return {"bad", "Some errors cannot be determined from these readings.",
              "What is not visible is named below with the reason and the remedy, and is not a result. "
              "Everything else on this page is determined."};
    case FitStatus::NotConverged:
      return {"bad", "The adjustment did not converge.",
              "Do not use these tables: check the station guesses and the suspect readings first."};
    default:
      if (is_noisier_than_stated(result)) {
        return {
            "warning", "The model explains the readings only with far more noise than stated.",
            "An instrument scatters several times as much as its stated noise: the statement is wrong, or "
            "an effect that the model lacks looks like noise."};
      }
      return {"good", "The model explains the readings within their noise.",
              "Every error in the model is determined by the readings."};
  }
}

Json invisible_errors(const FitResult& result) {
  Json list = Json::array();
  for (const Observability& error : result.rank.errors) {
    if (error.visible) continue;
    const Explanation words = explanation(error.cause);
    list.push_back({{"symbol", error.symbol.name()}, {"reason", words.reason}, {"remedy", words.remedy}});
  }
  return list;
}

Json figures(const PageInput& input) {
  const FitResult& result = input.result;
  const auto suspect = std::ranges::count_if(result.residuals, is_suspect);
  Json list = Json::array();
  const auto add = [&](const char* label, const std::string& value, const std::string& unit,
                       const std::string& note) {
    list.push_back({{"label", label}, {"value", value}, {"unit", unit}, {"note", note}});
  };
  if (!input.volume.empty()) {
    const auto worst = std::ranges::max_element(input.volume, {}, &ToolVolume::error_rms);
    add("Volumetric error now", fmt::format("{:.1f}", worst->error_rms * kPerMicro), "µm RMS",
        fmt::format("max {:.1f} µm, tool {}", worst->error_max * kPerMicro, worst->tool));
    add("Its uncertainty", fmt::format("{:.2f}", worst->u_rms * kPerMicro), "µm RMS, k = 1",
        fmt::format("max {:.2f} µm, tool {}", worst->u_max() * kPerMicro, worst->tool));
  }
  add("Scatter / stated noise σ₀", fmt::format("{:.3f}", result.sigma0), "", "1 = as stated");
  add("χ² / degrees of freedom", fmt::format("{:.3f}", result.dof > 0 ? result.chi2 / result.dof : 0.0), "",
      fmt::format("{:.0f} / {:.0f}", result.chi2, result.dof));
  add("Observations", count_number(static_cast<long long>(result.residuals.size())), "",
      fmt::format("in {} setups", result.setups.size()));
  add("Suspect readings", count_number(suspect), "",
      fmt::format("|w| > {:.2f}", result.outlier_critical_value));
  return list;
}

std::string reference_temperature(const FitResult& result) {
  if (std::isnan(result.reference_temperature_degC)) {
    return "that of the measurement; the campaign records none";
  }
  return fmt::format(
      "{:.2f} °C{}", result.reference_temperature_degC,
      result.temperature_is_campaign_mean ? " (mean of the campaign; not reduced to 20 °C)" : "");
}

Json machine_facts(const PageInput& input) {
  const FitResult& result = input.result;
  const Machine& machine = result.machine;
  Json facts = Json::array();
  const auto add = [&](const char* label, const std::string& value) { facts.push_back({label, value}); };
  add("Machine", machine.name);
  add("Structure (ISO 10791-6)", machine.structure.code);
  for (const Axis& axis : machine.axes) {
    const double factor = position_factor(axis.name);
    add(fmt::format("Travel {}", letter_of(axis.name)).c_str(),
        fmt::format("{:g} to {:g} {}, home {:g} {}", axis.travel_min * factor, axis.travel_max * factor,
                    position_unit(axis.name).suffix, axis.home * factor, position_unit(axis.name).suffix));
  }
  add("Datum", fmt::format("primary {}, secondary {}; every function is zero at home, straightness has no "
                           "least-squares slope over the travel",
                           letter_of(machine.datum.primary), letter_of(machine.datum.secondary)));
  add("Reference temperature", reference_temperature(result));
  add("Uncertainty", fmt::format("U95 = {:.3g} u (95 % interval)", result.coverage_factor));
  if (!input.campaign.file.empty()) add("Campaign", input.campaign.file);
  if (!input.options.date.empty()) add("Date", input.options.date);
  if (!result.provenance.version.empty())
    add("Identified by", "volcal " + result.provenance.version +
                             (result.provenance.date.empty() ? "" : ", " + result.provenance.date));
  if (!result.provenance.command.empty()) add("Command", result.provenance.command);
  return facts;
}

}  // namespace

Json summary_page(const PageInput& input) {
  const StatusWords words = status_words(input.result);
  return {{"status", std::string(to_string(input.result.status))},
          {"level", words.level},
          {"headline", words.headline},
          {"meaning", words.meaning},
          {"messages", sentences(input.result.findings)},
          {"invisible", invisible_errors(input.result)},
          {"figures", figures(input)},
          {"facts", machine_facts(input)}};
}

}  // namespace volcal::report
