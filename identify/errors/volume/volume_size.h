#pragma once
/// Root mean square and largest error of a volume as they vary with the parameters of a fit: at the poses of
/// error_budget(), rotary axes with errors over their travel, after the best rigid motion. The error of a
/// pose is e_i + R_i d, d the deviation of the parameters from the fit.
///
/// The mean square d^T M d + 2 b^T d + a follows from the moments of the volume (volume_moments.h). With
/// M = L L^T it is |L^T d + c|^2 and a constant: no more linear quantities than parameters, however many
/// poses there are. The largest error is sought among the poses that can have it: those with |e_i| + 8 u_i no
/// less than the largest |e_j| - 8 u_j, u^2 the variances of the three components together.

#include <Eigen/Core>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

class VolumeSize {
 public:
  /// By the uncertainty of the error functions themselves beyond the measured positions
  /// (ErrorField::unheld_rows).
  VolumeSize(const FitResult& result, const Tool& tool, const Conditions& conditions, int cells_per_axis);

  double rms() const { return rms_; }  ///< of the fit, m
  double largest() const { return largest_; }
  double u() const { return u_; }  ///< root mean square of the standard uncertainty, m
  /// Derivatives to the parameters about the fit; zero where there is no error.
  const Eigen::VectorXd& rms_row() const { return rms_row_; }
  const Eigen::VectorXd& largest_row() const { return largest_row_; }

  /// What the sizes are functions of: rows() d, quantities x parameters, m.
  const Eigen::MatrixXd& rows() const { return rows_; }
  struct Sizes {
    Eigen::ArrayXd rms, largest;  ///< of every draw, m
  };
  /// `values`: rows() d of draws, draws x quantities.
  Sizes sizes(const Eigen::Ref<const Eigen::MatrixXd>& values) const;

 private:
  Eigen::MatrixXd rows_;     ///< L^T, then R_i of the poses that can have the largest error
  Eigen::VectorXd offset_;   ///< c, then e_i
  Eigen::Index of_rms_ = 0;  ///< rows of L^T
  double rest_ = 0.0;        ///< of the mean square, m^2
  double rms_ = 0.0, largest_ = 0.0, u_ = 0.0;
  Eigen::VectorXd rms_row_, largest_row_;
};

}  // namespace volcal
