#include "ceres_covariance.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/normals/minimise.h"

namespace volcal::bench {
namespace {

/// A reading whose derivatives are known.
class GivenRow final : public ceres::CostFunction {
 public:
  explicit GivenRow(std::vector<Eigen::RowVectorXd> derivatives) : derivatives_(std::move(derivatives)) {
    for (const auto& block : derivatives_)
      mutable_parameter_block_sizes()->push_back(static_cast<int>(block.size()));
    set_num_residuals(1);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    residuals[0] = 0.0;
    for (std::size_t i = 0; jacobians != nullptr && i < derivatives_.size(); ++i) {
      if (jacobians[i] != nullptr) std::copy_n(derivatives_[i].data(), derivatives_[i].size(), jacobians[i]);
    }
    return true;
  }

 private:
  std::vector<Eigen::RowVectorXd> derivatives_;
};

std::vector<std::pair<int, int>> blocks_of(const DatumSpace& datum) {
  std::vector<std::pair<int, int>> blocks;
  for (const auto& function : datum.functions()) blocks.emplace_back(function.offset, function.size());
  for (const auto& block : datum.blocks()) blocks.emplace_back(block.offset, block.size);
  return blocks;
}

}  // namespace

struct CovariancePeers::Problem {
  Problem(ReferenceProblem reference, int thread_count)
      : source(std::move(reference)),
        model(source.campaign, source.model),
        index(model),
        start(model.initial_parameters()),
        datum(model.layout(), source.campaign.machine, start),
        blocks(blocks_of(datum)),
        threads(thread_count) {
    for (std::size_t setup = 0; setup < source.campaign.setups.size(); ++setup) {
      for (std::size_t row = 0; row < source.campaign.setups[setup].readings.size(); ++row)
        weight.push_back(std::pow(model.sigma(setup, row, 0, start), -2));
    }
    z = datum.reduced(start);
    MinimiseOptions options;
    options.threads = threads;
    minimise(index, weight, datum, GaussianPrior::none(datum.size()), options, z);
    accumulator = std::make_unique<NormalAccumulator>(index, weight, nullptr, threads);
    for (std::size_t setup = 0; setup < source.campaign.setups.size(); ++setup) {
      for (std::size_t row = 0; row < source.campaign.setups[setup].readings.size(); ++row) add(setup, row);
    }
  }

  void add(std::size_t setup, std::size_t row) {
    RowJacobian derivatives;
    model.linearize(setup, row, datum.raw(z), derivatives);
    const Eigen::VectorXd reduced = std::sqrt(weight[index.first_observation(setup, row)]) *
                                    datum.reduce_gradient(dense_row(model.layout(), derivatives, 0));
    const std::vector<bool> touched = datum.touched(touched_parameters(model.layout(), derivatives));
    std::vector<Eigen::RowVectorXd> of_blocks;
    std::vector<double*> parameters;
    for (const auto& [offset, size] : blocks) {
      if (!touched[static_cast<std::size_t>(offset)]) continue;
      of_blocks.emplace_back(reduced.segment(offset, size).transpose());
      parameters.push_back(z.data() + offset);
    }
    ceres.AddResidualBlock(new GivenRow(std::move(of_blocks)), nullptr, parameters);
  }

  ReferenceProblem source;
  MeasurementModel model;
  ReadingIndex index;
  Eigen::VectorXd start;
  DatumSpace datum;
  std::vector<std::pair<int, int>> blocks;
  int threads;
  std::vector<double> weight;
  Eigen::VectorXd z;
  std::unique_ptr<NormalAccumulator> accumulator;
  ceres::Problem ceres;
};

CovariancePeers::CovariancePeers(const ReferenceProblem& problem, int threads)
    : problem_(std::make_unique<Problem>(problem, threads)) {}

CovariancePeers::~CovariancePeers() = default;

std::size_t CovariancePeers::readings() const { return problem_->index.observations(); }

Eigen::MatrixXd CovariancePeers::from_normal_equations() const {
  const NormalEquations& sums = problem_->accumulator->accumulate(problem_->datum.raw(problem_->z));
  const auto factor = cholesky_lower(problem_->datum.reduce_matrix(sums.matrix));
  if (!factor) throw std::runtime_error("the normal equations are not positive definite");
  return inverse_from_cholesky(*factor);
}

Eigen::MatrixXd CovariancePeers::by_ceres() const {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = problem_->threads;
  ceres::Covariance covariance(options);
  std::vector<const double*> parameters;
  for (const auto& [offset, size] : problem_->blocks) parameters.push_back(problem_->z.data() + offset);
  if (!covariance.Compute(parameters, &problem_->ceres))
    throw std::runtime_error("ceres::Covariance did not succeed");
  Eigen::MatrixXd matrix(problem_->datum.size(), problem_->datum.size());
  if (!covariance.GetCovarianceMatrix(parameters, matrix.data()))
    throw std::runtime_error("ceres::Covariance gives no matrix");
  return matrix;
}

}  // namespace volcal::bench
