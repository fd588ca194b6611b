#pragma once
/// Separation of hypotheses as it is, with plain further readings, and with each measurement of a list.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/criticism/projection/separation.h"
#include "volcal/identify/criticism/proposals/confounding.h"
#include "volcal/identify/criticism/proposals/hypothetical_campaign.h"

namespace volcal {

/// A hypothesis and how large it is thought to be.
struct PlannedHypothesis {
  Hypothesis hypothesis;
  Eigen::VectorXd amplitude;  ///< SI; empty = not significant: what would just be detected
};

/// Gram matrix of all hypotheses' columns after projection off the model, and what was there before.
struct ProjectedHypotheses {
  Eigen::MatrixXd gram;
  Eigen::VectorXd known_norm;
};

class MeasurementPlanner {
 public:
  /// The first `given` hypotheses are part of the model. Effects only.
  MeasurementPlanner(const CriticismState& state, std::vector<PlannedHypothesis> hypotheses,
                     std::size_t given, const HypotheticalCampaign& hypothetical);

  std::size_t measurements() const { return hypothetical_.measurements().size(); }
  const ProjectedHypotheses& now() const { return now_; }
  const ProjectedHypotheses& with(std::size_t measurement) const { return with_[measurement]; }
  /// With as many plain readings as the measurement has: the information of all readings grows by their
  /// share.
  ProjectedHypotheses plain(std::size_t measurement) const;

  /// s^2 of two hypotheses (indices behind the given ones).
  double separation(const ProjectedHypotheses& where, std::size_t first, std::size_t second) const;
  /// |g~| / |g_w|, all columns together.
  double visible_fraction(const ProjectedHypotheses& where, std::size_t hypothesis) const;
  /// |g~|^2, all columns together.
  double information(const ProjectedHypotheses& where, std::size_t hypothesis) const;
  /// Smallest amplitude found with the power asked for, SI, of the amplitude that is seen best; infinite:
  /// none.
  double detectable(const ProjectedHypotheses& where, std::size_t hypothesis) const;

 private:
  void add_campaign();
  void clear_small_columns(ProjectedHypotheses& where) const;
  ProjectedHypotheses project(const Eigen::MatrixXd& gram, Eigen::Index parameters) const;
  ProjectedHypotheses extended(std::size_t measurement) const;
  double one_sided(const ProjectedHypotheses& where, std::size_t own, std::size_t rival) const;

  const CriticismState& state_;
  std::vector<PlannedHypothesis> hypotheses_;
  std::size_t given_;
  const HypotheticalCampaign& hypothetical_;
  std::vector<NoiseParameters> noise_;  ///< also of instruments that the campaign lacks
  std::vector<ColumnRange> range_;
  Eigen::Index parameters_ = 0;
  Eigen::Index columns_ = 0;
  Eigen::MatrixXd campaign_;  ///< Gram matrix of [J, hypotheses], whitened, without priors
  double observations_ = 0.0;
  ProjectedHypotheses now_;
  std::vector<ProjectedHypotheses> with_;
};

}  // namespace volcal
