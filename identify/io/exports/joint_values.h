#pragma once
/// What an identification found as values with their joint covariance, in the units that files state.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/result/result.h"

namespace volcal {

struct JointValues {
  std::vector<std::string> names;
  std::vector<std::string> units;  ///< "um", "urad", "mm" ...
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;  ///< of the values, in products of their units
};

/// Every parameter of a fit, stations and other nuisance parameters among them. Throws InputError for a
/// result without covariance, as one of errors that are stated and not identified.
JointValues parameters_with_covariance(const FitResult& result);

/// The same for the rows of the error tables, which are linear in the parameters.
struct JointTable {
  JointValues rows;           ///< named by the error
  Eigen::VectorXd positions;  ///< nan where there is none (squareness)
  std::vector<std::string> position_units;
  std::vector<std::int64_t> directions;  ///< of approach: 0 mean of both, +1, -1
  std::vector<bool> extrapolated;
  Eigen::MatrixXd derivatives;  ///< of the rows to parameters_with_covariance(), in their units
};
JointTable table_with_covariance(const FitResult& result, const ErrorTableOptions& options = {});

}  // namespace volcal
