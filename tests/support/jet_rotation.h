#pragma once
/// What turns a rotation: from automatic derivatives.

#include <Eigen/Core>

namespace volcal::testing_support {

/// The skew part of R R_0^T, R_0 being R without derivatives: its derivatives are those of the rotation
/// vector.
template <class Jet>
Eigen::Matrix<Jet, 3, 1> turn_of(const Eigen::Matrix<Jet, 3, 3>& rotation) {
  Eigen::Matrix<Jet, 3, 3> nominal;
  for (int i = 0; i < 9; ++i) nominal(i) = Jet(rotation(i).a);
  const Eigen::Matrix<Jet, 3, 3> turned = rotation * nominal.transpose();
  return Eigen::Matrix<Jet, 3, 1>(turned(2, 1) - turned(1, 2), turned(0, 2) - turned(2, 0),
                                  turned(1, 0) - turned(0, 1)) *
         Jet(0.5);
}

}  // namespace volcal::testing_support
