#include "volcal/identify/report/text/validation_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {

std::string readings_seen_text(const FittedReadings& fitted) {
  if (!fitted.is_known) return "Readings (which ones the fit was made from, the result does not say)";
  if (fitted.readings == 0) return "Readings that the fit never saw";
  return fitted.are_all() ? "Readings that the fit was made from"
                          : "Readings, some of which the fit was made from";
}

std::string seen_readings_warning(const FittedReadings& fitted) {
  if (fitted.readings == 0) return {};
  const std::string remedy =
      "give a campaign with other setups, or hold lines out: volcal compare --held-out";
  if (fitted.are_all()) {
    return "this is the campaign that the fit was made from: a fit explains its own readings, and these "
           "figures prove nothing; " +
           remedy;
  }
  const auto counted = [](std::size_t count) { return count_number(static_cast<long long>(count)); };
  return fmt::format("the fit was made from {} of {} readings, those of {}{}; {}", counted(fitted.readings),
                     counted(fitted.all), fmt::join(fitted.setups, ", "),
                     fitted.left_out > 0 ? ", without " + counted(fitted.left_out) + " that it left out" : "",
                     remedy);
}

void note_judgement(const FitResult& errors, Campaign& campaign) {
  for (Finding& missing : missing_rotary_errors(campaign, errors.identified)) {
    missing.data["in_uncertainty"] = true;
    campaign.notes.push_back(std::move(missing));
  }
  std::ranges::move(held_beyond_measured(campaign, model_of_result(errors)),
                    std::back_inserter(campaign.notes));
  std::ranges::move(findings_of_tables(errors, tools_of_setups(campaign)),
                    std::back_inserter(campaign.notes));
}

std::string validation_text(const Validation& validation, const FittedReadings& fitted) {
  const ValidationFigures& figures = validation.figures;
  TextTable totals({{"", Align::Left},
                    {"readings"},
                    {"RMS before"},
                    {"RMS after"},
                    {"max before"},
                    {"max after"},
                    {"unit", Align::Left}},
                   readings_seen_text(fitted) + "; before = nominal machine, after = identified");
  const auto add = [&](const char* name, std::size_t count, double rms0, double rms1, double max0,
                       double max1, const char* unit) {
    if (count == 0) return;
    totals.add_row({name, count_number(static_cast<long long>(count)), fixed_number(rms0 * kPerMicro, 3),
                    fixed_number(rms1 * kPerMicro, 3), fixed_number(max0 * kPerMicro, 3),
                    fixed_number(max1 * kPerMicro, 3), unit});
  };
  add("lengths and vectors", figures.lengths, figures.rms_before, figures.rms_after, figures.max_before,
      figures.max_after, "um");
  add("angles", figures.angles, figures.angle_rms_before, figures.angle_rms_after, figures.angle_max_before,
      figures.angle_max_after, "urad");
  TextTable setups({{"setup", Align::Left},
                    {"instrument", Align::Left},
                    {"tool", Align::Left},
                    {"RMS before"},
                    {"RMS after"},
                    {"unit", Align::Left}},
                   "Per setup (single components)");
  for (std::size_t i = 0; i < validation.after.setups.size(); ++i) {
    const SetupSummary& setup = validation.after.setups[i];
    setups.add_row({setup.name, setup.instrument, setup.tool,
                    fixed_number(validation.before.setups[i].rms_residual * kPerMicro, 3),
                    fixed_number(setup.rms_residual * kPerMicro, 3), setup.reading_unit});
  }
  const std::string warning = seen_readings_warning(fitted);
  return totals.text() + "\n" + setups.text() +
         fmt::format(
             "\nreduced chi2 {:.3f} and {:.1f} % of readings inside {} sqrt(u_model^2 + sigma^2) (95 % "
             "expected)\n",
             figures.reduced_chi2, 100.0 * figures.coverage95, kCoverageFactor) +
         (warning.empty() ? warning : "\n! " + warning + "\n");
}

nlohmann::ordered_json validation_json(const ValidationFigures& figures, const FittedReadings& fitted) {
  nlohmann::ordered_json json = {{"rms_before_um", figures.rms_before * kPerMicro},
                                 {"rms_after_um", figures.rms_after * kPerMicro},
                                 {"max_before_um", figures.max_before * kPerMicro},
                                 {"max_after_um", figures.max_after * kPerMicro},
                                 {"reduced_chi2", figures.reduced_chi2},
                                 {"coverage95", figures.coverage95},
                                 {"readings", figures.lengths}};
  if (fitted.is_known) {
    json["fitted_readings"] = fitted.readings;
  } else {
    json["fitted_readings"] = nullptr;
  }
  if (figures.angles > 0) {
    json["angle_rms_before_urad"] = figures.angle_rms_before * kPerMicro;
    json["angle_rms_after_urad"] = figures.angle_rms_after * kPerMicro;
    json["angle_max_before_urad"] = figures.angle_max_before * kPerMicro;
    json["angle_max_after_urad"] = figures.angle_max_after * kPerMicro;
    json["angle_readings"] = figures.angles;
  }
  return json;
}

}  // namespace volcal
