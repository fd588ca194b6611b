#include "volcal/identify/report/values/swallowed_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/solve/adjustment.h"
#include "volcal/model/observation/channels.h"

namespace volcal::report {
namespace {

constexpr double kLarger = 1.05;

}  // namespace

SwallowedNoise swallowed_noise(const FitResult& result, const Campaign& campaign) {
  SwallowedNoise swallowed;
  swallowed.factor.assign(result.residuals.size(), 1.0);
  if (result.adjustment == nullptr || result.adjustment->stated_sigma.size() != result.residuals.size())
    return swallowed;
  std::map<std::string, std::pair<double, double>> sums;
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const ResidualRecord& record = result.residuals[i];
    const double stated = result.adjustment->stated_sigma[i];
    if (!(stated > 0.0) || record.sigma <= kLarger * stated) continue;
    swallowed.factor[i] = record.sigma / stated;
    ++swallowed.readings;
    auto& sum = sums[noise_group(campaign.setups[record.setup], static_cast<std::size_t>(record.channel))];
    sum.first += swallowed.factor[i] * swallowed.factor[i];
    sum.second += 1.0;
  }
  for (const auto& [group, sum] : sums) swallowed.groups[group] = std::sqrt(sum.first / sum.second);
  return swallowed;
}

}  // namespace volcal::report
