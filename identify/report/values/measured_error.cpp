#include "volcal/identify/report/values/measured_error.h"

#include "volcal/identify/result/fitted_readings.h"
#include "volcal/model/description/errors.h"

namespace volcal {

MeasuredError measured_error(const Campaign& campaign, int threads) {
  const Evaluation evaluation = evaluate_model(campaign, nominal_model(), nullptr, threads);
  return {campaign.file, campaign.active_compensations, campaign.setups.size(),
          error_sizes(campaign, evaluation.residuals)};
}

void require_campaign_of(const FitResult& result, const Campaign& campaign) {
  const FittedReadings fitted = fitted_readings(campaign, result);
  if (fitted.readings > 0) return;
  if (result.setups.empty())
    throw InputError({},
                     "a certificate states what was identified from readings, and these errors were stated",
                     "give the result folder of volcal fit");
  throw InputError({campaign.file, 0}, "the result was not identified from the readings of this campaign",
                   "give the campaign.toml that volcal fit has read");
}

}  // namespace volcal
