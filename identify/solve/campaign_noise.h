#pragma once
/// A campaign as its noise model sees it (identify/noise/noise_model.h): which observations follow one
/// another in one setup, run and channel, and the linear model of some of them about given parameters.

#include <string>
#include <vector>

#include "volcal/identify/noise/local_rows.h"
#include "volcal/identify/noise/restricted_likelihood.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Place of an observation; they are numbered setup by setup, row by row, channel by channel.
struct ObservationPlace {
  std::size_t setup = 0;
  std::size_t row = 0;
  int channel = 0;
};

std::vector<ObservationPlace> observation_places(const MeasurementModel& model);

struct CampaignNoise {
  std::vector<ObservationPlace> places;  ///< of the observations of `data`
  NoiseData data;                        ///< SI; removed observations have an infinite sigma
  std::vector<std::string> groups;       ///< names (channels.h), in the order of their first observation
};

/// All observations. `stated_sigma`: per observation, m or rad; `removed`: per observation, empty = none.
/// `estimated`: where the stations stand; null = where they are guessed to.
CampaignNoise campaign_noise(const MeasurementModel& model, std::vector<double> stated_sigma,
                             const std::vector<bool>& removed, const Eigen::VectorXd* estimated = nullptr);

/// Whole sequences, evenly chosen, until `limit` observations are reached, of `most_setups` setups; every
/// instrument keeps one at least. A sequence that alone is longer than the limit gives its first readings in
/// time. All when there are no more.
CampaignNoise sampled(const CampaignNoise& all, std::size_t limit, std::size_t most_setups);

/// Whole readings, evenly chosen over the campaign, of `limit` observations together: ascending numbers among
/// `places`; all when there are no more. What a reading depends on that another one came before it, as a
/// reversal, is not disturbed: choose from the observations, not from the campaign.
std::vector<std::size_t> evenly_chosen(const std::vector<ObservationPlace>& places, std::size_t limit);
/// Those observations alone, in the same sequences.
CampaignNoise restricted(const CampaignNoise& all, const std::vector<std::size_t>& chosen);

/// The noise that the weights of a fit stand for, per group of `groups`; as stated where it knows none of it.
std::vector<NoiseParameters> fitted_noise(const FitResult& result, const std::vector<std::string>& groups);

/// Fills derivatives to the reduced parameters and residuals (reading minus prediction, m or rad) of the
/// observations at `places`.
void linearise(const MeasurementModel& model, const DatumSpace& datum, const Eigen::VectorXd& parameters,
               const std::vector<ObservationPlace>& places, NoiseProblem& problem);
/// The same without stations, offsets and the like on which none of its observations depends.
NoiseProblem without_unseen_nuisance(NoiseProblem problem, const ParameterLayout& layout,
                                     const DatumSpace& datum);
/// The columns of the error functions among those of linearise(), by what each observation depends on.
LocalRows local_rows(const MeasurementModel& model, const DatumSpace& datum,
                     const Eigen::VectorXd& parameters, const std::vector<ObservationPlace>& places);

}  // namespace volcal
