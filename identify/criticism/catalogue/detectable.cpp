#include "volcal/identify/criticism/catalogue/detectable.h"

#include <cmath>
#include <limits>

namespace volcal {

FunctionalPointLevers::FunctionalPointLevers(const LinearModel& model) : model_(model) {
  const KinematicChain& chain = model.model().chain();
  const Campaign& campaign = model.campaign();
  std::vector<JointLever> levers(chain.joint_count());
  for (std::size_t setup = 0; setup < campaign.setups.size(); ++setup) {
    const Readings& readings = campaign.setups[setup].readings;
    const Eigen::Vector3d& tool = model.model().binding().setups[setup].tool_offset;
    Eigen::MatrixXd& length = length_.emplace_back(
        Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(readings.size()), kStationDisturbance));
    for (std::size_t row = 0; row < readings.size(); ++row) {
      chain.levers(readings.commanded_position(row), tool, levers.data());
      for (std::size_t joint = 0; joint < levers.size(); ++joint) {
        for (const Component component : kAllComponents) {
          length(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(6 * joint + index_of(component))) =
              KinematicChain::motion_lever_w(levers[joint], component).norm();
        }
      }
    }
  }
}

double FunctionalPointLevers::rms(const Effect& effect, const Eigen::VectorXd& shape, std::size_t k) const {
  const std::vector<EffectTerm> terms = effect.terms();
  double squares = 0.0, count = 0.0;
  for (std::size_t setup = 0; setup < length_.size(); ++setup) {
    const Eigen::MatrixXd drivers = effect.drivers(model_.views()[setup], shape);
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const EffectTarget& target = terms[t].target;
      if (terms[t].amplitude != k) continue;
      if (target.kind != TargetKind::Motion && target.kind != TargetKind::ToolOffset)
        return std::numeric_limits<double>::quiet_NaN();
      const int disturbance = disturbance_of(target, model_.campaign().machine);
      squares += drivers.col(static_cast<Eigen::Index>(t))
                     .cwiseProduct(length_[setup].col(disturbance))
                     .squaredNorm();
    }
    count += static_cast<double>(drivers.rows());
  }
  return std::sqrt(squares / std::max(1.0, count));
}

}  // namespace volcal
