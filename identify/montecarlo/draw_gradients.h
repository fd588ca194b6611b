#pragma once
/// The gradients of campaign_gradient.h for several draws side by side, the same to rounding. A draw's
/// gradient is the same to the bit whatever draws stand beside it.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/noise/noise_model.h"
#include "volcal/model/observation/state_map.h"

namespace volcal {

class DrawGradients {
 public:
  static constexpr int kDraws = StateMap::kVectors;

  /// Everything given must outlive the object, and StateMap::is_exact_for() must hold for the model.
  DrawGradients(const BlockModel& model, const Whitener& whitener);

  /// Memory of one thread.
  struct Workspace {
    explicit Workspace(const DrawGradients& gradients);

    StateMap::Numbers values;
    StateMap::Numbers sums;
    std::vector<StateMap::Seen> seen;
    std::vector<LinearizationLanes> readings;  ///< block by block, kDraws each
    Eigen::MatrixXd errors;
  };

  /// In raw parameters, a column per draw, at most kDraws; `parameters` raw, `readings` y likewise.
  Eigen::MatrixXd at(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& readings,
                     Workspace& work) const;

 private:
  void predict(std::size_t block, const Eigen::MatrixXd& parameters, Workspace& work) const;
  void take_errors(const Eigen::MatrixXd& readings, Workspace& work) const;
  void add_loads(std::size_t block, Eigen::Index first_observation, Workspace& work) const;

  const BlockModel& model_;
  const Whitener& whitener_;
  StateMap states_;
};

}  // namespace volcal
