#pragma once
/// Where a campaign has measured: what one that verifies it keeps off (ISO/TR 16907:2015, 11.3: setups and
/// sampling points different from those that the compensation was made from).

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/planning/plan_settings.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

inline constexpr double kPlacesApart = 0.03;  ///< m: nearer to each other two places are one

/// Whether a place is one of these. Workpiece coordinates, m.
bool is_one_of(const Eigen::Vector3d& place_w, const std::vector<Eigen::Vector3d>& places_w);
/// Whether no two of them are one.
bool are_apart(const std::vector<Eigen::Vector3d>& places_w);

class MeasuredPositions {
 public:
  /// Of the campaign that the settings' plan verifies; nothing where there is none.
  explicit MeasuredPositions(const PlanSettings& settings);

  /// Within 2 mm and 1 degree of a measured position; of an instrument that turns rotary axes by these alone,
  /// since the linear axes follow.
  bool has(const AxisPosition& position) const;
  /// Whether it is one of the places from which was measured.
  bool has_place(const Eigen::Vector3d& place_w) const;

 private:
  bool rotary_alone_ = false;
  std::size_t key_ = 0;  ///< axis that the positions are sorted by
  std::vector<AxisPosition> positions_;
  std::vector<Eigen::Vector3d> places_w_;
};

}  // namespace volcal
