#include "volcal/identify/errors/error_budget.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "volcal/identify/errors/error_grid.h"
#include "volcal/identify/stats/volumetric.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using Field = std::vector<Vector3d>;

std::string cause_of(const Contribution& part) {
  switch (part.kind) {
    case ContributionKind::Expansion:
      return "expansion of scales";
    case ContributionKind::Effect:
      return "effects beyond the rigid body";
    case ContributionKind::Tool:
      return "tool";
    case ContributionKind::Location: {
      const auto symbol = LocationSymbol::parse(part.name);
      return symbol && is_rotary(symbol->axis) ? "rotary axes" : "squareness";
    }
    case ContributionKind::Function:
      break;
  }
  const ErrorSymbol symbol = *ErrorSymbol::parse(part.name);
  if (is_rotary(symbol.axis)) return "rotary axes";
  if (symbol.is_positioning()) return "positioning";
  return symbol.is_straightness() ? "straightness" : "angular errors";
}

/// The displacements of every contribution at the poses of the volume.
class VolumeOfParts {
 public:
  VolumeOfParts(const FitResult& result, const Tool& tool, const Conditions& conditions, int per_axis)
      : result_(result), field_(result, tool, conditions), parts_(field_.contributions()) {
    fields_.resize(parts_.size());
    variances_.resize(parts_.size(), 0.0);
    for (const AxisPosition& position : grid_positions_of(result.machine, per_axis)) {
      for (unsigned signs = 0; signs < 8; ++signs) {
        ApproachDirection direction{};
        for (std::size_t i = 0; i < 3; ++i) direction[i] = ((signs >> i) & 1U) != 0 ? 1 : -1;
        add(position, direction);
      }
    }
  }

  const std::vector<Contribution>& parts() const { return parts_; }
  Field field(std::size_t part) const { return without_rigid_motion(points_, fields_[part]); }
  double u_rms(std::size_t part) const {
    return std::sqrt(std::max(0.0, variances_[part]) /
                     static_cast<double>(std::max<std::size_t>(1, points_.size())));
  }
  std::size_t size() const { return points_.size(); }

 private:
  static std::vector<AxisPosition> grid_positions_of(const Machine& machine, int per_axis) {
    return axis_grid(machine, per_axis).positions();
  }

  void add(const AxisPosition& position, const ApproachDirection& direction) {
    points_.emplace_back(position[0], position[1], position[2]);
    const PoseErrorRows rows = field_.rows(position, direction);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const std::vector<int>& parameters = parts_[p].parameters;
      Vector3d displacement = Vector3d::Zero();
      if (parts_[p].kind == ContributionKind::Expansion)
        displacement = field_.known_expansion(position, parts_[p].axis).head<3>();
      const Eigen::Matrix<double, 3, Eigen::Dynamic> of_part = rows(Eigen::seqN(0, 3), parameters);
      for (std::size_t k = 0; k < parameters.size(); ++k)
        displacement += of_part.col(static_cast<Eigen::Index>(k)) * result_.parameters[parameters[k]];
      fields_[p].push_back(displacement);
      if (result_.covariance.size() > 0 && !parameters.empty()) {
        const Eigen::MatrixXd covariance = result_.covariance(parameters, parameters);
        variances_[p] += (of_part * covariance).cwiseProduct(of_part).sum();
      }
    }
  }

  const FitResult& result_;
  ErrorField field_;
  std::vector<Contribution> parts_;
  Field points_;
  std::vector<Field> fields_;
  std::vector<double> variances_;
};

void add_to(Field& sum, const Field& part) {
  if (sum.empty()) sum.assign(part.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
}

double mean_product(const Field& one, const Field& other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) sum += one[i].dot(other[i]);
  return one.empty() ? 0.0 : sum / static_cast<double>(one.size());
}

BudgetLine line_of(std::string name, const Field& field, const Field& whole) {
  BudgetLine line;
  line.name = std::move(name);
  const VolumetricFigures figures = volumetric_figures(field);
  line.rms = figures.rms;
  line.max = figures.max;
  const double square = mean_product(whole, whole);
  line.share = square > 0.0 ? mean_product(field, whole) / square : 0.0;
  return line;
}

void sort_by_size(std::vector<BudgetLine>& lines) {
  std::ranges::stable_sort(lines, std::ranges::greater{}, &BudgetLine::rms);
}

}  // namespace

ErrorBudget error_budget(const FitResult& result, const Tool& tool, const Conditions& conditions,
                         int per_axis) {
  const VolumeOfParts volume(result, tool, conditions, per_axis);
  std::vector<Field> fields;
  Field whole(volume.size(), Vector3d::Zero());
  std::map<std::string, Field> by_cause;
  std::map<std::string, double> variance_of_cause;
  for (std::size_t p = 0; p < volume.parts().size(); ++p) {
    fields.push_back(volume.field(p));
    add_to(whole, fields.back());
    add_to(by_cause[cause_of(volume.parts()[p])], fields.back());
    variance_of_cause[cause_of(volume.parts()[p])] += volume.u_rms(p) * volume.u_rms(p);
  }
  ErrorBudget budget;
  budget.total = line_of("all", whole, whole);
  double variance = 0.0;
  for (std::size_t p = 0; p < fields.size(); ++p) {
    budget.contributions.push_back(line_of(volume.parts()[p].name, fields[p], whole));
    budget.contributions.back().depends_on = volume.parts()[p].depends_on;
    budget.contributions.back().u_rms = volume.u_rms(p);
    variance += volume.u_rms(p) * volume.u_rms(p);
  }
  budget.total.u_rms = std::sqrt(variance);
  for (const auto& [cause, field] : by_cause) {
    budget.causes.push_back(line_of(cause, field, whole));
    budget.causes.back().u_rms = std::sqrt(variance_of_cause[cause]);
  }
  sort_by_size(budget.contributions);
  sort_by_size(budget.causes);
  return budget;
}

}  // namespace volcal
