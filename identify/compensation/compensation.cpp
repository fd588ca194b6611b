#include "volcal/identify/compensation/compensation.h"

#include <algorithm>
#include <utility>

namespace volcal {
namespace {

constexpr int kSlopeSamples = 400;

}  // namespace

Compensation::Compensation(const Machine& machine, const AxisPosition& lines, CompensationType type,
                           DisplacementField errors, LineField along, const ApproachDirection& to_home)
    : type_(type),
      errors_(std::move(errors)),
      along_(std::move(along)),
      lines_(lines),
      movable_(movable_directions(machine)) {
  for (const AxisName name : machine.main_linear_axes()) {
    const Axis& axis = machine.axis(name);
    Line line{.axis = name, .home = axis.home};
    line.at_home = on_line(line, axis.home, to_home[index_of(name)]);
    line.slope = mean_slope(line, axis);
    axes_.push_back(line);
  }
  set_squareness(machine);
  at_home_ = errors_(home_of(machine), to_home);
}

Eigen::Vector3d Compensation::on_line(const Line& line, double q, int direction) const {
  if (along_) return along_(line.axis, q, direction);
  AxisPosition position = lines_;
  position[index_of(line.axis)] = q;
  ApproachDirection approach{};
  approach[index_of(line.axis)] = static_cast<std::int8_t>(direction);
  return errors_(position, approach);
}

/// Least squares over cells of equal length, uniformly weighted.
Eigen::Vector3d Compensation::mean_slope(const Line& line, const Axis& axis) const {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double spread = 0.0;
  for (int i = 0; i < kSlopeSamples; ++i) {
    const double from_middle = axis.travel() * ((i + 0.5) / kSlopeSamples - 0.5);
    moment += from_middle * on_line(line, axis.travel_min + 0.5 * axis.travel() + from_middle, 0);
    spread += from_middle * from_middle;
  }
  return moment / spread;
}

const Compensation::Line* Compensation::find_line(AxisName axis) const {
  const auto found = std::ranges::find(axes_, axis, &Line::axis);
  return found == axes_.end() ? nullptr : &*found;
}

double Compensation::squareness(AxisName i, AxisName k) const {
  const Line* of_i = find_line(i);
  const Line* of_k = find_line(k);
  if (of_i == nullptr || of_k == nullptr || i == k) return 0.0;
  return of_i->slope[direction_of(k)] + of_k->slope[direction_of(i)];
}

void Compensation::set_squareness(const Machine& machine) {
  const std::array<AxisName, 3> order = {machine.datum.primary, machine.datum.secondary,
                                         machine.datum.third()};
  for (Line& line : axes_) {
    for (const AxisName earlier : order) {
      if (earlier == line.axis) break;
      line.squareness[direction_of(earlier)] = squareness(line.axis, earlier);
    }
  }
}

/// Of L-POS, L-STR and L-SQU as far as the type has them.
Eigen::Vector3d Compensation::error_along(const Line& line, double q, int direction) const {
  const Eigen::Vector3d error = on_line(line, q, direction) - line.at_home;
  const double travelled = q - line.home;
  const int own = direction_of(line.axis);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (type_.has(CompensationPart::Positioning)) sum[own] += error[own];
  if (type_.has(CompensationPart::Straightness)) {
    Eigen::Vector3d across = error - travelled * line.slope;
    across[own] = 0.0;
    sum += across;
  }
  if (type_.has(CompensationPart::Squareness)) sum += travelled * line.squareness;
  return sum;
}

Eigen::Vector3d Compensation::along_axis(AxisName axis, double q, int direction) const {
  const Line* line = find_line(axis);
  if (line == nullptr) return Eigen::Vector3d::Zero();
  return -error_along(*line, q, direction).cwiseProduct(movable_);
}

Eigen::Vector3d Compensation::error_of_type(const AxisPosition& position,
                                            const ApproachDirection& direction) const {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  if (type_.is_volumetric() || type_.has(CompensationPart::Angular))
    error = errors_(position, direction) - at_home_;
  if (type_.is_volumetric()) return error;
  for (const Line& line : axes_) {
    const double q = position[index_of(line.axis)];
    const std::int8_t approach = direction[index_of(line.axis)];
    if (type_.has(CompensationPart::Angular)) error -= on_line(line, q, approach) - line.at_home;
    error += error_along(line, q, approach);
  }
  return error;
}

Eigen::Vector3d Compensation::correction(const AxisPosition& position,
                                         const ApproachDirection& direction) const {
  return -error_of_type(position, direction).cwiseProduct(movable_);
}

}  // namespace volcal
