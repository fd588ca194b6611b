/// What an identified model leaves of the error, on readings that its fit did or did not see.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/text/validation_text.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/units.h"

namespace volcal::report {

Json validation_page(const ComparisonInput& input) {
  const ValidationFigures& figures = input.validation->figures;
  const FittedReadings& fitted = input.validation->fitted;
  Json rows = Json::array();
  const auto add = [&](const char* name, std::size_t count, double rms_before, double rms_after,
                       double max_before, double max_after, const char* unit) {
    if (count == 0) return;
    rows.push_back({{"name", name},
                    {"count", count},
                    {"rms_before", rounded(rms_before * kPerMicro, 4)},
                    {"rms_after", rounded(rms_after * kPerMicro, 4)},
                    {"max_before", rounded(max_before * kPerMicro, 4)},
                    {"max_after", rounded(max_after * kPerMicro, 4)},
                    {"unit", unit}});
  };
  add("Lengths and vectors", figures.lengths, figures.rms_before, figures.rms_after, figures.max_before,
      figures.max_after, "µm");
  add("Angles", figures.angles, figures.angle_rms_before, figures.angle_rms_after, figures.angle_max_before,
      figures.angle_max_after, "µrad");
  return {{"level", fitted.is_known && fitted.readings == 0 ? "good" : "warning"},
          {"seen", readings_seen_text(fitted)},
          {"warning", seen_readings_warning(fitted)},
          {"rows", std::move(rows)},
          {"reduced_chi2", rounded(figures.reduced_chi2, 4)},
          {"coverage_percent", rounded(100.0 * figures.coverage95, 4)},
          {"coverage_factor", kCoverageFactor}};
}

}  // namespace volcal::report
