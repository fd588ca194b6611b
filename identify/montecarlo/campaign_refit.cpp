#include "volcal/identify/montecarlo/campaign_refit.h"

#include <cmath>

#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/correlated_adjustment.h"

namespace volcal {

CampaignRefit::CampaignRefit(const RepeatedCampaign& campaign)
    : repeated_(campaign),
      campaign_(campaign.linear_model().campaign()),
      model_(campaign_, campaign.result().adjustment->model),
      index_(model_),
      datum_(model_.layout(), campaign_.machine, campaign.result().parameters) {
  const NoiseData& data = campaign.linear_model().problem().data;
  std::vector<bool> left_out;
  for (const double sigma : data.sigma) left_out.push_back(!std::isfinite(sigma));
  noise_ = campaign_noise(model_, campaign.linear_model().stated_sigma(), left_out);
  for (const double sigma : total_sigma(noise_.data, noise_.data.sigma, campaign.noise()))
    weight_.push_back(std::isfinite(sigma) ? 1.0 / (sigma * sigma) : 0.0);
}

void CampaignRefit::set_readings(const Eigen::VectorXd& errors) {
  for (std::size_t i = 0; i < noise_.places.size(); ++i) {
    const auto [setup, row, channel] = noise_.places[i];
    const auto index = static_cast<Eigen::Index>(i);
    campaign_.setups[setup].readings.value[static_cast<std::size_t>(channel)][row] =
        repeated_.predicted()[index] + errors[index];
  }
}

void CampaignRefit::renew(const Eigen::VectorXd& z) {
  const Eigen::VectorXd raw = datum_.raw(z);
  model_.expand_effects(raw);
  model_.set_second_order_remainder(raw);
}

CampaignRefit::Outcome CampaignRefit::solve(const CampaignDraw& draw) {
  set_readings(draw.errors);
  Eigen::VectorXd z = repeated_.identified();
  renew(z);
  const GaussianPrior prior{repeated_.prior_precision(), repeated_.identified() + draw.statement};
  if (repeated_.result().noise.more_than_white) {
    const WhitenedCampaign whitened(model_, datum_, noise_, repeated_.noise(), 1);
    std::vector<SmoothingTerm> in_the_prior;
    const CorrelatedAdjustment adjusted = adjust_correlated(
        whitened, prior, 0, [this](const Eigen::VectorXd& at) { renew(at); }, in_the_prior, z);
    return {z - repeated_.identified(), adjusted.iterations, adjusted.converged};
  }
  MinimiseOptions options;
  const MinimiseSummary first = minimise(index_, weight_, datum_, prior, options, z);
  renew(z);
  const MinimiseSummary second = minimise(index_, weight_, datum_, prior, options, z);
  return {z - repeated_.identified(), first.iterations + second.iterations, second.converged};
}

}  // namespace volcal
