#include "volcal/identify/errors/volume/error_budget.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/volume/faded_in_volume.h"
#include "volcal/identify/errors/volume/volume_moments.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/statistics/quadratic_form.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using Field = std::vector<Vector3d>;

constexpr const char* kCauseOfRotaryAxes = "rotary axes";

/// Of every kind of source.
struct CauseOf {
  std::string operator()(const ExpansionError&) const { return "expansion of scales"; }
  std::string operator()(const EffectName&) const { return kCauseOfEffects; }
  std::string operator()(const ToolOffsetError&) const { return "tool"; }
  std::string operator()(const LocationSymbol& symbol) const {
    return is_rotary(symbol.axis) ? kCauseOfRotaryAxes : "squareness";
  }
  std::string operator()(const ErrorSymbol& symbol) const {
    if (is_rotary(symbol.axis)) return kCauseOfRotaryAxes;
    if (symbol.is_positioning()) return "positioning";
    return symbol.is_straightness() ? "straightness" : "angular errors";
  }
};

/// The displacements of every contribution at the poses of the volume.
class VolumeOfParts {
 public:
  VolumeOfParts(const FitResult& result, const Tool& tool, const Conditions& conditions, int cells_per_axis,
                RotaryPoses rotary)
      : result_(result),
        is_uncertain_(!result.covariance.isZero(0.0)),
        field_(result, tool, conditions),
        parts_(field_.contributions()),
        turned_(rotary == RotaryPoses::AtRest ? std::vector<AxisName>() : identified_rotary_axes(result)) {
    fields_.resize(parts_.size());
    VolumeMoments moments(is_uncertain_ ? result.parameters.size() : 0);
    for (const VolumePose& pose :
         volume_poses(result.machine, tool, field_.effects(), turned_, cells_per_axis)) {
      add(pose);
      if (!pose.inside) continue;
      ++inside_;
      add_uncertainty(pose, moments);
    }
    if (is_uncertain_) moments_ = moments.mean();
  }

  const std::vector<Contribution>& parts() const { return parts_; }
  const std::vector<AxisName>& turned() const { return turned_; }
  Field field(std::size_t part) const { return without_rigid_motion(points_, fields_[part], inside_); }
  std::size_t size() const { return points_.size(); }
  /// The first of them, which count in means; at the others, the ends of travel, the largest error is sought.
  std::size_t inside() const { return inside_; }

  /// Root mean square of the standard uncertainty of what these parameters make together.
  double u_rms(const std::vector<int>& parameters) const {
    if (parameters.empty()) return 0.0;
    double known = 0.0;
    if (is_uncertain_)
      known = result_.covariance(parameters, parameters).cwiseProduct(moments_(parameters, parameters)).sum();
    return std::sqrt(std::max(0.0, known + faded_.mean_square(parameters)));
  }
  /// Of the mean square, by independent standard normal variables squared: one for each curve or surface that
  /// has faded out, beside those of the covariance.
  Eigen::VectorXd weights(const std::vector<int>& parameters) const {
    const std::vector<double> faded = faded_.mean_squares(parameters);
    const Eigen::VectorXd known = is_uncertain_ ? known_weights(parameters) : Eigen::VectorXd();
    Eigen::VectorXd all(known.size() + static_cast<Eigen::Index>(faded.size()));
    all << known, Eigen::Map<const Eigen::VectorXd>(faded.data(), static_cast<Eigen::Index>(faded.size()));
    return all;
  }

 private:
  Eigen::VectorXd known_weights(const std::vector<int>& parameters) const {
    const SymmetricEigen moments = eigen_decomposition(moments_(parameters, parameters));
    const Eigen::MatrixXd root = moments.vectors * moments.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
    return eigenvalues(root.transpose() * result_.covariance(parameters, parameters) * root).cwiseMax(0.0);
  }

  void add(const VolumePose& pose) {
    points_.push_back(pose.place_w);
    const Eigen::Matrix<double, 3, Eigen::Dynamic> rows =
        field_.rows(pose.position, pose.direction).topRows<3>();
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      Vector3d displacement = Vector3d::Zero();
      if (const auto* expansion = std::get_if<ExpansionError>(&parts_[p].source))
        displacement = field_.known_expansion(pose.position, expansion->axis).head<3>();
      for (const int parameter : parts_[p].parameters)
        displacement += rows.col(parameter) * result_.parameters[parameter];
      fields_[p].push_back(displacement);
    }
  }
  void add_uncertainty(const VolumePose& pose, VolumeMoments& moments) {
    if (is_uncertain_)
      moments.add(pose.place_w, field_.unheld_rows(pose.position, pose.direction).topRows<3>());
    faded_.add(pose.place_w, field_.faded_errors(pose.position, pose.direction));
  }

  const FitResult& result_;
  bool is_uncertain_;
  ErrorField field_;
  std::vector<Contribution> parts_;
  std::vector<AxisName> turned_;
  Field points_;
  std::size_t inside_ = 0;
  std::vector<Field> fields_;
  Eigen::MatrixXd moments_;
  FadedInVolume faded_;
};

void add_to(Field& sum, const Field& part) {
  if (sum.empty()) sum.assign(part.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
}

double mean_product(std::span<const Vector3d> one, std::span<const Vector3d> other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) sum += one[i].dot(other[i]);
  return one.empty() ? 0.0 : sum / static_cast<double>(one.size());
}

/// The first `inside` points count in means.
BudgetLine line_of(std::string name, const Field& field, const Field& whole, std::size_t inside) {
  BudgetLine line;
  line.name = std::move(name);
  const std::span<const Vector3d> of_field = std::span(field).first(inside);
  const std::span<const Vector3d> of_whole = std::span(whole).first(inside);
  line.rms = std::sqrt(mean_product(of_field, of_field));
  line.max = volumetric_figures(field).max;
  const double square = mean_product(of_whole, of_whole);
  line.share = square > 0.0 ? mean_product(of_field, of_whole) / square : 0.0;
  return line;
}

void sort_by_size(std::vector<BudgetLine>& lines) {
  std::ranges::stable_sort(lines, std::ranges::greater{},
                           [](const BudgetLine& line) { return std::pair(line.rms, line.u_rms); });
}

/// Where a sum of chi-squared variables with these weights exceeds with probability 5 %.
double exceeded_by_5_percent(const Eigen::VectorXd& weights) {
  const double wanted = std::log10(0.05);
  double low = 0.0, high = weights.sum();
  while (log10_quadratic_form_exceedance(high, weights) > wanted) high *= 2.0;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (log10_quadratic_form_exceedance(middle, weights) > wanted ? low : high) = middle;
  }
  return high;
}

/// What contributions have in common: a cause, or all.
struct Together {
  Field field;
  std::vector<int> parameters;

  void add(const Field& part, const std::vector<int>& of_part) {
    add_to(field, part);
    parameters.insert(parameters.end(), of_part.begin(), of_part.end());
  }
};

}  // namespace

std::string BudgetLine::depends_on_text() const {
  std::string text;
  for (const Variable& variable : depends_on) text += (text.empty() ? "" : " ") + variable.name();
  return text;
}

ErrorBudget error_budget(const FitResult& result, const Tool& tool, const Conditions& conditions,
                         int cells_per_axis, RotaryPoses rotary) {
  const VolumeOfParts volume(result, tool, conditions, cells_per_axis, rotary);
  Together whole;
  whole.field.assign(volume.size(), Vector3d::Zero());
  std::map<std::string, Together> by_cause;
  std::vector<Field> fields;
  for (std::size_t p = 0; p < volume.parts().size(); ++p) {
    const Contribution& part = volume.parts()[p];
    fields.push_back(volume.field(p));
    whole.add(fields.back(), part.parameters);
    by_cause[std::visit(CauseOf{}, part.source)].add(fields.back(), part.parameters);
  }
  ErrorBudget budget;
  budget.turned = volume.turned();
  for (const Axis& axis : result.machine.axes) {
    if (is_rotary(axis.name) && std::ranges::find(budget.turned, axis.name) == budget.turned.end())
      budget.at_rest.push_back(axis.name);
  }
  const auto line = [&](const std::string& name, const Field& field, const std::vector<int>& parameters) {
    BudgetLine made = line_of(name, field, whole.field, volume.inside());
    made.u_rms = volume.u_rms(parameters);
    const double square = budget.total.rms * budget.total.rms;
    const double expected = square + budget.total.u_rms * budget.total.u_rms;
    if (expected > 0.0) made.expected_share = (made.share * square + made.u_rms * made.u_rms) / expected;
    return made;
  };
  budget.total = line("all", whole.field, whole.parameters);
  budget.total.expected_share = budget.total.expected_rms() > 0.0 ? 1.0 : 0.0;
  for (std::size_t p = 0; p < fields.size(); ++p) {
    const Contribution& part = volume.parts()[p];
    BudgetLine& made = budget.contributions.emplace_back(line(part.name, fields[p], part.parameters));
    made.source = part.source;
    made.depends_on = part.depends_on;
  }
  for (const auto& [cause, together] : by_cause)
    budget.causes.push_back(line(cause, together.field, together.parameters));
  if (budget.total.rms == 0.0 && budget.total.u_rms > 0.0)
    budget.rms_95 = std::sqrt(exceeded_by_5_percent(volume.weights(whole.parameters)));
  sort_by_size(budget.contributions);
  sort_by_size(budget.causes);
  return budget;
}

}  // namespace volcal
