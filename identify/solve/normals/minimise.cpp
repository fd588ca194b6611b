#include "volcal/identify/solve/normals/minimise.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/normals/sample_start.h"

namespace volcal {

GaussianPrior GaussianPrior::none(int size) {
  return {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
}

double GaussianPrior::cost(const Eigen::VectorXd& z) const {
  const Eigen::VectorXd d = z - mean;
  return 0.5 * d.dot(precision * d);
}

namespace {

std::unique_ptr<ceres::LossFunction> make_loss(const MinimiseOptions& options) {
  switch (options.loss) {
    case RobustLoss::Huber:
      return std::make_unique<ceres::HuberLoss>(options.loss_width);
    case RobustLoss::Cauchy:
      return std::make_unique<ceres::CauchyLoss>(options.loss_width);
    case RobustLoss::None:
      break;
  }
  return nullptr;
}

constexpr double kContraction = 1e-3;
constexpr double kFarFromPromise = 100.0;
constexpr double kNegligible = 1e-13;  // of the cost

/// Root R and vector v with R^T R = matrix and R^T v = gradient; true for a triangular R, false when it had
/// to fall back on the visible eigenspace.
bool square_root(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& gradient, Eigen::MatrixXd& root,
                 Eigen::VectorXd& vector) {
  if (const auto lower = cholesky_lower(matrix)) {
    root = lower->transpose();
    vector = lower->triangularView<Eigen::Lower>().solve(gradient);
    return true;
  }
  const SymmetricEigen eigen = eigen_decomposition(matrix);
  const double floor = 1e-14 * std::max(eigen.values.maxCoeff(), 0.0);
  root = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols());
  vector = Eigen::VectorXd::Zero(matrix.rows());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (eigen.values[i] <= floor) continue;
    const double s = std::sqrt(eigen.values[i]);
    root.row(i) = s * eigen.vectors.col(i).transpose();
    vector[i] = eigen.vectors.col(i).dot(gradient) / s;
  }
  return false;
}

class CompressedCost final : public ceres::CostFunction {
 public:
  CompressedCost(NormalAccumulator& accumulator, const DatumSpace& datum, const GaussianPrior& prior)
      : accumulator_(accumulator), datum_(datum), prior_(prior) {
    mutable_parameter_block_sizes()->push_back(datum.size());
    set_num_residuals(datum.size() + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int n = datum_.size();
    const Eigen::Map<const Eigen::VectorXd> z(parameters[0], n);
    const bool wants_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    const bool is_first = root_.size() == 0;
    if (z_.size() != z.size() || z_ != z) accumulate(z, is_first ? wants_jacobian : is_far_from_minimum());
    if (!std::isfinite(cost_)) return false;
    Eigen::Map<Eigen::VectorXd> out(residuals, n + 1);
    out.setZero();
    if (!wants_jacobian) {
      out[n] = std::sqrt(2.0 * cost_);
      return true;
    }
    if (is_first || matrix_is_here_ || !matrix_serves()) renew_root();
    out.head(n) = newton_;
    out[n] = std::sqrt(std::max(0.0, 2.0 * cost_ - newton_.squaredNorm()));
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> jacobian(jacobians[0], n + 1, n);
    jacobian.topRows(n) = root_;
    jacobian.row(n).setZero();
    return true;
  }

  /// Of the next start, the Jacobian of which Ceres then has for nothing.
  double cost_at_start(const Eigen::VectorXd& z) const {
    accumulate(z, true);
    return cost_;
  }

 private:
  /// Ceres asks for the cost of a step first and, when it is taken, for the Jacobian at the same point.
  void accumulate(const Eigen::VectorXd& z, bool with_matrix) const {
    z_ = z;
    const NormalEquations& sums =
        accumulator_.accumulate(datum_.raw(z_), nullptr, with_matrix ? Sums::All : Sums::AllButMatrix);
    if (with_matrix) matrix_ = datum_.reduce_matrix(sums.matrix) + prior_.precision;
    matrix_is_here_ = with_matrix;
    gradient_ = datum_.reduce_gradient(sums.gradient) + prior_.gradient(z_);
    cost_ = sums.cost + prior_.cost(z_);
  }

  /// The step that leads away from here is so large that the matrix will have to be renewed.
  bool is_far_from_minimum() const {
    const double promise = 0.5 * newton_.squaredNorm();
    return promise > kFarFromPromise * (cost_ - promise);
  }

  /// Whether the root of an earlier point still makes good steps (chord method): the step that it promises
  /// has fallen by kContraction since the step before, or is negligible. Sets `newton_`.
  bool matrix_serves() const {
    const double before = newton_.norm();
    const Eigen::VectorXd newton = root_.transpose().triangularView<Eigen::Lower>().solve(gradient_);
    const double now = newton.norm();
    const bool serves =
        is_triangular_ && (now < kContraction * before || 0.5 * now * now < kNegligible * cost_);
    if (serves) newton_ = newton;
    return serves;
  }

  void renew_root() const {
    if (!matrix_is_here_) accumulate(Eigen::VectorXd(z_), true);
    is_triangular_ = square_root(matrix_, gradient_, root_, newton_);
  }

  NormalAccumulator& accumulator_;
  const DatumSpace& datum_;
  const GaussianPrior& prior_;
  mutable Eigen::VectorXd z_;
  mutable Eigen::MatrixXd matrix_;
  mutable bool matrix_is_here_ = false;  ///< at z_
  mutable Eigen::VectorXd gradient_;
  mutable double cost_ = 0.0;
  mutable Eigen::MatrixXd root_;  ///< of this or an earlier point's matrix
  mutable bool is_triangular_ = false;
  mutable Eigen::VectorXd newton_;  ///< R^-T g: half its square is what a step promises
};

ceres::Solver::Options solver_options(const MinimiseOptions& options) {
  ceres::Solver::Options ceres_options;
  ceres_options.minimizer_type = ceres::TRUST_REGION;
  ceres_options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  ceres_options.initial_trust_region_radius = 1e8;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.function_tolerance = options.function_tolerance;
  ceres_options.gradient_tolerance = 1e-14;
  ceres_options.parameter_tolerance = 1e-12;
  ceres_options.num_threads = options.threads;
  ceres_options.logging_type = ceres::SILENT;
  return ceres_options;
}

MinimiseSummary summarise(const ceres::Solver::Summary& ceres_summary) {
  return {ceres_summary.termination_type == ceres::CONVERGENCE,
          static_cast<int>(ceres_summary.iterations.size()) - 1, ceres_summary.initial_cost,
          ceres_summary.final_cost, ceres_summary.message};
}

/// Moves `z` to a better start, where a sample of the readings finds one that all of them confirm.
void begin_on_sample(const ReadingIndex& index, const std::vector<double>& weight, const DatumSpace& datum,
                     const GaussianPrior& prior, const MinimiseOptions& options, const CompressedCost& cost,
                     Eigen::VectorXd& z) {
  if (options.loss != RobustLoss::None || index.observations() < options.sample_from) return;
  const auto start = find_start_on_sample(index, weight, datum, prior, options.threads, z);
  if (start && cost.cost_at_start(start->z) < start->cost_before) z = start->z;
}

MinimiseSummary minimise_compressed(const ReadingIndex& index, const std::vector<double>& weight,
                                    const DatumSpace& datum, const GaussianPrior& prior,
                                    const MinimiseOptions& options, Eigen::VectorXd& z) {
  const auto loss = make_loss(options);
  NormalAccumulator accumulator(index, weight, loss.get(), options.threads);
  auto cost = std::make_unique<CompressedCost>(accumulator, datum, prior);
  begin_on_sample(index, weight, datum, prior, options, *cost, z);
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, z.data());
  ceres::Solver::Options ceres_options = solver_options(options);
  ceres_options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  ceres_options.dense_linear_algebra_library_type = ceres::LAPACK;
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &problem, &summary);
  return summarise(summary);
}

/// The plain problem's parameter blocks: one per function and per block, in reduced coordinates.
struct ReducedBlocks {
  explicit ReducedBlocks(const DatumSpace& datum) {
    for (const auto& function : datum.functions()) add(function.offset, function.size());
    for (const auto& block : datum.blocks()) add(block.offset, block.size);
  }
  void add(int offset, int size) {
    if (size > 0) blocks.emplace_back(offset, size);
  }
  std::vector<std::pair<int, int>> blocks;  ///< offset, size
};

/// Whitened "predicted minus observed" of one reading.
class ReadingCost final : public ceres::CostFunction {
 public:
  ReadingCost(const MeasurementModel& model, const DatumSpace& datum, std::vector<std::pair<int, int>> blocks,
              std::size_t setup, std::size_t row, int channel, double weight)
      : model_(model),
        datum_(datum),
        blocks_(std::move(blocks)),
        setup_(setup),
        row_(row),
        channel_(channel),
        scale_(std::sqrt(weight)) {
    for (const auto& [offset, size] : blocks_) mutable_parameter_block_sizes()->push_back(size);
    set_num_residuals(1);
  }

  void set_all(const Eigen::VectorXd* z) { all_ = z; }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::VectorXd z = *all_;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      z.segment(blocks_[b].first, blocks_[b].second) =
          Eigen::Map<const Eigen::VectorXd>(parameters[b], blocks_[b].second);
    }
    RowJacobian row;
    model_.linearize(setup_, row_, datum_.raw(z), row);
    const auto& value = model_.campaign().setups[setup_].readings.value;
    residuals[0] = scale_ * (row.predicted[channel_] - value[static_cast<std::size_t>(channel_)][row_]);
    if (jacobians == nullptr) return true;
    const Eigen::VectorXd gradient = datum_.reduce_gradient(dense_row(model_.layout(), row, channel_));
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      Eigen::Map<Eigen::VectorXd>(jacobians[b], blocks_[b].second) =
          scale_ * gradient.segment(blocks_[b].first, blocks_[b].second);
    }
    return true;
  }

 private:
  const MeasurementModel& model_;
  const DatumSpace& datum_;
  std::vector<std::pair<int, int>> blocks_;
  std::size_t setup_;
  std::size_t row_;
  int channel_;
  double scale_;
  const Eigen::VectorXd* all_ = nullptr;
};

/// Prior as root (z - mean) over all blocks.
class PriorCost final : public ceres::CostFunction {
 public:
  PriorCost(const GaussianPrior& prior, std::vector<std::pair<int, int>> blocks)
      : mean_(prior.mean), blocks_(std::move(blocks)) {
    Eigen::VectorXd unused;
    square_root(prior.precision, Eigen::VectorXd::Zero(mean_.size()), root_, unused);
    for (const auto& [offset, size] : blocks_) mutable_parameter_block_sizes()->push_back(size);
    set_num_residuals(static_cast<int>(root_.rows()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::VectorXd z = mean_;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      z.segment(blocks_[b].first, blocks_[b].second) =
          Eigen::Map<const Eigen::VectorXd>(parameters[b], blocks_[b].second);
    }
    Eigen::Map<Eigen::VectorXd>(residuals, root_.rows()) = root_ * (z - mean_);
    if (jacobians == nullptr) return true;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      Eigen::Map<RowMajor>(jacobians[b], root_.rows(), blocks_[b].second) =
          root_.middleCols(blocks_[b].first, blocks_[b].second);
    }
    return true;
  }

 private:
  Eigen::VectorXd mean_;
  std::vector<std::pair<int, int>> blocks_;
  Eigen::MatrixXd root_;
};

MinimiseSummary minimise_per_reading(const ReadingIndex& index, const std::vector<double>& weight,
                                     const DatumSpace& datum, const GaussianPrior& prior,
                                     const MinimiseOptions& options, Eigen::VectorXd& z) {
  const MeasurementModel& model = index.model();
  const ReducedBlocks all(datum);
  const Eigen::VectorXd start = z;
  std::vector<int> block_at(static_cast<std::size_t>(datum.size()));
  for (std::size_t b = 0; b < all.blocks.size(); ++b) {
    const auto& [offset, size] = all.blocks[b];
    std::fill_n(block_at.begin() + offset, size, static_cast<int>(b));
  }
  ceres::Problem problem;
  for (std::size_t setup = 0; setup < model.campaign().setups.size(); ++setup) {
    RowJacobian row;
    for (std::size_t reading = 0; reading < model.campaign().setups[setup].readings.size(); ++reading) {
      model.linearize(setup, reading, datum.raw(start), row);
      for (int channel = 0; channel < row.channels; ++channel) {
        const double w = weight[index.first_observation(setup, reading) + static_cast<std::size_t>(channel)];
        if (w == 0.0) continue;
        const auto touched = touched_parameters(model.layout(), row);
        const std::vector<bool> active = datum.touched(touched);
        std::vector<std::pair<int, int>> blocks;
        std::vector<double*> pointers;
        for (const auto& block : all.blocks) {
          if (!active[static_cast<std::size_t>(block.first)]) continue;
          blocks.push_back(block);
          pointers.push_back(z.data() + block.first);
        }
        auto* cost = new ReadingCost(model, datum, blocks, setup, reading, channel, w);
        cost->set_all(&start);
        problem.AddResidualBlock(cost, make_loss(options).release(), pointers);
      }
    }
  }
  std::vector<double*> pointers;
  for (const auto& block : all.blocks) pointers.push_back(z.data() + block.first);
  problem.AddResidualBlock(new PriorCost(prior, all.blocks), nullptr, pointers);
  ceres::Solver::Options ceres_options = solver_options(options);
  ceres_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  ceres_options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &problem, &summary);
  return summarise(summary);
}

MinimiseSummary nothing_to_estimate(const ReadingIndex& index, const std::vector<double>& weight,
                                    const DatumSpace& datum, const MinimiseOptions& options,
                                    const Eigen::VectorXd& z) {
  const auto loss = make_loss(options);
  NormalAccumulator accumulator(index, weight, loss.get(), options.threads);
  const double cost = accumulator.accumulate(datum.raw(z), nullptr, Sums::AllButMatrix).cost;
  return {true, 0, cost, cost, "nothing to estimate"};
}

}  // namespace

MinimiseSummary minimise(const ReadingIndex& index, const std::vector<double>& weight,
                         const DatumSpace& datum, const GaussianPrior& prior, const MinimiseOptions& options,
                         Eigen::VectorXd& z) {
  if (datum.size() == 0) return nothing_to_estimate(index, weight, datum, options, z);
  return options.solver == SolverKind::Compressed
             ? minimise_compressed(index, weight, datum, prior, options, z)
             : minimise_per_reading(index, weight, datum, prior, options, z);
}

}  // namespace volcal
