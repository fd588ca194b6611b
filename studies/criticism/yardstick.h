#pragma once
/// A simulated campaign without what is hidden in it, and how its model would see what is: the noise is the
/// true one. SI; signals are in units of the noise.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/sim/study.h"

namespace volcal::studies {

/// Adjusted as `volcal diagnose` does, by one thread.
FitResult fitted(const Campaign& campaign, const ModelSpec& model);
sim::Study hiding(sim::Study study, const std::vector<sim::HiddenEffect>& effects);
/// Mean square of the error of predictions, um^2, at the unseen positions: setups, stations and dead paths
/// are those of the campaign.
double unseen_square(const sim::SimulatedCampaign& simulated, const FitResult& result);

class Yardstick {
 public:
  explicit Yardstick(const sim::Study& study);

  /// Change of the readings by an effect that has an amplitude or an rms.
  Eigen::VectorXd change(const sim::Study& study, const sim::HiddenEffect& effect, double* amplitude) const;

  /// What the functions could not take up had they any shape that their knots allow.
  struct Visible {
    double signal = 0.0;
    double fraction = 0.0;
  };
  Visible visible(const Eigen::VectorXd& change) const;
  /// The same beside functions as smooth as those of the machine.
  double signal(const Eigen::VectorXd& change) const;

  /// Least squares of a change on columns, after projection off functions as smooth as those of the machine.
  struct Explained {
    double share = 0.0;  ///< of the squared signal
    Eigen::VectorXd amplitude;
  };
  Explained explained(const Eigen::VectorXd& change, const Eigen::MatrixXd& columns) const;
  /// The same as `visible` sees it.
  double share_taken(const Eigen::VectorXd& change, const Eigen::MatrixXd& columns) const;
  /// Columns of a finding at its shape; none for more resolution.
  Eigen::MatrixXd columns(const EffectFinding& finding) const;
  Eigen::MatrixXd columns(const EffectSpec& spec) const;

  /// How many readings, of how many on which a surface acts, lie inside its 95 % band: both are taken without
  /// what the rest of the model can imitate.
  struct Covered {
    int count = 0;
    int of = 0;
  };
  Covered covered(const Eigen::VectorXd& change, const SurfaceFinding& surface) const;

  const Campaign& campaign() const { return simulated_.campaign; }
  /// Of the campaign with nothing hidden: what an oracle would reach.
  double unseen_square() const { return studies::unseen_square(simulated_, result_); }

 private:
  static Explained explained(const Eigen::VectorXd& change, const Eigen::MatrixXd& columns,
                             const Projector& projector);
  Eigen::MatrixXd without_imitation(const Eigen::MatrixXd& columns) const;
  std::vector<NoiseParameters> true_noise() const;

  sim::SimulatedCampaign simulated_;
  FitResult result_;
  LinearModel model_;
  Projector smooth_;
  Projector free_;
};

}  // namespace volcal::studies
