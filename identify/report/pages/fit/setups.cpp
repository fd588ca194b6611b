/// How well each setup fits, and what noise the readings of each instrument show.

#include <limits>

#include "volcal/identify/report/noise_rows.h"

namespace volcal::report {
namespace {

Json setup_rows(const FitResult& result) {
  Json rows = Json::array();
  for (const SetupSummary& setup : result.setups) {
    rows.push_back({{"name", setup.name},
                    {"instrument", setup.instrument},
                    {"tool", setup.tool},
                    {"unit", shown_unit(setup.reading_unit)},
                    {"observations", setup.observations},
                    {"redundancy", rounded(setup.redundancy, 6)},
                    {"chi2", rounded(setup.chi2, 6)},
                    {"reduced", rounded(setup.redundancy > 0 ? setup.chi2 / setup.redundancy
                                                             : std::numeric_limits<double>::quiet_NaN(),
                                        4)},
                    {"rms", rounded(setup.rms_residual * kPerMicro, 4)},
                    {"max", rounded(setup.max_residual * kPerMicro, 4)}});
  }
  return rows;
}

Json component_rows(const FitResult& result) {
  Json rows = Json::array();
  for (const VarianceComponent& component : result.variance_components) {
    rows.push_back({{"instrument", component.instrument},
                    {"observations", component.observations},
                    {"redundancy", rounded(component.redundancy, 6)},
                    {"scale", rounded(component.scale, 4)},
                    {"u", rounded(component.scale_u, 3)}});
  }
  return rows;
}

}  // namespace

Json setups_page(const PageInput& input) {
  const NoiseSummary& noise = input.result.noise;
  return {{"setups", setup_rows(input.result)},
          {"components", component_rows(input.result)},
          {"noise",
           {{"estimated", noise.estimated},
            {"more_than_white", noise.more_than_white},
            {"reduced",
             rounded(noise.dof > 0 ? noise.chi2 / noise.dof : std::numeric_limits<double>::quiet_NaN(), 4)},
            {"rows", noise_rows(noise.rows, noise.groups)}}}};
}

}  // namespace volcal::report
