#pragma once
/// What a compensation adds to the commands of all axes.

#include <Eigen/Core>
#include <functional>

#include "volcal/identify/errors/pose.h"

namespace volcal {

struct Correction {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< of X, Y, Z, m
  Eigen::Vector3d rotary = Eigen::Vector3d::Zero();  ///< of A, B, C, rad

  Correction& operator+=(const Correction& other) {
    linear += other.linear;
    rotary += other.rotary;
    return *this;
  }
  friend Correction operator+(Correction a, const Correction& b) { return a += b; }
  /// The position that is commanded instead.
  AxisPosition applied_to(AxisPosition position) const {
    for (std::size_t k = 0; k < 3; ++k) {
      position[k] += linear[static_cast<Eigen::Index>(k)];
      position[k + 3] += rotary[static_cast<Eigen::Index>(k)];
    }
    return position;
  }
};

/// At a commanded position and direction of approach.
using CorrectionTerm = std::function<Correction(const AxisPosition&, const ApproachDirection&)>;

}  // namespace volcal
