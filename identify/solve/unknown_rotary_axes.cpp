#include "volcal/identify/solve/unknown_rotary_axes.h"

#include <algorithm>
#include <stdexcept>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/rank.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

bool is_one_of(const std::vector<AxisName>& axes, AxisName axis) {
  return std::ranges::find(axes, axis) != axes.end();
}

}  // namespace

ModelSpec with_unknown_errors(const Campaign& campaign, ModelSpec model, const std::vector<AxisName>& axes) {
  ModelSpec unknown;
  unknown.default_function.basis = "zero";
  for (const AxisName axis : axes) {
    for (const Component component : kAllComponents)
      unknown.functions[{component, axis}] = usual_function(campaign.machine.axis(axis));
  }
  unknown = resolve_knots(unknown, campaign);
  for (const auto& [symbol, function] : unknown.functions) {
    if (is_one_of(axes, symbol.axis)) model.functions[symbol] = function;
  }
  for (const LocationSymbol& symbol : independent_locations(campaign.machine)) {
    if (is_one_of(axes, symbol.axis)) model.locations[symbol] = 0.0;
  }
  return model;
}

Eigen::MatrixXd covariance_of_unknown_errors(const MeasurementModel& model, const std::vector<AxisName>& axes,
                                             const Eigen::VectorXd& parameters,
                                             const std::vector<double>& sigma) {
  const DatumSpace datum(
      model.layout(), model.campaign().machine, parameters,
      [&](ErrorSymbol symbol) { return is_one_of(axes, symbol.axis); },
      [&](const ParameterBlock& block) { return block.location && is_one_of(axes, block.location->axis); });
  const GaussianPrior prior = wide_prior(model, datum, Eigen::VectorXd::Zero(datum.size()), sigma);
  const auto factor = cholesky_lower(prior.precision);
  if (!factor)
    throw std::runtime_error("covariance_of_unknown_errors: the wide prior is not positive definite");
  return datum.expand_covariance(inverse_from_cholesky(*factor));
}

}  // namespace volcal
