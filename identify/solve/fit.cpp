#include "volcal/identify/solve/fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <sstream>
#include <thread>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/rank.h"
#include "volcal/identify/solve/residuals.h"
#include "volcal/identify/solve/resolution.h"
#include "volcal/identify/solve/smoothing.h"
#include "volcal/identify/stats/chi_squared.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"

namespace volcal {

std::string_view to_string(FitStatus status) {
  switch (status) {
    case FitStatus::Ok:
      return "ok";
    case FitStatus::LackOfFit:
      return "lack_of_fit";
    case FitStatus::RankDeficient:
      return "rank_deficient";
    case FitStatus::NotConverged:
      return "not_converged";
  }
  return "";
}

namespace {

constexpr double kSignificanceOfLackOfFit = 1e-3;
constexpr double kSmallestLackOfFit = 1.1;     // sigma0 below this is not worth a warning
constexpr double kImplausibleResidual = 0.02;  // nominal machine, share of the setup's extent
constexpr double kFurthestStationMiss = 1.0;   // m
constexpr int kEvidenceRounds = 2;
constexpr int kOutlierRounds = 10;

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The state of one identification; each method is one stage.
class Identification {
 public:
  Identification(const Campaign& campaign, const ModelSpec& spec, const FitOptions& options)
      : campaign_(campaign),
        options_(options),
        threads_(options.threads > 0 ? options.threads
                                     : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        spec_(resolve_knots(spec, campaign)),
        model_(campaign, spec_),
        index_(model_) {
    result_.machine = campaign.machine;
    parameters_ = model_.initial_parameters();
    set_sigma();
    group_by_instrument();
  }

  FitResult run() {
    progress("nuisance parameters on the nominal machine", 0.0);
    fit_nuisance();
    check_plausible();
    lap("nuisance parameters");
    progress("rank analysis", 0.1);
    find_rank();
    lap("rank analysis");
    adjust();
    remove_outliers();
    lap("adjustment");
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

  void set_sigma() {
    stated_sigma_.resize(index_.observations());
    for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
      for (std::size_t row = 0; row < campaign_.setups[setup].readings.size(); ++row) {
        for (int channel = 0; channel < model_.bound(setup).channels(); ++channel) {
          const double sigma = model_.sigma(setup, row, channel, parameters_);
          if (!(sigma > 0.0)) {
            throw InputError({campaign_.file, campaign_.setups[setup].source_line},
                             "setup \"" + campaign_.setups[setup].name +
                                 "\": the standard deviation of its readings is zero",
                             "give noise = { constant_um = ... } or a sigma_um column");
          }
          stated_sigma_[index_.first_observation(setup, row) + static_cast<std::size_t>(channel)] = sigma;
        }
      }
    }
    removed_.assign(stated_sigma_.size(), false);
  }

  void group_by_instrument() {
    for (const Setup& setup : campaign_.setups) {
      const auto found = std::ranges::find(instruments_, setup.instrument);
      instrument_of_setup_.push_back(static_cast<std::size_t>(found - instruments_.begin()));
      if (found == instruments_.end()) instruments_.push_back(setup.instrument);
    }
    scale_.assign(instruments_.size(), 1.0);
  }

  std::vector<double> sigma() const {
    std::vector<double> sigma = stated_sigma_;
    for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
      const std::size_t begin = index_.first_observation(setup, 0);
      const std::size_t count =
          campaign_.setups[setup].readings.size() * static_cast<std::size_t>(model_.bound(setup).channels());
      for (std::size_t i = begin; i < begin + count; ++i) sigma[i] *= scale_[instrument_of_setup_[setup]];
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

  /// Priors that the user (or an instrument's weak default) gives to blocks.
  GaussianPrior block_priors(const DatumSpace& datum) const {
    GaussianPrior prior = GaussianPrior::none(datum.size());
    for (const auto& block : datum.blocks()) {
      const ParameterBlock& source = model_.layout().blocks[block.block];
      for (int k = 0; k < block.size; ++k) {
        if (source.prior_sigma[k] == 0.0) continue;
        prior.precision(block.offset + k, block.offset + k) =
            1.0 / (source.prior_sigma[k] * source.prior_sigma[k]);
        prior.mean[block.offset + k] = source.prior_mean[k];
      }
    }
    return prior;
  }

  void fit_nuisance() {
    const DatumSpace datum(
        model_.layout(), campaign_.machine, parameters_, [](ErrorSymbol) { return false; },
        [](const ParameterBlock& block) { return block.kind == ParameterKind::Nuisance; });
    Eigen::VectorXd z = datum.reduced(parameters_);
    GaussianPrior prior = block_priors(datum);
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

  /// Readings that the nominal machine misses by centimetres are in another unit or another setup's file.
  void check_plausible() const {
    const auto records =
        residual_records(index_, stated_sigma_, weights(stated_sigma_), parameters_, {}, 1e300, threads_);
    const auto summaries = setup_summaries(campaign_, records, stated_sigma_);
    for (std::size_t i = 0; i < summaries.size(); ++i) {
      if (summaries[i].reading_unit != "um") continue;
      double extent = 0.0;
      for (const Axis& axis : campaign_.machine.axes) {
        if (!is_rotary(axis.name)) extent = std::max(extent, axis.travel());
      }
      if (summaries[i].rms_residual < kImplausibleResidual * extent) continue;
      std::ostringstream problem;
      problem << "setup \"" << summaries[i].name << "\": its readings miss the nominal machine by "
              << summaries[i].rms_residual * 1e3 << " mm RMS";
      throw InputError(
          {campaign_.setups[i].data.empty() ? campaign_.file : campaign_.setups[i].data, 0}, problem.str(),
          "check the unit of the reading column (scale = { ... = 1000.0 }), the tool and the station");
    }
  }

  void find_rank() {
    datum_ = std::make_unique<DatumSpace>(model_.layout(), campaign_.machine, parameters_);
    z_ = datum_->reduced(parameters_);
    const std::vector<double> weight = weights(stated_sigma_);
    NormalAccumulator accumulator(index_, weight, nullptr, threads_);
    const NormalEquations& sums = accumulator.accumulate(parameters_);
    result_.initial_cost = sums.cost;
    const GaussianPrior priors = block_priors(*datum_);
    const GaussianPrior wide = wide_prior(model_, *datum_, z_);
    rank_ = analyse_rank(model_, *datum_, datum_->reduce_matrix(sums.matrix) + priors.precision, wide);
    base_prior_ = priors;
    hold_undetermined(wide);
    terms_ = smoothing_terms(model_, *datum_);
    for (SmoothingTerm& term : terms_) {
      term.estimate =
          std::ranges::find(rank_.invisible_functions, term.symbol) == rank_.invisible_functions.end();
    }
  }

  /// The wide prior, where there is no other, on what the readings may not determine.
  void hold_undetermined(const GaussianPrior& wide) {
    const bool unresolved = rank_.report.rank < rank_.report.parameters;
    if (!unresolved) return;
    base_prior_.mean = (base_prior_.precision.diagonal().array() > 0.0).select(base_prior_.mean, wide.mean);
    base_prior_.precision += wide.precision;
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

  std::vector<InstrumentEquations> instrument_equations() const {
    std::vector<InstrumentEquations> equations;
    const std::vector<double> weight = weights(stated_sigma_);
    NormalAccumulator accumulator(index_, weight, nullptr, threads_);
    for (std::size_t g = 0; g < instruments_.size(); ++g) {
      std::vector<bool> include;
      for (const std::size_t instrument : instrument_of_setup_) include.push_back(instrument == g);
      const NormalEquations& sums =
          accumulator.accumulate(parameters_, instruments_.size() == 1 ? nullptr : &include);
      equations.push_back({datum_->reduce_matrix(sums.matrix), datum_->reduce_gradient(sums.gradient),
                           sums.squares, static_cast<double>(sums.observations)});
    }
    return equations;
  }

  void update_hyperparameters() {
    EvidenceOptions evidence;
    evidence.variance_components = options_.variance_components;
    const EvidenceState state =
        maximise_evidence(instrument_equations(), z_, base_prior_, evidence, scale_, terms_);
    scale_ = state.scale;
  }

  /// Renews what the model holds fixed during a minimisation.
  void expand() {
    model_.expand_effects(parameters_);
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
  }

  void update_covariance() {
    const std::vector<double> weight = weights(sigma());
    NormalAccumulator accumulator(index_, weight, nullptr, threads_);
    const NormalEquations& sums = accumulator.accumulate(parameters_);
    const auto factor = cholesky_lower(datum_->reduce_matrix(sums.matrix) + prior().precision);
    if (!factor)
      throw std::runtime_error("the normal matrix is not positive definite after the rank analysis");
    reduced_covariance_ = inverse_from_cholesky(*factor);
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

  /// Data snooping: the worst of each round's flagged readings go, one per setup and round.
  void remove_outliers() {
    update_residuals();
    if (options_.outliers != OutlierPolicy::Remove) return;
    for (int round = 0; round < kOutlierRounds; ++round) {
      std::map<std::size_t, std::size_t> worst;
      for (std::size_t i = 0; i < result_.residuals.size(); ++i) {
        const ResidualRecord& record = result_.residuals[i];
        if (!record.flagged || record.removed) continue;
        const auto [place, is_new] = worst.try_emplace(record.setup, i);
        if (std::abs(record.w) > std::abs(result_.residuals[place->second].w)) place->second = i;
      }
      if (worst.empty()) break;
      for (const auto& [setup, i] : worst) removed_[i] = true;
      update_hyperparameters();
      minimise_all();
      update_residuals();
    }
  }

  void finish() {
    const GaussianPrior last_prior = prior();
    result_.adjustment = {spec_, z_, last_prior.precision, last_prior.mean, stated_sigma_};
    result_.parameters = parameters_;
    result_.layout = model_.layout();
    result_.covariance += datum_->expand_covariance(amplitude_covariance(terms_, reduced_covariance_, z_));
    result_.setups = setup_summaries(campaign_, result_.residuals, stated_sigma_);
    for (const SetupSummary& setup : result_.setups) {
      result_.chi2 += setup.chi2;
      result_.dof += setup.redundancy;
    }
    result_.sigma0 = result_.dof > 0.0 ? std::sqrt(result_.chi2 / result_.dof) : 0.0;
    summarise_variance_components();
    summarise_functions();
    result_.rank = rank_.report;
    update_observability();
    result_.identified = identified_model();
    summarise_temperature();
    judge();
  }

  void summarise_variance_components() {
    for (std::size_t g = 0; g < instruments_.size(); ++g) {
      VarianceComponent component;
      component.instrument = instruments_[g];
      component.scale = scale_[g];
      for (std::size_t i = 0; i < campaign_.setups.size(); ++i) {
        if (instrument_of_setup_[i] != g) continue;
        component.redundancy += result_.setups[i].redundancy;
        component.observations += result_.setups[i].observations;
      }
      component.scale_u =
          component.redundancy > 0.0 ? component.scale / std::sqrt(2.0 * component.redundancy) : 0.0;
      result_.variance_components.push_back(component);
    }
  }

  void summarise_functions() {
    for (const auto& function : datum_->functions()) {
      FunctionSummary summary;
      summary.symbol = function.symbol;
      const FunctionSpec& spec = spec_.function(function.symbol);
      summary.intervals = std::max(0, static_cast<int>(spec.breakpoints.size()) - 1);
      summary.effective_parameters = function.size();
      for (const SmoothingTerm& term : terms_) {
        if (term.symbol != function.symbol) continue;
        summary.smoothed = true;
        summary.prior = to_string(term.prior_shape().roughness);
        summary.correlation_length =
            term.prior_shape().length * campaign_.machine.axis(function.symbol.axis).travel();
        const auto n = term.precision().rows();
        summary.effective_parameters -=
            term.lambda *
            reduced_covariance_.block(term.offset, term.offset, n, n).cwiseProduct(term.precision()).sum();
      }
      const MeasuredRange range = measured_range(campaign_, function.symbol.axis);
      summary.measured_min = range.min;
      summary.measured_max = range.max;
      result_.functions.push_back(summary);
    }
  }

  /// Observability with the final noise and resolution instead of the rank analysis' wide priors.
  void update_observability() {
    for (Observability& figure : result_.rank.errors) {
      for (const FunctionSummary& function : result_.functions) {
        if (function.symbol.name() == figure.symbol)
          figure.effective_parameters = function.effective_parameters;
      }
      if (figure.visible) figure.u_rms = mean_uncertainty(figure.symbol);
    }
  }

  double mean_uncertainty(const std::string& name) const {
    const auto symbol = ErrorSymbol::parse(name);
    if (!symbol) {
      const int offset = model_.layout().find_block(name)->offset;
      return std::sqrt(result_.covariance(offset, offset));
    }
    constexpr int kPositions = 33;
    const auto place = *model_.layout().find(*symbol);
    const FunctionGroup& group = model_.layout().groups[static_cast<std::size_t>(place.group)];
    const MeasuredRange range = measured_range(campaign_, symbol->axis);
    std::vector<int> raw;
    for (int j = 0; j < group.basis->size(); ++j) raw.push_back(group.index(j, place.slot));
    const Eigen::MatrixXd covariance = result_.covariance(raw, raw);
    double sum = 0.0;
    for (int i = 0; i < kPositions; ++i) {
      const Eigen::VectorXd row =
          group.basis->row(range.min + (range.max - range.min) * static_cast<double>(i) / (kPositions - 1));
      sum += row.dot(covariance * row);
    }
    return std::sqrt(sum / kPositions);
  }

  ModelSpec identified_model() const {
    ModelSpec identified = spec_;
    identified.file.clear();
    for (const ErrorSymbol symbol : model_.layout().symbols()) {
      FunctionSpec& function = identified.functions[symbol];
      function.knots = KnotChoice::Explicit;
      const Eigen::VectorXd coefficients = model_.layout().coefficients(symbol, parameters_);
      function.coefficients.assign(coefficients.begin(), coefficients.end());
    }
    for (const ParameterBlock& block : model_.layout().blocks) {
      if (block.location) identified.locations[*block.location] = parameters_[block.offset];
    }
    for (EffectSpec& effect : identified.effects) {
      const auto made = find_effect(effect.kind)->make(effect, spec_.file);
      const auto keep = [&](const std::string& label, const std::string& key) {
        const ParameterBlock* block = model_.layout().find_block(label);
        if (block != nullptr) effect.options.set(std::string(stem_of_key(key)), parameters_[block->offset]);
      };
      for (const EffectAmplitude& amplitude : made->amplitudes()) keep(amplitude.label, amplitude.key);
      for (const EffectShape& shape : made->shapes()) keep(shape.label, shape.key);
    }
    return identified;
  }

  void summarise_temperature() {
    const bool expands =
        std::ranges::any_of(campaign_.machine.axes, [](const Axis& a) { return a.expansion.has_value(); });
    if (expands) return;
    double sum = 0.0;
    std::size_t count = 0;
    for (const Setup& setup : campaign_.setups) {
      for (const auto& [channel, values] : setup.readings.temperature) {
        for (const double value : values) sum += value;
        count += values.size();
      }
    }
    result_.temperature_is_campaign_mean = true;
    result_.reference_temperature_degC = count > 0 ? sum / static_cast<double>(count) : std::nan("");
  }

  void judge() {
    for (const VarianceComponent& component : result_.variance_components) {
      if (std::abs(component.scale - 1.0) < std::max(0.1, 3.0 * component.scale_u)) continue;
      std::ostringstream text;
      text.precision(3);
      text << component.instrument << ": its residuals scatter " << component.scale
           << " times as much as its stated sigma; "
           << "weights and uncertainties use the estimated value";
      result_.messages.push_back(text.str());
    }
    const double exceedance = result_.dof > 0.0 ? chi_squared_exceedance(result_.chi2, result_.dof) : 1.0;
    const bool lack = exceedance < kSignificanceOfLackOfFit && result_.sigma0 > kSmallestLackOfFit;
    for (const std::string& sentence : result_.rank.invisible) result_.messages.push_back(sentence);
    report_outliers();
    report_unrecorded_drivers();
    if (lack) {
      std::ostringstream text;
      text.precision(3);
      text << "lack of fit: residuals are " << result_.sigma0
           << " times the stated noise; run `volcal compare` to see where the model fails";
      result_.messages.push_back(text.str());
    }
    if (!converged_)
      result_.messages.push_back("not converged: the cost still fell after the last iteration");
    result_.status = !converged_       ? FitStatus::NotConverged
                     : rank_.deficient ? FitStatus::RankDeficient
                     : lack            ? FitStatus::LackOfFit
                                       : FitStatus::Ok;
  }

  void report_outliers() {
    const auto flagged = std::ranges::count_if(
        result_.residuals, [](const ResidualRecord& r) { return r.flagged && !r.removed; });
    const auto removed = std::ranges::count_if(result_.residuals, &ResidualRecord::removed);
    if (flagged > 0) {
      result_.messages.push_back(
          std::to_string(flagged) +
          " readings are flagged by the w-test and still in the adjustment; they are listed in "
          "residuals.csv (--outliers remove takes them out)");
    }
    if (removed > 0) {
      result_.messages.push_back(std::to_string(removed) +
                                 " readings were removed by the w-test; they are listed in residuals.csv");
    }
  }

  void report_unrecorded_drivers() {
    for (const EffectBinding& effect : model_.binding().effects) {
      std::size_t unrecorded = 0;
      for (const Setup& setup : campaign_.setups)
        unrecorded += effect.effect->unrecorded({campaign_, setup, {}, {}});
      if (unrecorded == 0) continue;
      result_.messages.push_back(effect.effect->amplitudes().front().label + ": " +
                                 std::to_string(unrecorded) + " readings do not record " +
                                 effect.effect->name().driver + " and carry nothing of the effect");
    }
  }

  const Campaign& campaign_;
  const FitOptions& options_;
  int threads_;
  ModelSpec spec_;
  MeasurementModel model_;
  ReadingIndex index_;
  std::vector<double> stated_sigma_;
  std::vector<bool> removed_;
  std::vector<std::string> instruments_;
  std::vector<std::size_t> instrument_of_setup_;
  std::vector<double> scale_;
  Eigen::VectorXd parameters_;
  std::unique_ptr<DatumSpace> datum_;
  Eigen::VectorXd z_;
  GaussianPrior base_prior_;
  std::vector<SmoothingTerm> terms_;
  RankAnalysis rank_;
  Eigen::MatrixXd reduced_covariance_;
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
  use_single_threaded_blas();
  return Identification(campaign, spec, options).run();
}

}  // namespace volcal
