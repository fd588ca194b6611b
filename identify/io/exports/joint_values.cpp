#include "volcal/identify/io/exports/joint_values.h"

#include <limits>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

/// Covariance of values in SI as that of the same values in their units, symmetric to the last bit.
Eigen::MatrixXd covariance_in_units(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& si_per_unit) {
  return (0.5 * (covariance + covariance.transpose())).cwiseQuotient(si_per_unit * si_per_unit.transpose());
}

Eigen::VectorXd parameter_units(const FitResult& result) {
  Eigen::VectorXd si_per_unit(result.parameters.size());
  Eigen::Index i = 0;
  for (const NamedParameter& parameter : named_parameters(result.layout))
    si_per_unit[i++] = parameter.si_per_unit;
  return si_per_unit;
}

void require_covariance(const FitResult& result) {
  if (result.parameters.size() == 0)
    throw InputError({}, "the result has no parameters: nothing was estimated",
                     "leave an error on in the model file, and fit again");
  if (result.covariance.rows() == result.parameters.size() && !result.covariance.isZero(0.0)) return;
  throw InputError({}, "the result states no uncertainty",
                   "give the folder that volcal fit wrote; errors that are stated have none");
}

}  // namespace

JointValues parameters_with_covariance(const FitResult& result) {
  require_covariance(result);
  JointValues joint;
  const Eigen::VectorXd si_per_unit = parameter_units(result);
  for (const NamedParameter& parameter : named_parameters(result.layout)) {
    joint.names.push_back(parameter.name);
    joint.units.push_back(parameter.unit);
  }
  joint.values = result.parameters.cwiseQuotient(si_per_unit);
  joint.covariance = covariance_in_units(result.covariance, si_per_unit);
  return joint;
}

JointTable table_with_covariance(const FitResult& result, const ErrorTableOptions& options) {
  require_covariance(result);
  const std::vector<ErrorTableRow> rows = error_table(result, options);
  const Eigen::MatrixXd derivatives = error_table_derivatives(result, options);
  JointTable table;
  const auto count = static_cast<Eigen::Index>(rows.size());
  table.rows.values.resize(count);
  table.positions.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ErrorTableRow& row = rows[static_cast<std::size_t>(i)];
    table.rows.names.push_back(row.symbol.name());
    table.rows.units.emplace_back(row.rotation ? "urad" : "um");
    table.rows.values[i] = row.value / kMicro;
    const Unit unit = row.axis ? position_unit(*row.axis) : Unit{};
    table.positions[i] =
        row.axis ? row.position / unit.si_per_unit : std::numeric_limits<double>::quiet_NaN();
    table.position_units.emplace_back(row.axis ? std::string(unit.suffix) : "");
    table.directions.push_back(row.direction);
    table.extrapolated.push_back(row.extrapolated);
  }
  table.rows.covariance = covariance_in_units(derivatives * result.covariance * derivatives.transpose(),
                                              Eigen::VectorXd::Constant(count, kMicro));
  table.derivatives = derivatives * parameter_units(result).asDiagonal() / kMicro;
  return table;
}

}  // namespace volcal
