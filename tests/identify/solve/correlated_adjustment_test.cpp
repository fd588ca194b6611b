// Generalised least squares against plain matrix algebra, and fits of simulated campaigns with correlated
// drift and offsets of lines.

#include "volcal/identify/solve/correlated_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <set>

#include "tests/support/campaigns.h"
#include "tests/support/noise_campaigns.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

using test::dense_covariance;

struct NoiseOfReadings {
  double drift = 0.0;
  double line = 0.0;
};

sim::SimulatedCampaign simulated(std::uint64_t seed, const Eigen::Vector3i& grid, NoiseOfReadings noise,
                                 bool with_ball_bar = false) {
  sim::Study study;
  study.machine = sim::reference_machines()[seed % 4];
  study.seed = seed;
  sim::Tracking tracking;
  tracking.grid = grid;
  tracking.noise.drift = noise.drift;
  tracking.noise.drift_time = 200.0;
  tracking.noise.line = noise.line;
  study.measurements.emplace_back().settings = tracking;
  if (with_ball_bar) {
    sim::BallBarCircles circles;
    circles.points_per_turn = 12;
    study.measurements.emplace_back().settings = circles;
  }
  study.validation.points = 5;
  return sim::simulate(study);
}

ModelSpec spline_model(int intervals) {
  ModelSpec model;
  model.default_function.knots = KnotChoice::IntervalCount;
  model.default_function.intervals = intervals;
  return model;
}

const std::vector<NoiseParameters> kTwoNoises = {{0.9, 0.5e-6, 400.0, 0.3e-6, 0.2e-6},
                                                 {1.4, 0.2e-6, 3.0, 0.0, 0.0}};

/// A campaign of two instruments with everything that its adjustment needs.
class Linearised {
 public:
  Linearised()
      : simulated_(simulated(4, {4, 3, 3}, {}, true)),
        model_(simulated_.campaign, resolve_knots(spline_model(2), simulated_.campaign)),
        datum_(model_.layout(), simulated_.campaign.machine, model_.initial_parameters()),
        z(datum_.reduced(model_.initial_parameters())),
        prior(GaussianPrior::none(datum_.size())) {
    for (const ObservationPlace& place : observation_places(model_))
      sigma.push_back(model_.sigma(place.setup, place.row, place.channel, model_.initial_parameters()));
    prior.precision.diagonal().setConstant(1e10);
    prior.mean = z;
  }

  const MeasurementModel& model() const { return model_; }
  const DatumSpace& datum() const { return datum_; }
  CampaignNoise noise(const std::vector<bool>& removed = {}) const {
    return campaign_noise(model_, sigma, removed);
  }

  struct Dense {
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd error;  ///< predicted minus reading
  };
  Dense dense(const Eigen::VectorXd& at) const {
    const std::vector<ObservationPlace> places = observation_places(model_);
    Dense result{Eigen::MatrixXd(places.size(), datum_.size()), Eigen::VectorXd(places.size())};
    RowJacobian row;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& [setup, reading, channel] = places[i];
      model_.linearize(setup, reading, datum_.raw(at), row);
      const auto k = static_cast<Eigen::Index>(i);
      result.jacobian.row(k) = datum_.reduce_rows(dense_row(model_.layout(), row, channel).transpose());
      const Readings& readings = simulated_.campaign.setups[setup].readings;
      result.error[k] = row.predicted[channel] - readings.value[static_cast<std::size_t>(channel)][reading];
    }
    return result;
  }

 private:
  sim::SimulatedCampaign simulated_;
  MeasurementModel model_;
  DatumSpace datum_;

 public:
  Eigen::VectorXd z;
  GaussianPrior prior;
  std::vector<double> sigma;
};

double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).norm() / b.norm(); }

TEST(CorrelatedAdjustment, EquationsAreThoseOfTheFullCovariance) {
  const Linearised problem;
  const CampaignNoise noise = problem.noise();
  ASSERT_EQ(noise.groups, (std::vector<std::string>{"laser-tracer", "ball-bar"}));
  const WhitenedCampaign whitened(problem.model(), problem.datum(), noise, kTwoNoises, 2);
  const auto equations = whitened.equations(problem.z);
  ASSERT_EQ(equations.size(), 2U);

  const Eigen::MatrixXd inverse = dense_covariance(noise.data, kTwoNoises).inverse();
  const auto dense = problem.dense(problem.z);
  for (std::size_t group = 0; group < 2; ++group) {
    std::vector<Eigen::Index> own;
    for (const NoiseSequence& sequence : noise.data.sequences) {
      if (sequence.group != group) continue;
      for (const std::size_t i : sequence.observation) own.push_back(static_cast<Eigen::Index>(i));
    }
    const Eigen::MatrixXd jacobian = dense.jacobian(own, Eigen::all);
    const Eigen::VectorXd error = dense.error(own);
    const Eigen::MatrixXd weight = inverse(own, own);
    EXPECT_EQ(equations[group].observations, static_cast<double>(own.size()));
    EXPECT_LT(relative(equations[group].matrix, jacobian.transpose() * weight * jacobian), 1e-9);
    EXPECT_LT(relative(equations[group].gradient, jacobian.transpose() * weight * error), 1e-9);
    EXPECT_NEAR(equations[group].squares / error.dot(weight * error), 1.0, 1e-9);
  }
}

TEST(CorrelatedAdjustment, SolutionAndCovarianceAreThoseOfTheFullCovariance) {
  const Linearised problem;
  const CampaignNoise noise = problem.noise();
  const WhitenedCampaign whitened(problem.model(), problem.datum(), noise, kTwoNoises, 1);
  std::vector<SmoothingTerm> terms;
  Eigen::VectorXd z = problem.z;
  const auto keep = [](const Eigen::VectorXd&) {};
  adjust_correlated(whitened, problem.prior, 0, keep, terms, z);
  const CorrelatedAdjustment found = adjust_correlated(whitened, problem.prior, 0, keep, terms, z);
  ASSERT_TRUE(found.converged);

  const Eigen::MatrixXd weight = dense_covariance(noise.data, kTwoNoises).inverse();
  Eigen::VectorXd expected = problem.z;
  Eigen::MatrixXd covariance, information;
  Eigen::VectorXd error;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const auto dense = problem.dense(expected);
    information = dense.jacobian.transpose() * weight * dense.jacobian;
    const Eigen::MatrixXd precision = information + problem.prior.precision;
    covariance = precision.llt().solve(Eigen::MatrixXd::Identity(precision.rows(), precision.cols()));
    expected -= covariance * (dense.jacobian.transpose() * weight * dense.error +
                              problem.prior.precision * (expected - problem.prior.mean));
  }
  error = problem.dense(expected).error;
  const Eigen::VectorXd u = covariance.diagonal().cwiseSqrt();
  EXPECT_LT((z - expected).cwiseQuotient(u).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(relative(found.covariance, covariance), 1e-9);
  EXPECT_NEAR(found.squares / error.dot(weight * error), 1.0, 1e-9);
  EXPECT_NEAR(found.redundancy,
              static_cast<double>(error.size()) - covariance.cwiseProduct(information).sum(), 1e-6);
}

TEST(CorrelatedAdjustment, RemovedReadingsHaveNoPartInTheEquations) {
  const Linearised problem;
  std::vector<bool> removed(problem.sigma.size(), false);
  removed[3] = removed[10] = removed[problem.sigma.size() - 2] = true;
  const CampaignNoise noise = problem.noise(removed);
  const WhitenedCampaign whitened(problem.model(), problem.datum(), noise, kTwoNoises, 1);
  const auto equations = whitened.equations(problem.z);
  double observations = 0.0;
  for (const NoiseGroupEquations& own : equations) observations += own.observations;
  EXPECT_EQ(observations, static_cast<double>(problem.sigma.size() - 3));

  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < removed.size(); ++i) {
    if (!removed[i]) kept.push_back(static_cast<Eigen::Index>(i));
  }
  const Eigen::MatrixXd all = dense_covariance(problem.noise().data, kTwoNoises);
  const Eigen::MatrixXd covariance = all(kept, kept);
  const auto dense = problem.dense(problem.z);
  const Eigen::MatrixXd jacobian = dense.jacobian(kept, Eigen::all);
  EXPECT_LT(relative(equations[0].matrix + equations[1].matrix,
                     jacobian.transpose() * covariance.llt().solve(jacobian)),
            1e-9);
}

TEST(CorrelatedAdjustment, TotalSigmaIsTheDiagonalOfTheCovariance) {
  const Linearised problem;
  const CampaignNoise noise = problem.noise();
  const std::vector<double> total = total_sigma(noise.data, problem.sigma, kTwoNoises);
  const Eigen::VectorXd diagonal = dense_covariance(noise.data, kTwoNoises).diagonal();
  for (std::size_t i = 0; i < total.size(); ++i)
    ASSERT_NEAR(total[i] / std::sqrt(diagonal[static_cast<Eigen::Index>(i)]), 1.0, 1e-12);
}

TEST(CampaignNoise, SampleHoldsWholeSequencesOfEveryInstrument) {
  const Linearised problem;
  const CampaignNoise all = problem.noise();
  const CampaignNoise sample = sampled(all, 100, all.places.size());
  EXPECT_LT(sample.places.size(), all.places.size());
  EXPECT_GE(sample.places.size(), 100U);
  std::set<std::size_t> groups;
  std::size_t counted = 0;
  for (const NoiseSequence& sequence : sample.data.sequences) {
    groups.insert(sequence.group);
    const ObservationPlace& first = sample.places[sequence.observation.front()];
    const auto origin = std::ranges::find_if(all.data.sequences, [&](const NoiseSequence& candidate) {
      const ObservationPlace& place = all.places[candidate.observation.front()];
      return place.setup == first.setup && place.row == first.row && place.channel == first.channel;
    });
    ASSERT_NE(origin, all.data.sequences.end());
    EXPECT_EQ(sequence.time, origin->time);
    EXPECT_EQ(sequence.line, origin->line);
    for (std::size_t k = 0; k < sequence.observation.size(); ++k, ++counted) {
      ASSERT_EQ(sample.data.sigma[sequence.observation[k]], all.data.sigma[origin->observation[k]]);
      ASSERT_EQ(sample.data.length[sequence.observation[k]], all.data.length[origin->observation[k]]);
    }
  }
  EXPECT_EQ(groups.size(), 2U);
  EXPECT_EQ(counted, sample.places.size());
  EXPECT_EQ(sampled(all, all.places.size(), all.places.size()).places.size(), all.places.size());
}

TEST(CampaignNoise, SampleHoldsFewSetupsWhereThereAreMany) {
  const Linearised problem;
  const CampaignNoise all = problem.noise();
  constexpr std::size_t kFew = 3;
  const CampaignNoise sample = sampled(all, all.places.size(), kFew);
  std::set<std::size_t> setups, groups;
  for (const ObservationPlace& place : sample.places) setups.insert(place.setup);
  for (const NoiseSequence& sequence : sample.data.sequences) groups.insert(sequence.group);
  EXPECT_EQ(setups.size(), kFew);
  EXPECT_EQ(groups.size(), 2U);
  for (const std::size_t setup : setups) {
    const auto of_setup = [&](const ObservationPlace& place) { return place.setup == setup; };
    EXPECT_EQ(std::ranges::count_if(sample.places, of_setup), std::ranges::count_if(all.places, of_setup))
        << "all sequences of setup " << setup;
  }
}

/// A likelihood does not depend on parameters that only readings outside it have.
TEST(CampaignNoise, IsThatOfAllParametersWithoutThoseOfOtherSetups) {
  const Linearised of;
  const CampaignNoise sample = sampled(of.noise(), of.noise().places.size(), 3);
  NoiseProblem problem;
  linearise(of.model(), of.datum(), of.datum().raw(of.z), sample.places, problem);
  problem.data = sample.data;
  problem.prior_precision = of.prior.precision;
  problem.prior_mean = of.prior.mean - of.z;
  const NoiseProblem fewer = without_unseen_nuisance(problem, of.model().layout(), of.datum());
  EXPECT_LT(fewer.jacobian.cols(), problem.jacobian.cols());
  const double whole = RestrictedLikelihood(problem, 1).log_likelihood(kTwoNoises);
  EXPECT_NEAR(RestrictedLikelihood(fewer, 1).log_likelihood(kTwoNoises), whole, 1e-6 * std::abs(whole));
}

/// Noise in proportion to length belongs to the distances of a tracker, not to its angles.
TEST(CampaignNoise, AnglesOfATrackerHaveNoLength) {
  std::mt19937_64 generator(5);
  const Campaign campaign = testing_support::random_campaign(generator, 4);
  const MeasurementModel model(campaign, testing_support::rich_model(campaign.machine));
  const std::vector<double> sigma(observation_places(model).size(), 1e-6);
  const CampaignNoise noise = campaign_noise(model, sigma, {});
  std::size_t angles = 0;
  for (std::size_t i = 0; i < noise.places.size(); ++i) {
    const bool angle = noise.places[i].channel > 0;
    angles += angle ? 1 : 0;
    EXPECT_EQ(noise.data.length[i] == 0.0, angle) << i;
  }
  EXPECT_EQ(angles, 8U);
}

/// Share of the table's values whose U95 holds the truth.
double coverage(const sim::SimulatedCampaign& simulated, const FitResult& result) {
  const sim::TruthInDatum truth(simulated.truth);
  int inside = 0, all = 0;
  for (const ErrorTableRow& row : error_table(result)) {
    const auto symbol = row.symbol.motion();
    if (!symbol || row.u == 0.0 || row.extrapolated) continue;
    inside += std::abs(row.value - truth.value(*symbol, row.position)) <= row.U95 ? 1 : 0;
    ++all;
  }
  return static_cast<double>(inside) / all;
}

FitOptions options_with(NoisePolicy noise) {
  FitOptions options;
  options.threads = 1;
  options.noise = noise;
  return options;
}

const NoiseRow& row_of(const FitResult& result, const std::string& term) {
  const auto found = std::ranges::find(result.noise.rows, term, &NoiseRow::term);
  if (found == result.noise.rows.end()) throw std::out_of_range(term);
  return *found;
}

TEST(FitWithCorrelatedNoise, IntervalsHoldWhereThoseOfWhiteNoiseAreTooNarrow) {
  double white = 0.0, automatic = 0.0;
  constexpr int kCampaigns = 3;
  for (std::uint64_t seed = 21; seed < 21 + kCampaigns; ++seed) {
    const auto campaign = simulated(seed, {6, 5, 4}, {0.8e-6, 0.6e-6});
    const FitResult plain = fit(campaign.campaign, spline_model(5), options_with(NoisePolicy::White));
    const FitResult found = fit(campaign.campaign, spline_model(5), options_with(NoisePolicy::Automatic));
    EXPECT_FALSE(plain.noise.estimated);
    ASSERT_TRUE(found.noise.more_than_white);
    EXPECT_NEAR(row_of(found, "wander").value, 0.8e-6, 0.3e-6);
    EXPECT_NEAR(row_of(found, "line").value, 0.6e-6, 0.2e-6);
    EXPECT_NEAR(found.noise.chi2 / found.noise.dof, 1.0, 0.1);
    white += coverage(campaign, plain) / kCampaigns;
    automatic += coverage(campaign, found) / kCampaigns;
  }
  EXPECT_LT(white, 0.82);
  EXPECT_GT(automatic, white + 0.07);
  EXPECT_GT(automatic, 0.85);
}

/// With one tool and no angles some rotations have no lever.
TEST(FitWithCorrelatedNoise, IsFoundBesideErrorsThatAreNotVisible) {
  auto campaign = simulated(23, {6, 5, 4}, {0.8e-6, 0.6e-6});
  std::erase_if(campaign.campaign.setups, [](const volcal::Setup& setup) { return setup.tool != 0; });
  const FitResult found = fit(campaign.campaign, spline_model(5), options_with(NoisePolicy::Automatic));
  EXPECT_EQ(found.status, FitStatus::RankDeficient);
  ASSERT_TRUE(found.noise.more_than_white);
  EXPECT_NEAR(row_of(found, "wander").value, 0.8e-6, 0.3e-6);
  EXPECT_NEAR(row_of(found, "line").value, 0.6e-6, 0.2e-6);
  EXPECT_NEAR(found.noise.chi2 / found.noise.dof, 1.0, 0.1);
}

TEST(FitWithCorrelatedNoise, ResidualsAreJudgedByTheirTotalDeviation) {
  auto campaign = simulated(24, {6, 5, 4}, {0.8e-6, 0.6e-6});
  campaign.campaign.setups[1].readings.value[0][40] += 20e-6;
  FitOptions options = options_with(NoisePolicy::Automatic);
  options.outliers = OutlierPolicy::Remove;
  const FitResult result = fit(campaign.campaign, spline_model(4), options);
  ASSERT_TRUE(result.noise.more_than_white);
  double squares = 0.0;
  std::size_t count = 0, removed = 0;
  for (const ResidualRecord& record : result.residuals) {
    if (record.removed) {
      ++removed;
      EXPECT_EQ(record.setup, 1U);
      EXPECT_EQ(record.row, 40U);
      continue;
    }
    const NoiseRow& drift = row_of(result, "wander");
    EXPECT_GT(record.sigma, drift.value);
    squares += record.w * record.w;
    ++count;
  }
  EXPECT_EQ(removed, 1U);
  EXPECT_NEAR(squares / static_cast<double>(count), 1.0, 0.1);
}

TEST(FitWithCorrelatedNoise, WhiteNoiseStaysAsItIs) {
  constexpr int kCampaigns = 20;
  int same = 0;
  for (std::uint64_t seed = 41; seed < 41 + kCampaigns; ++seed) {
    const auto campaign = simulated(seed, {4, 4, 3}, {});
    const FitResult plain = fit(campaign.campaign, spline_model(3), options_with(NoisePolicy::White));
    const FitResult found = fit(campaign.campaign, spline_model(3), options_with(NoisePolicy::Automatic));
    EXPECT_TRUE(found.noise.estimated);
    if (found.noise.more_than_white) continue;
    EXPECT_TRUE(found.parameters == plain.parameters);
    EXPECT_TRUE(found.covariance == plain.covariance);
    EXPECT_EQ(found.findings, plain.findings);
    ++same;
  }
  // Each of three terms that are not there is kept in some 2 % of campaigns.
  EXPECT_GE(same, kCampaigns - 4);
}

TEST(FitWithCorrelatedNoise, DoesNotDependOnTheNumberOfThreads) {
  const auto campaign = simulated(25, {4, 4, 4}, {1.2e-6, 0.8e-6});
  FitOptions options = options_with(NoisePolicy::Automatic);
  const FitResult one = fit(campaign.campaign, spline_model(3), options);
  options.threads = 3;
  const FitResult three = fit(campaign.campaign, spline_model(3), options);
  ASSERT_TRUE(one.noise.more_than_white);
  EXPECT_TRUE(one.parameters == three.parameters);
  EXPECT_TRUE(one.covariance == three.covariance);
}

TEST(FitWithCorrelatedNoise, RobustLossTakesReadingsAsIndependentAndSaysSo) {
  const auto campaign = simulated(26, {4, 4, 4}, {1.2e-6, 0.8e-6});
  FitOptions options = options_with(NoisePolicy::Automatic);
  options.loss = RobustLoss::Huber;
  const FitResult result = fit(campaign.campaign, spline_model(3), options);
  EXPECT_FALSE(result.noise.estimated);
  EXPECT_EQ(std::ranges::count(result.findings, FindingCode::NoiseTakenAsIndependent, &Finding::code), 1);
}

}  // namespace
}  // namespace volcal
