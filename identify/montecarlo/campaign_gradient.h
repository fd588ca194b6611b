#pragma once
/// Exact gradient J(z)^T Sigma^-1 (f(z) - y) of a campaign for many parameter vectors and readings, in blocks
/// of readings. SI; observations stand in setup, row, channel order.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/noise/noise_model.h"
#include "volcal/model/observation/block_model.h"

namespace volcal {

class CampaignGradient {
 public:
  /// Everything given must outlive the object.
  CampaignGradient(const MeasurementModel& model, const Whitener& whitener);

  const BlockModel& model() const { return model_; }

  /// Memory of one thread.
  struct Workspace {
    explicit Workspace(const CampaignGradient& gradient);

    BlockLevers levers;
    std::vector<BlockLinearization> blocks;
    Eigen::VectorXd errors;
    GradientSums sums;
  };

  /// In raw parameters, at the raw parameters given, for the readings y.
  Eigen::VectorXd at(const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings,
                     Workspace& work) const;

 private:
  BlockModel model_;
  const Whitener& whitener_;
};

}  // namespace volcal
