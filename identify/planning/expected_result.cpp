#include "volcal/identify/planning/expected_result.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/error_grid.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/planning/plan_problem.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/normals/normal_equations.h"
#include "volcal/identify/solve/normals/stated_sigma.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/rank.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

/// One prediction, in the order of the fit's stages.
class Expectation {
 public:
  Expectation(const Campaign& campaign, const ModelSpec& spec, const FunctionRoughnessGuess& roughness,
              int threads)
      : campaign_(campaign),
        spec_(resolve_knots(spec, campaign)),
        model_(campaign, spec_),
        index_(model_),
        parameters_(model_.initial_parameters()),
        datum_(model_.layout(), campaign.machine, parameters_),
        z_(datum_.reduced(parameters_)),
        sigma_(stated_sigma(index_, parameters_)) {
    use_single_threaded_blas();
    find_information(thread_count(threads));
    find_prior(roughness);
  }

  FitResult run() {
    const auto factor = cholesky_lower(information_ + prior_.precision);
    if (!factor) throw std::runtime_error("the expected normal matrix is not positive definite");
    const Eigen::MatrixXd covariance = inverse_from_cholesky(*factor);
    result_.machine = campaign_.machine;
    result_.layout = model_.layout();
    result_.parameters = parameters_;
    result_.covariance = datum_.expand_covariance(covariance);
    result_.sigma0 = 1.0;
    result_.rank = rank_.report;
    result_.status = rank_.deficient ? FitStatus::RankDeficient : FitStatus::Ok;
    result_.functions = function_summaries(campaign_, spec_, datum_, terms_, covariance);
    result_.identified = identified_model(spec_, campaign_.machine, model_.layout(), parameters_);
    result_.adjustment =
        std::make_shared<const Adjustment>(Adjustment{spec_, z_, base_prior_, terms_, sigma_});
    list_residuals();
    complete_observability(campaign_, result_);
    return std::move(result_);
  }

 private:
  void find_information(int threads) {
    std::vector<double> weight = sigma_;
    for (double& each : weight) each = 1.0 / (each * each);
    for (const std::size_t left_out : index_.left_out()) weight[left_out] = 0.0;
    NormalAccumulator accumulator(index_, weight, nullptr, threads);
    information_ = datum_.reduce_matrix(accumulator.accumulate(parameters_).matrix);
  }

  void find_prior(const FunctionRoughnessGuess& roughness) {
    base_prior_ = stated_priors(model_, datum_);
    const Eigen::MatrixXd data = information_ + base_prior_.precision;
    const GaussianPrior wide = above_rounding(data, wide_prior(model_, datum_, z_, sigma_));
    rank_ = analyse_rank(model_, datum_, data, wide);
    hold_undetermined(rank_, wide, base_prior_);
    terms_ = assumed_smoothing(model_, datum_, roughness);
    hold_invisible(rank_, terms_, base_prior_);
    leave_imitated_to_the_rest(information_, base_prior_, terms_);
    base_prior_.mean = z_;
    prior_ = base_prior_;
    add_smoothing(terms_, prior_);
  }

  void list_residuals() {
    std::size_t observation = 0;
    for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
      const Setup& source = campaign_.setups[setup];
      SetupSummary& summary = result_.setups.emplace_back();
      summary.name = source.name;
      summary.instrument = source.instrument;
      summary.tool = campaign_.machine.tools[source.tool].name;
      summary.reading_unit = residual_unit(source, 0);
      for (std::size_t row = 0; row < source.readings.size(); ++row) {
        for (int channel = 0; channel < model_.bound(setup).channels(); ++channel) {
          ResidualRecord record;
          record.setup = setup;
          record.row = row;
          record.channel = channel;
          record.sigma = sigma_[observation++];
          result_.residuals.push_back(record);
          ++summary.observations;
        }
      }
    }
    for (const std::size_t left_out : index_.left_out()) {
      result_.residuals[left_out].removed = result_.residuals[left_out].left_out = true;
    }
  }

  const Campaign& campaign_;
  ModelSpec spec_;
  MeasurementModel model_;
  ReadingIndex index_;
  Eigen::VectorXd parameters_;
  DatumSpace datum_;
  Eigen::VectorXd z_;
  std::vector<double> sigma_;
  Eigen::MatrixXd information_;
  GaussianPrior base_prior_;
  GaussianPrior prior_;
  std::vector<SmoothingTerm> terms_;
  RankAnalysis rank_;
  FitResult result_;
};

/// Error functions go on beyond the readings: there an uncertainty is that of the function, not that of the
/// last value, which a table holds.
FitResult without_measured_ends(FitResult result) {
  for (FunctionSummary& function : result.functions) {
    function.measured_min = -std::numeric_limits<double>::infinity();
    function.measured_max = std::numeric_limits<double>::infinity();
  }
  return result;
}

/// Of displacements at many poses.
class VarianceSum {
 public:
  void add(double variance) {
    sum_ += variance;
    largest_ = std::max(largest_, variance);
    count_ += 1.0;
  }
  VolumetricUncertainty uncertainty() const {
    VolumetricUncertainty out;
    out.rms = std::sqrt(sum_ / std::max(1.0, count_));
    out.largest = std::sqrt(largest_);
    return out;
  }

 private:
  double sum_ = 0.0;
  double largest_ = 0.0;
  double count_ = 0.0;
};

}  // namespace

FitResult expected_result(const Campaign& campaign, const ModelSpec& model,
                          const FunctionRoughnessGuess& roughness, int threads) {
  return Expectation(campaign, model, roughness, threads).run();
}

VolumetricUncertainty volumetric_uncertainty(const FitResult& result, const std::vector<Tool>& tools,
                                             int per_axis) {
  const FitResult everywhere = without_measured_ends(result);
  VarianceSum sum;
  for (const Tool& tool : tools) {
    const ErrorGrid errors(everywhere, tool, axis_grid(result.machine, per_axis));
    for (const Covariance3& covariance : errors.displacement_covariances()) {
      sum.add(covariance.variances().sum());
    }
  }
  return sum.uncertainty();
}

VolumetricUncertainty uncertainty_at_poses(const FitResult& result, const std::vector<Tool>& tools,
                                           const std::vector<std::vector<AxisPosition>>& poses) {
  const FitResult everywhere = without_measured_ends(result);
  VarianceSum sum;
  for (std::size_t tool = 0; tool < tools.size(); ++tool) {
    const ErrorField field(everywhere, tools[tool]);
    for (const AxisPosition& position : poses[tool]) {
      const Eigen::Matrix<double, 3, Eigen::Dynamic> rows = field.rows(position).topRows<3>();
      sum.add((rows * everywhere.covariance * rows.transpose()).trace() + 3.0 * field.stated_tool_variance());
    }
  }
  return sum.uncertainty();
}

}  // namespace volcal
