#include "volcal/identify/compensation/checks/pose_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/volume/faded_in_volume.h"
#include "volcal/identify/errors/volume/volume_moments.h"

namespace volcal {
namespace {

/// R-POS, R-RAX or R-ANG of a motion.
CompensationPart part_of_motion(const ErrorSymbol& symbol) {
  if (!is_rotation(symbol.component)) return CompensationPart::RotaryRadialAxial;
  return symbol.is_positioning() ? CompensationPart::RotaryPositioning : CompensationPart::RotaryAngular;
}

/// R-POR, but for the zero position, which R-POS corrects.
CompensationPart part_of_location(const LocationSymbol& symbol) {
  const bool zero_position =
      is_rotation(symbol.component) && direction_of(symbol.component) == direction_of(symbol.axis);
  return zero_position ? CompensationPart::RotaryPositioning : CompensationPart::RotaryLocation;
}

/// Parameters of errors of rotary axes; those that `type` corrects, or all.
std::vector<int> rotary_parameters(const ErrorField& field, const CompensationType* type) {
  std::set<int> parameters;
  const auto add = [&](CompensationPart part, const std::vector<int>& of_part) {
    if (type == nullptr || type->has(part)) parameters.insert(of_part.begin(), of_part.end());
  };
  for (const Contribution& part : field.contributions()) {
    if (const auto* motion = std::get_if<ErrorSymbol>(&part.source); motion && is_rotary(motion->axis))
      add(part_of_motion(*motion), part.parameters);
    if (const auto* location = std::get_if<LocationSymbol>(&part.source);
        location && is_rotary(location->axis))
      add(part_of_location(*location), part.parameters);
  }
  for (const EffectColumn& column : field.effects().columns()) {
    if (column.target.kind == TargetKind::Motion && is_rotary(column.target.symbol.axis))
      add(part_of_motion(column.target.symbol), {column.parameter});
  }
  return {parameters.begin(), parameters.end()};
}

}  // namespace

PoseUncertainty pose_uncertainty(const FitResult& result, const TableFormatOptions& options,
                                 std::span<const ApproachedPose> poses) {
  const Tool& tool = tool_of(result.machine, options);
  const ErrorField field(result, tool, conditions_of(result, options));
  const KinematicChain chain(result.machine);
  const bool is_uncertain = !result.covariance.isZero(0.0);
  VolumeMoments moments(is_uncertain ? result.layout.size : 0);
  FadedInVolume faded;
  for (const ApproachedPose& pose : poses) {
    const Eigen::Vector3d point_w = chain.nominal_point_w(pose.position, tool.offset);
    if (is_uncertain) moments.add(point_w, field.unheld_rows(pose.position, pose.direction).topRows<3>());
    faded.add(point_w, field.faded_errors(pose.position, pose.direction));
  }
  const Eigen::MatrixXd mean = is_uncertain ? moments.mean() : Eigen::MatrixXd();
  const auto u_of = [&](const std::vector<int>& parameters) {
    const double known =
        is_uncertain
            ? mean(parameters, parameters).cwiseProduct(result.covariance(parameters, parameters)).sum()
            : 0.0;
    return std::sqrt(std::max(0.0, known + faded.mean_square(parameters)));
  };
  const double known = is_uncertain ? mean.cwiseProduct(result.covariance).sum() : 0.0;
  return {std::sqrt(std::max(0.0, known + faded.mean_square())), u_of(rotary_parameters(field, nullptr)),
          u_of(rotary_parameters(field, &options.type))};
}

}  // namespace volcal
