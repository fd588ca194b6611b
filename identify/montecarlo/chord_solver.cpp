#include "volcal/identify/montecarlo/chord_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr double kFallsAlongAStep = 0.9;  // of the gradient along a step: Wolfe's c2
constexpr double kShortest = 0.02;        // of a step, in one go

/// Share of a step at which the gradient along it would vanish if it were linear in between.
double shortened(double before, double after) { return std::max(kShortest, before / (before - after)); }

}  // namespace

/// The steps of one draw, from the gradient at one point to the next point where one is asked for.
class ChordSolver::Path {
 public:
  Path(const WeakParameters& weak, const CampaignDraw& draw, const Eigen::VectorXd& linear)
      : weak_(weak), draw_(draw), scale_(weak.solve(draw, linear)), next_(scale_.deviation) {
    // The linear step has about one standard deviation per parameter. How much nearer a second-order solution
    // is says nothing of the steps to come: what it leaves out changes the curvature as much as the valley
    // bends.
    before_ = scale_.correction.size() > 0 ? 1.0 / (1.0 + scale_.bend)
                                           : std::sqrt(static_cast<double>(linear.size()));
  }

  const CampaignDraw& draw() const { return draw_; }
  bool done() const { return done_; }
  const Outcome& outcome() const { return outcome_; }
  /// Where a gradient is asked for; in the end the solution.
  const Eigen::VectorXd& deviation() const { return next_; }

  /// Whether a step follows, which step() makes; else the last one is shortened.
  bool take(Eigen::VectorXd gradient) {
    ++outcome_.gradients;
    if (step_.size() > 0) {
      const double after = gradient.dot(step_);
      if (after > -kFallsAlongAStep * along_ && outcome_.gradients < kMostGradients) {
        step_ *= shortened(along_, after);
        next_ = at_ + step_;
        return false;
      }
      learn(gradient);
      before_ = length_;
    }
    at_ = next_;
    gradient_ = std::move(gradient);
    reduce();
    return true;
  }
  /// What C is to be multiplied with for a step.
  const Eigen::VectorXd& reduced() const { return reduced_; }

  /// `moved`: C reduced(); `gain`: C.
  void step(const Eigen::VectorXd& moved, const Eigen::MatrixXd& gain) {
    step_ = descent(moved);
    along_ = gradient_.dot(step_);
    if (!(along_ <= 0.0) && scale_.correction.size() > 0) {  // the second order misleads
      scale_.correction.resize(0, 0);
      known_.clear();
      reduce();
      step_ = descent(gain * reduced_);
      along_ = gradient_.dot(step_);
    }
    length_ = std::sqrt(std::max(0.0, -along_));
    const double contraction = length_ / before_;
    outcome_.to_come = contraction < 1.0 ? length_ * contraction / (1.0 - contraction)
                                         : std::numeric_limits<double>::infinity();
    outcome_.converged = outcome_.to_come < kEnough;
    next_ = at_ + step_;
    done_ = outcome_.converged || outcome_.gradients >= kMostGradients || !std::isfinite(length_);
  }

 private:
  /// A step and how the gradient changed along it.
  struct Curvature {
    Eigen::VectorXd step;
    Eigen::VectorXd change;
    double product = 0.0;
  };

  void learn(const Eigen::VectorXd& gradient) {
    Eigen::VectorXd change = gradient - gradient_;
    const double product = step_.dot(change);
    if (product > 0.0) known_.push_back({step_, std::move(change), product});
  }

  /// The first loop of the recursion.
  void reduce() {
    reduced_ = gradient_;
    share_.resize(known_.size());
    for (std::size_t i = known_.size(); i-- > 0;) {
      share_[i] = known_[i].step.dot(reduced_) / known_[i].product;
      reduced_ -= share_[i] * known_[i].change;
    }
  }

  /// The second.
  Eigen::VectorXd descent(Eigen::VectorXd moved) const {
    Eigen::VectorXd step = weak_.inverse_curvature(scale_, reduced_, std::move(moved));
    for (std::size_t i = 0; i < known_.size(); ++i)
      step += (share_[i] - known_[i].change.dot(step) / known_[i].product) * known_[i].step;
    return -step;
  }

  const WeakParameters& weak_;
  const CampaignDraw& draw_;
  WeakParameters::Solution scale_;
  Eigen::VectorXd next_;
  Eigen::VectorXd at_;
  Eigen::VectorXd gradient_;  ///< at_
  Eigen::VectorXd step_;
  std::vector<Curvature> known_;
  Eigen::VectorXd reduced_;
  std::vector<double> share_;  ///< of known_ in reduced_
  double before_ = 0.0;        ///< length of the step before
  double along_ = 0.0;
  double length_ = 0.0;
  bool done_ = false;
  Outcome outcome_;
};

ChordSolver::ChordSolver(const RepeatedCampaign& campaign)
    : campaign_(campaign),
      prior_(campaign.prior_precision().sparseView()),
      gradient_(campaign.linear_model().model(), campaign.whitener()),
      weak_(campaign) {
  if (StateMap::is_exact_for(campaign.linear_model().model()))
    together_.emplace(gradient_.model(), campaign.whitener());
}

ChordSolver::Workspace::Workspace(const ChordSolver& solver) : one(solver.gradient_) {
  if (solver.together_) several.emplace(*solver.together_);
}

Eigen::VectorXd ChordSolver::gradient_at(const CampaignDraw& draw, const Eigen::VectorXd& deviation,
                                         Workspace& work) const {
  const Eigen::VectorXd raw = campaign_.datum().raw(campaign_.identified() + deviation);
  const Eigen::VectorXd readings = campaign_.predicted() + draw.errors;
  return campaign_.datum().reduce_gradient(gradient_.at(raw, readings, work.one)) +
         prior_ * (deviation - draw.statement);
}

Eigen::MatrixXd ChordSolver::gradients(const std::vector<const CampaignDraw*>& draws,
                                       const Eigen::MatrixXd& deviations, Workspace& work) const {
  constexpr Eigen::Index kAtOnce = DrawGradients::kDraws;
  const auto count = static_cast<Eigen::Index>(draws.size());
  Eigen::MatrixXd gradients(deviations.rows(), count);
  for (Eigen::Index first = 0; together_ && first < count; first += kAtOnce) {
    const Eigen::Index several = std::min(kAtOnce, count - first);
    gradients.middleCols(first, several) =
        together(draws.data() + first, deviations.middleCols(first, several), work);
  }
  for (Eigen::Index k = 0; !together_ && k < count; ++k)
    gradients.col(k) = gradient_at(*draws[static_cast<std::size_t>(k)], deviations.col(k), work);
  return gradients;
}

/// Of as many draws as there are deviations.
Eigen::MatrixXd ChordSolver::together(const CampaignDraw* const* draws, const Eigen::MatrixXd& deviations,
                                      Workspace& work) const {
  const Eigen::Index count = deviations.cols();
  Eigen::MatrixXd raw(campaign_.linear_model().model().layout().size, count);
  Eigen::MatrixXd readings(campaign_.observations(), count), beside(campaign_.parameters(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    raw.col(k) = campaign_.datum().raw(campaign_.identified() + deviations.col(k));
    readings.col(k) = campaign_.predicted() + draws[k]->errors;
    beside.col(k) = deviations.col(k) - draws[k]->statement;
  }
  const Eigen::MatrixXd of_readings = together_->at(raw, readings, *work.several);
  Eigen::MatrixXd gradients(campaign_.parameters(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    gradients.col(k) = prior_ * beside.col(k);
    gradients.col(k) += campaign_.datum().reduce_gradient(of_readings.col(k));
  }
  return gradients;
}

/// Steps of all paths that take one by one product with C, which is not in the processor's cache.
void ChordSolver::advance(const std::vector<Path*>& paths, const Eigen::MatrixXd& gradients) const {
  std::vector<Path*> stepping;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (paths[k]->take(gradients.col(static_cast<Eigen::Index>(k)))) stepping.push_back(paths[k]);
  }
  Eigen::MatrixXd reduced(gradients.rows(), static_cast<Eigen::Index>(stepping.size()));
  for (std::size_t k = 0; k < stepping.size(); ++k)
    reduced.col(static_cast<Eigen::Index>(k)) = stepping[k]->reduced();
  const Eigen::MatrixXd moved = product(campaign_.gain(), reduced);
  for (std::size_t k = 0; k < stepping.size(); ++k)
    stepping[k]->step(moved.col(static_cast<Eigen::Index>(k)), campaign_.gain());
}

std::vector<ChordSolver::Outcome> ChordSolver::solve(const std::vector<CampaignDraw>& draws,
                                                     Eigen::Ref<Eigen::MatrixXd> deviations,
                                                     Workspace& work) const {
  std::vector<Path> paths;
  paths.reserve(draws.size());
  for (std::size_t k = 0; k < draws.size(); ++k)
    paths.emplace_back(weak_, draws[k], deviations.col(static_cast<Eigen::Index>(k)));
  std::vector<Path*> open(paths.size());
  std::ranges::transform(paths, open.begin(), [](Path& path) { return &path; });
  while (!open.empty()) {
    std::vector<const CampaignDraw*> of;
    Eigen::MatrixXd at(deviations.rows(), static_cast<Eigen::Index>(open.size()));
    for (std::size_t k = 0; k < open.size(); ++k) {
      of.push_back(&open[k]->draw());
      at.col(static_cast<Eigen::Index>(k)) = open[k]->deviation();
    }
    advance(open, gradients(of, at, work));
    std::erase_if(open, [](const Path* path) { return path->done(); });
  }
  std::vector<Outcome> outcomes;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    deviations.col(static_cast<Eigen::Index>(k)) = paths[k].deviation();
    outcomes.push_back(paths[k].outcome());
  }
  return outcomes;
}

}  // namespace volcal
