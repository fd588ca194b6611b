#pragma once
/// Exact gradient J(z)^T Sigma^-1 (f(z) - y) of a campaign for many parameter vectors and readings. Weights
/// of a reading's error motions are gathered per position of an axis and multiplied with the basis once a
/// position, not once a reading. SI; observations stand in setup, row, channel order.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "volcal/identify/noise/noise_model.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

class CampaignGradient {
 public:
  /// Everything given must outlive the object.
  CampaignGradient(const MeasurementModel& model, const Whitener& whitener);

  /// Memory of one thread.
  struct Workspace {
    RowJacobian row;
    Eigen::VectorXd errors;
    std::vector<double> motion_weight;  ///< observations x functions
    std::vector<double> tail_value;
    std::vector<double> gathered;
  };

  /// In raw parameters, at the raw parameters given, for the readings y.
  Eigen::VectorXd at(const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings,
                     Workspace& work) const;

 private:
  struct Group {
    std::vector<double> basis;  ///< support values per position
    std::vector<int> start;     ///< first active function per position
    std::size_t gathered = 0;   ///< where its sums begin: positions x functions
  };

  void number_positions();
  void linearise(const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings, Workspace& work) const;
  void gather(Workspace& work, Eigen::VectorXd& gradient) const;
  void spread(const Workspace& work, Eigen::VectorXd& gradient) const;

  const MeasurementModel& model_;
  const Whitener& whitener_;
  std::size_t functions_ = 0;  ///< of a reading: slots of all groups
  std::vector<Group> groups_;
  std::vector<std::uint32_t> position_;    ///< reading x group: where in Workspace::gathered it adds
  std::vector<std::uint32_t> tail_begin_;  ///< per observation, one more at the end
  std::vector<int> tail_index_;
  std::vector<std::uint32_t> reading_of_;  ///< per observation
  std::size_t gathered_size_ = 0;
};

}  // namespace volcal
