#include "volcal/identify/solve/fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/stopwatch.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/correlated_adjustment.h"
#include "volcal/identify/solve/normals/stated_sigma.h"
#include "volcal/identify/solve/plausibility.h"
#include "volcal/identify/solve/priors/evidence.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/rank.h"
#include "volcal/identify/solve/residuals.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/identify/solve/verdict.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/driver_check.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kFurthestStationMiss = 1.0;  // m
constexpr int kEvidenceRounds = 2;
constexpr int kShapeSteps = 30;
constexpr int kOutlierRounds = 60;
constexpr double kMostOutliers = 0.25;  // of a setup: beyond, the model or the stated noise is wrong
constexpr double kSurelyAsWell = 0.7;   // of the largest |w| of a setup: leaves in the same round

/// The state of one identification; each method is one stage.
class Identification {
 public:
  Identification(const Campaign& campaign, const ModelSpec& spec, const FitOptions& options)
      : campaign_(campaign),
        options_(options),
        threads_(thread_count(options.threads)),
        spec_(resolve_knots(spec, campaign)),
        model_(campaign, spec_),
        index_(model_) {
    result_.machine = campaign.machine;
    result_.active_compensations = campaign.active_compensations;
    parameters_ = model_.initial_parameters();
    start_weights();
    group_observations();
  }

  FitResult run() {
    progress("nuisance parameters on the nominal machine", 0.0);
    fit_nuisance();
    renew_sigma_of_angles(index_, parameters_, stated_sigma_);
    if (renew_sigma_of_lengths(index_, parameters_, stated_sigma_)) found_stations_ = parameters_;
    check_plausible();
    lap("nuisance parameters");
    progress("rank analysis", 0.1);
    find_rank();
    lap("rank analysis");
    adjust();
    remove_outliers();
    require_plausible_fit(model_, parameters_, setup_summaries(campaign_, result_.residuals, stated_sigma_));
    lap("adjustment");
    if (models_noise()) {
      progress("noise", 0.75);
      model_noise();
      lap("noise");
    }
    progress("covariance and residuals", 0.9);
    finish();
    lap("covariance and residuals");
    progress("done", 1.0);
    return std::move(result_);
  }

 private:
  void progress(const std::string& stage, double done) const {
    if (options_.progress) options_.progress(stage, done);
  }
  void lap(const std::string& stage) { result_.timings.push_back({stage, stopwatch_.lap()}); }

  void start_weights() {
    stated_sigma_ = stated_sigma(index_, parameters_);
    removed_.assign(stated_sigma_.size(), false);
    for (const std::size_t observation : index_.left_out()) removed_[observation] = true;
  }

  void group_observations() {
    for (const Setup& setup : campaign_.setups) {
      std::vector<std::size_t>& groups = group_of_channel_.emplace_back();
      for (std::size_t channel = 0; channel < setup.readings.channels(); ++channel) {
        const std::string group = noise_group(setup, channel);
        const auto found = std::ranges::find(noise_groups_, group);
        groups.push_back(static_cast<std::size_t>(found - noise_groups_.begin()));
        if (found == noise_groups_.end()) noise_groups_.push_back(group);
      }
    }
    scale_.assign(noise_groups_.size(), 1.0);
  }

  /// Calls visit(observation, noise group) for every observation of a setup.
  template <class Visit>
  void for_each_observation(std::size_t setup, const Visit& visit) const {
    const std::vector<std::size_t>& groups = group_of_channel_[setup];
    std::size_t observation = index_.first_observation(setup, 0);
    for (std::size_t row = 0; row < campaign_.setups[setup].readings.size(); ++row) {
      for (const std::size_t group : groups) visit(observation++, group);
    }
  }

  std::vector<double> sigma() const {
    if (!noise_.empty()) return total_sigma(campaign_noise_.data, stated_sigma_, noise_);
    std::vector<double> sigma = stated_sigma_;
    for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
      for_each_observation(setup, [&](std::size_t i, std::size_t group) { sigma[i] *= scale_[group]; });
    }
    return sigma;
  }

  std::vector<double> weights(const std::vector<double>& sigma) const {
    std::vector<double> weight(sigma.size());
    for (std::size_t i = 0; i < sigma.size(); ++i)
      weight[i] = removed_[i] ? 0.0 : 1.0 / (sigma[i] * sigma[i]);
    return weight;
  }

  MinimiseOptions minimise_options() const {
    MinimiseOptions options;
    options.solver = options_.solver;
    options.loss = options_.loss;
    options.threads = threads_;
    options.max_iterations = options_.max_iterations;
    return options;
  }

  void fit_nuisance() {
    const DatumSpace datum(
        model_.layout(), campaign_.machine, parameters_, [](ErrorSymbol) { return false; },
        [](const ParameterBlock& block) { return block.kind == ParameterKind::Nuisance; });
    Eigen::VectorXd z = datum.reduced(parameters_);
    GaussianPrior prior = stated_priors(model_, datum);
    // On the nominal machine a direction may be free (one station, one line): the guess holds it.
    for (int i = 0; i < datum.size(); ++i) {
      if (prior.precision(i, i) > 0.0) continue;
      prior.precision(i, i) = 1.0 / (kFurthestStationMiss * kFurthestStationMiss);
      prior.mean[i] = z[i];
    }
    MinimiseOptions options = minimise_options();
    options.solver = SolverKind::Compressed;
    options.function_tolerance = 1e-9;
    minimise(index_, weights(stated_sigma_), datum, prior, options, z);
    parameters_ = datum.raw(z);
  }

  void check_plausible() const {
    const auto records =
        residual_records(index_, stated_sigma_, weights(stated_sigma_), parameters_, {}, 1e300, threads_);
    require_plausible(campaign_, records, setup_summaries(campaign_, records, stated_sigma_));
  }

  void find_rank() {
    datum_ = std::make_unique<DatumSpace>(model_.layout(), campaign_.machine, parameters_);
    z_ = datum_->reduced(parameters_);
    const std::vector<double> weight = weights(stated_sigma_);
    NormalAccumulator accumulator(index_, weight, nullptr, threads_);
    const NormalEquations& sums = accumulator.accumulate(parameters_);
    result_.initial_cost = sums.cost;
    base_prior_ = stated_priors(model_, *datum_);
    const Eigen::MatrixXd data = datum_->reduce_matrix(sums.matrix) + base_prior_.precision;
    const GaussianPrior wide = above_rounding(data, wide_prior(model_, *datum_, z_, stated_sigma_));
    rank_ = analyse_rank(model_, *datum_, data, wide);
    if (rank_.deficient)
      rank_ = judge_by_roughness(model_, *datum_, data, wide, terms_as_rough_as_seen(wide), rank_);
    hold_undetermined(rank_, wide, base_prior_);
    terms_ = smoothing_terms(model_, *datum_);
    hold_invisible(rank_, terms_, base_prior_);
    leave_imitated_to_the_rest(datum_->reduce_matrix(sums.matrix), base_prior_, terms_);
  }

  std::vector<SmoothingTerm> terms_as_rough_as_seen(const GaussianPrior& wide) const {
    std::vector<SmoothingTerm> terms = smoothing_terms(model_, *datum_);
    GaussianPrior held = base_prior_;
    hold_undetermined(rank_, wide, held);
    maximise_evidence(noise_group_equations(), z_, held, {.threads = threads_}, scale_, terms);
    return terms;
  }

  GaussianPrior prior() const {
    GaussianPrior total = base_prior_;
    add_smoothing(terms_, total);
    return total;
  }

  void minimise_all() {
    const MinimiseSummary summary =
        minimise(index_, weights(sigma()), *datum_, prior(), minimise_options(), z_);
    result_.iterations += summary.iterations;
    result_.final_cost = summary.final_cost;
    converged_ = summary.converged;
    parameters_ = datum_->raw(z_);
  }

  /// Stated weights of one noise group's observations, none of the others in its setups.
  std::vector<double> weights_of(std::size_t noise_group, const std::vector<bool>& setups) const {
    std::vector<double> weight = weights(stated_sigma_);
    for (std::size_t setup = 0; setup < setups.size(); ++setup) {
      if (!setups[setup]) continue;
      for_each_observation(setup, [&](std::size_t i, std::size_t g) {
        if (g != noise_group) weight[i] = 0.0;
      });
    }
    return weight;
  }

  std::vector<NoiseGroupEquations> noise_group_equations() const {
    std::vector<NoiseGroupEquations> equations;
    for (std::size_t g = 0; g < noise_groups_.size(); ++g) {
      std::vector<bool> setups;
      for (const auto& groups : group_of_channel_)
        setups.push_back(std::ranges::find(groups, g) != groups.end());
      const std::vector<double> weight = weights_of(g, setups);
      NormalAccumulator accumulator(index_, weight, nullptr, threads_);
      const NormalEquations& sums = accumulator.accumulate(parameters_, &setups);
      equations.push_back({datum_->reduce_matrix(sums.matrix), datum_->reduce_gradient(sums.gradient),
                           sums.squares, static_cast<double>(sums.observations)});
    }
    return equations;
  }

  void update_hyperparameters() {
    EvidenceOptions evidence;
    evidence.variance_components = options_.variance_components;
    evidence.threads = threads_;
    const EvidenceState state =
        maximise_evidence(noise_group_equations(), z_, base_prior_, evidence, scale_, terms_);
    scale_ = state.scale;
  }

  /// Renews what the model holds fixed during a minimisation. Shapes of effects that went further than their
  /// expansion holds are set back.
  void expand() {
    const Eigen::VectorXd before = parameters_;
    model_.approach_effects(parameters_);
    if (parameters_ != before) z_ = datum_->reduced(parameters_);
    if (options_.exact_kinematics) model_.set_second_order_remainder(parameters_);
  }

  void adjust() {
    progress("adjustment", 0.2);
    minimise_all();
    for (int round = 0; round < kEvidenceRounds && (!terms_.empty() || options_.variance_components);
         ++round) {
      progress("resolution and variance components", 0.3 + 0.2 * round);
      update_hyperparameters();
      expand();
      minimise_all();
    }
    expand();
    minimise_all();
    follow_shapes([this] { minimise_all(); });
  }

  /// Until the shapes of effects that are estimated stand where the last expansion holds.
  void follow_shapes(const std::function<void()>& minimise_again) {
    for (int steps = 0; !model_.follow_expansion(parameters_); ++steps) {
      expand();
      converged_ = steps < kShapeSteps;
      if (!converged_) return;
      minimise_again();
    }
  }

  /// After the noise has been estimated to be more than white.
  void adjust_to_noise(int evidence_rounds) {
    const WhitenedCampaign whitened(model_, *datum_, campaign_noise_, noise_, threads_);
    const auto renew = [this](Eigen::VectorXd& z) {  // z is z_, which expand() sets back
      parameters_ = datum_->raw(z);
      expand();
    };
    const auto adjust = [&] {
      correlated_ = adjust_correlated(whitened, base_prior_, evidence_rounds, renew, terms_, z_);
      parameters_ = datum_->raw(z_);
      result_.iterations += correlated_.iterations;
      result_.final_cost = correlated_.cost;
      converged_ = correlated_.converged;
    };
    adjust();
    follow_shapes(adjust);
  }

  bool models_noise() const {
    return options_.noise == NoisePolicy::Automatic && options_.loss == RobustLoss::None &&
           options_.variance_components;
  }

  /// Estimated about the white adjustment and once more about that which follows from it: smoothing chosen
  /// with white weights takes part of correlated drift for detail of the functions.
  void model_noise() {
    campaign_noise_ = noise_of_campaign();
    NoiseOptions options;
    options.threads = threads_;
    options.uncertainty = false;
    NoiseEstimate estimate = estimate_noise(model_, *datum_, campaign_noise_, z_, prior(), options);
    if (is_more_than_white(estimate)) {
      const WhiteAdjustment white{z_, terms_, converged_, result_.iterations, result_.final_cost};
      noise_ = estimate.parameters();
      adjust_to_noise(kEvidenceRounds);
      options.uncertainty = true;
      estimate = estimate_noise(model_, *datum_, campaign_noise_, z_, prior(), options, &estimate);
      noise_ = estimate.parameters();
      adjust_to_noise(1);
      if (rank_.deficient && !converged_) return take_back(white);
      remove_outliers();
    }
    result_.noise.estimated = true;
    result_.noise.more_than_white = is_more_than_white(estimate);
    result_.noise.groups = campaign_noise_.groups;
    result_.noise.rows = noise_table(estimate);
    for (const InstrumentNoise& own : estimate.instruments) white_log_u_.push_back(own.log_uncertainty.white);
  }

  struct WhiteAdjustment {
    Eigen::VectorXd z;
    std::vector<SmoothingTerm> terms;
    bool converged;
    int iterations;
    double final_cost;
  };

  /// Generalised steps need not contract where an error is not visible: then readings stay independent.
  void take_back(const WhiteAdjustment& white) {
    z_ = white.z;
    terms_ = white.terms;
    converged_ = white.converged;
    result_.iterations = white.iterations;
    result_.final_cost = white.final_cost;
    noise_.clear();
    parameters_ = datum_->raw(z_);
    expand();
  }

  CampaignNoise noise_of_campaign() const {
    return campaign_noise(model_, stated_sigma_, removed_, found_stations_ ? &*found_stations_ : nullptr);
  }

  void update_covariance() {
    if (!noise_.empty()) {
      reduced_covariance_ = correlated_.covariance;
      result_.covariance = datum_->expand_covariance(reduced_covariance_);
      return;
    }
    const std::vector<double> weight = weights(sigma());
    NormalAccumulator accumulator(index_, weight, nullptr, threads_);
    const NormalEquations& sums = accumulator.accumulate(parameters_);
    reduced_covariance_ = invert_precision(datum_->reduce_matrix(sums.matrix) + prior().precision).covariance;
    result_.covariance = datum_->expand_covariance(reduced_covariance_);
  }

  void update_residuals() {
    update_covariance();
    result_.outlier_critical_value =
        outlier_critical_value(index_.observations(), options_.outlier_family_risk);
    const std::vector<double> used = sigma();
    result_.residuals = residual_records(index_, used, weights(used), parameters_, result_.covariance,
                                         result_.outlier_critical_value, threads_);
  }

  /// Data snooping: the worst of each round's flagged readings go, setup by setup.
  void remove_outliers() {
    update_residuals();
    if (options_.outliers != OutlierPolicy::Remove) return;
    for (int round = 0; round < kOutlierRounds; ++round) {
      const std::vector<std::size_t> worst = worst_outliers(result_.residuals, kSurelyAsWell, kMostOutliers);
      if (!remove(worst)) break;
      readjust();
      update_residuals();
    }
  }

  /// Readings that alone determine a parameter beside others that go, as one of two on a line with an offset
  /// of its own, stay. False where none went.
  bool remove(const std::vector<std::size_t>& outliers) {
    for (const std::size_t i : outliers) removed_[i] = true;
    if (is_determined()) return !outliers.empty();
    for (const std::size_t i : outliers) removed_[i] = false;
    bool any = false;
    for (const std::size_t i : outliers) {
      removed_[i] = true;
      if (is_determined()) {
        any = true;
      } else {
        removed_[i] = false;
      }
    }
    return any;
  }

  /// Whether priors and the readings that were not removed determine every parameter.
  bool is_determined() const {
    constexpr double kLeastPivot = 1e-13;  // share of a pivot that is left of its diagonal
    const std::vector<double> weight = weights(sigma());
    NormalAccumulator accumulator(index_, weight, nullptr, threads_);
    const Eigen::MatrixXd matrix =
        datum_->reduce_matrix(accumulator.accumulate(parameters_).matrix) + prior().precision;
    const auto factor = cholesky_lower(matrix);
    return factor && (factor->diagonal().array().square() > kLeastPivot * matrix.diagonal().array()).all();
  }

  void readjust() {
    if (noise_.empty()) {
      update_hyperparameters();
      minimise_all();
    } else {
      campaign_noise_ = noise_of_campaign();
      adjust_to_noise(0);
    }
  }

  void finish() {
    result_.adjustment =
        std::make_shared<const Adjustment>(Adjustment{spec_, z_, base_prior_, terms_, stated_sigma_});
    result_.parameters = parameters_;
    result_.layout = model_.layout();
    result_.covariance += datum_->expand_covariance(amplitude_covariance(terms_, reduced_covariance_, z_));
    result_.setups = setup_summaries(campaign_, result_.residuals, stated_sigma_);
    for (std::size_t i = 0; i < result_.setups.size(); ++i)
      result_.setups[i].fingerprint = readings_fingerprint(campaign_.setups[i]);
    for (const SetupSummary& setup : result_.setups) {
      result_.chi2 += setup.chi2;
      result_.dof += setup.redundancy;
    }
    result_.sigma0 = result_.dof > 0.0 ? std::sqrt(result_.chi2 / result_.dof) : 0.0;
    summarise_variance_components();
    summarise_whitened_residuals();
    result_.functions = function_summaries(campaign_, spec_, *datum_, terms_, reduced_covariance_);
    result_.rank = rank_.report;
    complete_observability(campaign_, result_);
    result_.identified = identified_model(spec_, campaign_.machine, model_.layout(), parameters_);
    summarise_temperature(campaign_, result_);
    result_.conditions = recorded_conditions(campaign_);
    result_.standing = standing_rotary_axes(campaign_);
    if (options_.noise == NoisePolicy::Automatic && options_.loss != RobustLoss::None)
      result_.findings.push_back({FindingCode::NoiseTakenAsIndependent});
    judge(model_, {converged_, rank_.deficient}, result_);
  }

  void summarise_variance_components() {
    result_.variance_components =
        variance_components(noise_groups_, scale_, result_.residuals, group_of_channel_);
    for (std::size_t g = 0; g < noise_.size(); ++g) {
      auto& component = *std::ranges::find(result_.variance_components, campaign_noise_.groups[g],
                                           &VarianceComponent::instrument);
      component.scale = noise_[g].white;
      if (std::isfinite(white_log_u_[g])) component.scale_u = component.scale * white_log_u_[g];
    }
  }

  void summarise_whitened_residuals() {
    result_.noise.chi2 = correlated_.squares;
    result_.noise.dof = correlated_.redundancy;
    if (noise_.empty()) add_white_squares(result_.residuals, result_.noise);
  }

  const Campaign& campaign_;
  const FitOptions& options_;
  int threads_;
  ModelSpec spec_;
  MeasurementModel model_;
  ReadingIndex index_;
  std::vector<double> stated_sigma_;
  std::vector<bool> removed_;
  std::vector<std::string> noise_groups_;
  std::vector<std::vector<std::size_t>> group_of_channel_;  ///< per setup
  std::vector<double> scale_;
  Eigen::VectorXd parameters_;
  std::optional<Eigen::VectorXd> found_stations_;  ///< where the guesses are too far off for the noise
  std::unique_ptr<DatumSpace> datum_;
  Eigen::VectorXd z_;
  GaussianPrior base_prior_;
  std::vector<SmoothingTerm> terms_;
  RankAnalysis rank_;
  Eigen::MatrixXd reduced_covariance_;
  CampaignNoise campaign_noise_;
  std::vector<NoiseParameters> noise_;  ///< per instrument of it; empty = white
  std::vector<double> white_log_u_;
  CorrelatedAdjustment correlated_;
  bool converged_ = false;
  Stopwatch stopwatch_;
  FitResult result_;
};

}  // namespace

FitResult fit(const Campaign& campaign, const ModelSpec& spec, const FitOptions& options) {
  if (campaign.reading_count() == 0) {
    throw InputError({campaign.file, 0}, "the campaign has no readings",
                     "give at least one setup with a data file");
  }
  check_drivers_vary(campaign, spec);
  use_single_threaded_blas();
  return Identification(campaign, with_uncertain_values_open(campaign, spec), options).run();
}

}  // namespace volcal
