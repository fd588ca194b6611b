#include "volcal/identify/solve/normals/sample_start.h"

#include <algorithm>
#include <limits>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr std::size_t kSmallSample = 4096;  // observations
/// The error of the start falls with the sample's root, what the next step leaves of it with the square.
constexpr std::size_t kLargeSample = 16384;
constexpr int kMostSteps = 5;
/// Far from the minimum a step promises to leave less than this part of the cost; near it the linear model
/// holds, and the step ends at the sample's minimum.
constexpr double kFarFromMinimum = 0.01;

/// Cost and its Gauss-Newton step at one place.
struct NewtonStep {
  double cost;
  double promise;  ///< what the step promises to take off the cost
  Eigen::VectorXd step;

  bool is_far() const { return cost - promise < kFarFromMinimum * cost; }
};

class Sample {
 public:
  Sample(const ReadingIndex& index, const std::vector<double>& weight, const DatumSpace& datum,
         const GaussianPrior& prior, std::size_t observations, int threads)
      : datum_(datum),
        prior_(prior),
        share_(std::max<std::size_t>(2, index.observations() / observations)),
        accumulator_(index, weight, nullptr, threads, share_) {}

  /// None where the sample does not determine every parameter.
  std::optional<NewtonStep> at(const Eigen::VectorXd& z) {
    const NormalEquations& sums = accumulator_.accumulate(datum_.raw(z));
    const auto scale = static_cast<double>(share_);
    const auto lower = cholesky_lower(scale * datum_.reduce_matrix(sums.matrix) + prior_.precision);
    if (!lower) return std::nullopt;
    const Eigen::VectorXd gradient = scale * datum_.reduce_gradient(sums.gradient) + prior_.gradient(z);
    const Eigen::VectorXd v = lower->triangularView<Eigen::Lower>().solve(gradient);
    return NewtonStep{scale * sums.cost + prior_.cost(z), 0.5 * v.squaredNorm(),
                      -lower->transpose().triangularView<Eigen::Upper>().solve(v)};
  }

 private:
  const DatumSpace& datum_;
  const GaussianPrior& prior_;
  std::size_t share_;
  NormalAccumulator accumulator_;
};

/// Steps on the small sample until it is near its minimum.
std::optional<SampleStart> approach_minimum(Sample& sample, const Eigen::VectorXd& z) {
  SampleStart start{z, 0.0};
  double last_cost = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostSteps; ++i) {
    const auto newton = sample.at(start.z);
    if (!newton || !(newton->cost < last_cost)) return std::nullopt;
    if (i == 0) start.cost_before = newton->cost;
    last_cost = newton->cost;
    if (!newton->is_far()) return i == 0 ? std::nullopt : std::optional(start);
    start.z += newton->step;
  }
  return std::nullopt;
}

}  // namespace

std::optional<SampleStart> find_start_on_sample(const ReadingIndex& index, const std::vector<double>& weight,
                                                const DatumSpace& datum, const GaussianPrior& prior,
                                                int threads, const Eigen::VectorXd& z) {
  Sample small(index, weight, datum, prior, kSmallSample, threads);
  std::optional<SampleStart> start = approach_minimum(small, z);
  if (!start) return std::nullopt;
  const auto last = Sample(index, weight, datum, prior, kLargeSample, threads).at(start->z);
  if (!last) return std::nullopt;
  start->z += last->step;
  return start;
}

}  // namespace volcal
