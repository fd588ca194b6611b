#include "volcal/identify/solve/rank.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/rank_causes.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr double kGainOfVisible = 100.0;  // variance, prior to posterior
constexpr double kWeakPartner = 0.02;
constexpr double kMostlyHidden = 0.5;  // share of its variance, for a partner
constexpr std::size_t kMostPartners = 5;
constexpr int kPositions = 33;

const Basis& basis_of(const ParameterLayout& layout, ErrorSymbol symbol) {
  return *layout.groups[static_cast<std::size_t>(layout.find(symbol)->group)].basis;
}

constexpr double kDetailThatTells = 3.5;  // coefficients of a function that tell its amplitude
constexpr double kRougherAtMost = 3.0;    // than its amplitude tells

/// How many coefficients of a function beyond its straight part the readings determine; `determined`: share
/// of each parameter's variance that is theirs.
double detail_seen(const SmoothingTerm& term, const Eigen::VectorXd& determined) {
  const Eigen::Index size = term.precision().rows();
  return determined.segment(term.offset, size).sum() - static_cast<double>(size - term.prior->rank);
}

/// Values of a function at these positions, one row each, in its reduced coordinates.
Eigen::MatrixXd rows_at(const MeasurementModel& model, const DatumSpace::FunctionCoordinates& function,
                        const std::vector<double>& positions) {
  const Basis& basis = basis_of(model.layout(), function.symbol);
  Eigen::MatrixXd rows(positions.size(), basis.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = basis.row(positions[i]).transpose();
  return rows * function.basis;
}

/// The same over the measured positions.
Eigen::MatrixXd value_rows(const MeasurementModel& model, const DatumSpace::FunctionCoordinates& function) {
  const MeasuredRange range = measured_range(model.campaign(), function.symbol.axis);
  std::vector<double> positions(kPositions);
  for (int i = 0; i < kPositions; ++i) {
    const double share = static_cast<double>(i) / (kPositions - 1);
    positions[static_cast<std::size_t>(i)] = range.min + share * (range.max - range.min);
  }
  return rows_at(model, function, positions);
}

/// The rows without what a straight line at these positions is.
Eigen::MatrixXd without_lines(const std::vector<double>& positions, const Eigen::MatrixXd& rows) {
  const auto count = static_cast<Eigen::Index>(positions.size());
  Eigen::MatrixXd lines(count, 2);
  lines.col(0).setOnes();
  lines.col(1) = Eigen::Map<const Eigen::VectorXd>(positions.data(), count);
  lines.col(1).array() -= lines.col(1).mean();
  Eigen::MatrixXd left = rows;
  for (const auto line : lines.colwise()) {
    if (line.squaredNorm() > 0.0) left -= line * (line.transpose() * left) / line.squaredNorm();
  }
  return left;
}

/// Precision of what a function does between the positions of the readings, given what deviates from a
/// straight line at them, by its smoothing S: with N the functions that are straight there, S N (N^T S N)^+
/// N^T S.
Eigen::MatrixXd precision_between(const Eigen::MatrixXd& deviations, const Eigen::MatrixXd& smoothing) {
  constexpr double kStraight = 1e-9;  // of the largest: a line, which is not smoothed
  const Eigen::MatrixXd between = null_space(deviations);
  if (between.cols() == 0) return Eigen::MatrixXd::Zero(smoothing.rows(), smoothing.cols());
  const Eigen::MatrixXd pull = smoothing * between;
  const SymmetricEigen rough = eigen_decomposition(between.transpose() * pull);
  const double least = kStraight * rough.values.cwiseAbs().maxCoeff();
  const Eigen::VectorXd inverse =
      (rough.values.array() > least).select(rough.values.array().max(least).inverse(), 0.0);
  const Eigen::MatrixXd axes = pull * rough.vectors;
  return axes * inverse.asDiagonal() * axes.transpose();
}

/// The wide prior, and functions whose roughness the readings tell no rougher between their positions than
/// that allows. What readings at these positions leave open, as errors that can be exchanged, stays so.
GaussianPrior with_roughness_seen(const MeasurementModel& model, const DatumSpace& datum,
                                  const Eigen::MatrixXd& data, const std::vector<SmoothingTerm>& terms,
                                  GaussianPrior wide) {
  const auto factor = cholesky_lower(data + wide.precision);
  if (!factor) return wide;
  const Eigen::VectorXd determined = inverse_from_cholesky(*factor).cwiseProduct(data).rowwise().sum();
  for (const SmoothingTerm& term : terms) {
    if (!term.is_function() || detail_seen(term, determined) < kDetailThatTells) continue;
    const auto function =
        std::ranges::find(datum.functions(), term.symbol, &DatumSpace::FunctionCoordinates::symbol);
    const std::vector<double> positions = different_positions(model.campaign(), term.symbol.axis);
    const Eigen::MatrixXd deviations = without_lines(positions, rows_at(model, *function, positions));
    const Eigen::Index size = term.precision().rows();
    wide.precision.block(term.offset, term.offset, size, size) +=
        term.lambda / (kRougherAtMost * kRougherAtMost) * precision_between(deviations, term.precision());
  }
  return wide;
}

/// An error as a stretch of the reduced vector.
struct ErrorStretch {
  MachineError error;
  int offset;
  int size;
  Eigen::MatrixXd rows;  ///< its values, for mean variances
  const DatumSpace::FunctionCoordinates* function;
};

std::vector<ErrorStretch> error_stretches(const MeasurementModel& model, const DatumSpace& datum) {
  std::vector<ErrorStretch> stretches;
  for (const auto& function : datum.functions()) {
    if (function.size() == 0) continue;
    stretches.push_back(
        {function.symbol, function.offset, function.size(), value_rows(model, function), &function});
  }
  for (const auto& block : datum.blocks()) {
    const ParameterBlock& source = model.layout().blocks[block.block];
    if (!source.location && (source.kind != ParameterKind::Effect || is_surface(source))) continue;
    stretches.push_back({source.machine_error(), block.offset, block.size,
                         Eigen::MatrixXd::Identity(block.size, block.size), nullptr});
  }
  return stretches;
}

double mean_variance(const ErrorStretch& stretch, const Eigen::MatrixXd& covariance) {
  return (stretch.rows * covariance * stretch.rows.transpose()).trace() /
         static_cast<double>(stretch.rows.rows());
}

double mean_variance_in(const ErrorStretch& stretch, const Eigen::MatrixXd& full_covariance) {
  return mean_variance(stretch,
                       full_covariance.block(stretch.offset, stretch.offset, stretch.size, stretch.size));
}

/// Covariances before and after the readings, and the part of the latter that hides from them.
class RankAnalyser {
 public:
  /// `prior`: of what readings are held against, `wide` or narrower; `wide`: what they are to improve.
  RankAnalyser(const MeasurementModel& model, const DatumSpace& datum, const Eigen::MatrixXd& data,
               const GaussianPrior& prior, const GaussianPrior& wide)
      : model_(model),
        datum_(datum),
        data_(data),
        prior_(prior),
        stretches_(error_stretches(model, datum)),
        posterior_(
            inverse(data + prior.precision, "the readings' normal matrix holds values that are not finite")),
        wide_covariance_(inverse(wide.precision, "the wide prior is not positive definite")) {
    find_hidden();
  }

  RankAnalysis run() {
    for (const auto& block : datum_.blocks()) {
      if (!is_surface(model_.layout().blocks[block.block])) continue;
      for (int k = 0; k < block.size; ++k) analysis_.of_surfaces.push_back(block.offset + k);
    }
    analysis_.report.parameters = datum_.size() - static_cast<int>(analysis_.of_surfaces.size());
    for (const ErrorStretch& stretch : stretches_) judge(stretch);
    for (const auto& block : datum_.blocks()) report_held(block);
    return std::move(analysis_);
  }

 private:
  static Eigen::MatrixXd inverse(const Eigen::MatrixXd& precision, const std::string& problem) {
    const auto factor = cholesky_lower(precision);
    if (!factor) throw std::runtime_error("analyse_rank: " + problem);
    return inverse_from_cholesky(*factor);
  }

  /// Eigenvectors of the readings' information in units of the wide prior: posterior covariance
  /// = sum of L^-T v v^T L^-1 / (1 + gain), of which those with little gain are hidden.
  void find_hidden() {
    const auto root = cholesky_lower(prior_.precision);
    const auto lower = root->triangularView<Eigen::Lower>();
    Eigen::MatrixXd gain = lower.solve(data_);
    gain = lower.solve(gain.transpose()).eval();
    gain = 0.5 * (gain + gain.transpose()).eval();
    const SymmetricEigen eigen = eigen_decomposition(gain);
    analysis_.report.rank = static_cast<int>((eigen.values.array() > kGainOfVisible).count());
    const int hidden = datum_.size() - analysis_.report.rank;
    hidden_.resize(datum_.size(), hidden);
    const Eigen::MatrixXd held = lower * eigen.vectors.leftCols(hidden);
    analysis_.on_invisible = held * held.transpose();
    if (hidden == 0) return;
    const Eigen::ArrayXd shrink = (1.0 + eigen.values.head(hidden).array().max(0.0)).rsqrt();
    hidden_ = root->transpose().triangularView<Eigen::Upper>().solve(eigen.vectors.leftCols(hidden) *
                                                                     shrink.matrix().asDiagonal());
  }

  void judge(const ErrorStretch& stretch) {
    const double prior_variance = mean_variance_in(stretch, wide_covariance_);
    const double variance = mean_variance_in(stretch, posterior_);
    const double variance_alone = mean_variance(stretch, covariance_alone(stretch));
    Observability figure;
    figure.symbol = stretch.error;
    figure.visible_fraction = std::sqrt(std::min(1.0, variance_alone / variance));
    figure.u_rms = std::sqrt(variance);
    figure.visible = variance * kGainOfVisible < prior_variance;
    if (!figure.visible) {
      analysis_.deficient = true;
      if (stretch.function != nullptr) analysis_.invisible_functions.push_back(stretch.function->symbol);
      const bool unseen_alone = variance_alone * kGainOfVisible >= prior_variance;
      if (unseen_alone) figure.visible_fraction = 0.0;
      figure.cause = cause_of_standing(model_.campaign(), stretch.error)
                         .value_or(unseen_alone ? cause_alone(stretch) : cause_in_mixture(stretch));
      analysis_.report.invisible.push_back(*figure.cause);
    }
    analysis_.report.errors.push_back(std::move(figure));
  }

  /// With everything else known.
  Eigen::MatrixXd covariance_alone(const ErrorStretch& stretch) const {
    return inverse(block(data_, stretch) + block(prior_.precision, stretch),
                   "the wide prior is not positive definite");
  }

  static Eigen::MatrixXd block(const Eigen::MatrixXd& matrix, const ErrorStretch& stretch) {
    return matrix.block(stretch.offset, stretch.offset, stretch.size, stretch.size);
  }

  Finding cause_alone(const ErrorStretch& stretch) const {
    if (stretch.function == nullptr || !part_is_seen(stretch))
      return cause_of_unseen(model_.campaign(), stretch.error);
    return cause_of_open_course(model_, stretch.function->symbol, stretch.size);
  }

  /// Does a reading change with some combination of the error's coefficients?
  bool part_is_seen(const ErrorStretch& stretch) const {
    const auto root = cholesky_lower(block(prior_.precision, stretch));
    if (!root) return false;
    const auto lower = root->triangularView<Eigen::Lower>();
    Eigen::MatrixXd gain = lower.solve(block(data_, stretch));
    gain = lower.solve(gain.transpose()).eval();
    return gain.diagonal().sum() > kGainOfVisible * static_cast<double>(stretch.size);
  }

  /// The straightness that hides a squareness though all other errors are known: no station, tool or other
  /// instrument tells these two apart, but positions along the axis.
  const ErrorStretch* hiding_straightness(const ErrorStretch& squareness) const {
    const auto straightness = straightness_beside(squareness.error);
    if (!straightness) return nullptr;
    const auto found = std::ranges::find(stretches_, MachineError(*straightness), &ErrorStretch::error);
    if (found == stretches_.end()) return nullptr;
    std::vector<Eigen::Index> open = {squareness.offset};
    const auto add = [&open](int offset, int size) {
      for (int i = 0; i < size; ++i) open.push_back(offset + i);
    };
    for (const auto& block : datum_.blocks()) {
      if (!is_stretch(error_of(block))) add(block.offset, block.size);
    }
    if (is_hidden_among(open)) return nullptr;
    add(found->offset, found->size);
    return is_hidden_among(open) ? &*found : nullptr;
  }

  MachineError error_of(const DatumSpace::BlockCoordinates& block) const {
    return model_.layout().blocks[block.block].machine_error();
  }

  bool is_stretch(const MachineError& error) const {
    return std::ranges::find(stretches_, error, &ErrorStretch::error) != stretches_.end();
  }

  /// Is the first of these parameters not visible when all others than these are known?
  bool is_hidden_among(const std::vector<Eigen::Index>& open) const {
    const Eigen::MatrixXd covariance =
        inverse(data_(open, open) + prior_.precision(open, open), "the wide prior is not positive definite");
    return covariance(0, 0) * kGainOfVisible >= wide_covariance_(open[0], open[0]);
  }

  Finding cause_in_mixture(const ErrorStretch& stretch) const {
    if (const ErrorStretch* straightness = hiding_straightness(stretch))
      return cause_like_straightness(stretch.error, straightness->function->symbol);
    const std::vector<MachineError> partners = partners_of(stretch);
    if (!partners.empty()) return cause_exchangeable(model_, stretch.error, partners);
    if (stretch.function != nullptr)
      return cause_of_open_course(model_, stretch.function->symbol, stretch.size);
    return {FindingCode::NotVisibleReadingsTooFew, {{"error", stretch.error.name()}}};
  }

  /// What changes along with an error in the directions that hide, strongest first.
  std::vector<MachineError> partners_of(const ErrorStretch& stretch) const {
    const Eigen::MatrixXd mine = stretch.rows * hidden_.middleRows(stretch.offset, stretch.size);
    std::map<MachineError, double> share;
    const auto compare = [&](const MachineError& error, const Eigen::MatrixXd& other, double known) {
      if (error == stretch.error || other.squaredNorm() < kMostlyHidden * known) return;
      const double together = (mine * other.transpose()).squaredNorm();
      double& best = share[error];
      best = std::max(best, together / (mine.squaredNorm() * other.squaredNorm()));
    };
    for (const ErrorStretch& other : stretches_) {
      compare(other.error, other.rows * hidden_.middleRows(other.offset, other.size),
              mean_variance_in(other, posterior_) * static_cast<double>(other.rows.rows()));
    }
    for (const auto& block : datum_.blocks()) {
      const MachineError error = error_of(block);
      if (is_stretch(error)) continue;
      for (int i = block.offset; i < block.offset + block.size; ++i)
        compare(error, hidden_.row(i), posterior_(i, i));
    }
    std::vector<std::pair<double, MachineError>> ranked;
    for (const auto& [error, value] : share) {
      if (value > kWeakPartner) ranked.emplace_back(value, error);
    }
    std::ranges::sort(ranked, std::greater<>(),
                      [](const auto& each) { return std::pair(each.first, each.second.name()); });
    std::vector<MachineError> partners;
    for (std::size_t i = 0; i < ranked.size() && i < kMostPartners; ++i) partners.push_back(ranked[i].second);
    return partners;
  }

  void report_held(const DatumSpace::BlockCoordinates& block) {
    const ParameterBlock& source = model_.layout().blocks[block.block];
    if (!source.weak_default_prior) return;
    for (int k = 0; k < block.size; ++k) {
      const double prior_variance = std::pow(source.prior_sigma[k], 2);
      if (posterior_(block.offset + k, block.offset + k) < 0.25 * prior_variance) continue;
      const auto at = static_cast<std::size_t>(k);
      analysis_.report.held_by_prior.push_back(
          {FindingCode::RankHeldByPrior,
           {{"block", source.name},
            {"parameter", source.labels[at]},
            {"sigma", FindingNumber{source.prior_sigma[k], source.units[at], source.si_per_unit[at]}}}});
    }
  }

  const MeasurementModel& model_;
  const DatumSpace& datum_;
  const Eigen::MatrixXd& data_;
  const GaussianPrior& prior_;
  std::vector<ErrorStretch> stretches_;
  Eigen::MatrixXd posterior_;
  Eigen::MatrixXd wide_covariance_;
  Eigen::MatrixXd hidden_;  ///< columns: hidden directions, their outer products the hidden covariance
  RankAnalysis analysis_;
};

}  // namespace

RankAnalysis analyse_rank(const MeasurementModel& model, const DatumSpace& datum, const Eigen::MatrixXd& data,
                          const GaussianPrior& wide) {
  if (datum.size() == 0) return {};
  return RankAnalyser(model, datum, data, wide, wide).run();
}

RankAnalysis judge_by_roughness(const MeasurementModel& model, const DatumSpace& datum,
                                const Eigen::MatrixXd& data, const GaussianPrior& wide,
                                const std::vector<SmoothingTerm>& terms, const RankAnalysis& rank) {
  const GaussianPrior prior = with_roughness_seen(model, datum, data, terms, wide);
  RankAnalysis judged = RankAnalyser(model, datum, data, prior, wide).run();
  judged.report.rank = rank.report.rank;
  judged.on_invisible = rank.on_invisible;
  return judged;
}

}  // namespace volcal
