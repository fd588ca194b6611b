#include "volcal/identify/errors/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "volcal/identify/errors/alignment_checks.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/kinematics/rotary_datum.h"
#include "volcal/model/observation/measurement_model.h"
#include "volcal/model/observation/restated_readings.h"

namespace volcal {
namespace {

/// A function of (parameters, 1) by its derivatives, or, of errors that are stated, by its value alone: what
/// has no covariance needs no Jacobian, whose size goes with the square of the parameters' number.
using Functional = Eigen::RowVectorXd;
using VectorRows = Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< of a vector, so

constexpr double kHolds = 1e-9;  // largest misfit of 1, or of a slope over the travel, in a basis
constexpr double kHeld = 1e-7;   // share of a displacement that locations and frames may leave
constexpr int kAlignedPoses = 180;
constexpr double kSameOffset = 1e-12;  // m
constexpr double kSameHome = 1e-9;     // m or rad
/// By which alignments turn tools, rad: offsets of a model that differ by more are those of other tools.
constexpr double kLargestTurn = 1e-3;

Eigen::Vector3d axis_vector(AxisName axis) { return Eigen::Vector3d::Unit(direction_of(axis)); }

/// a x e, column by column.
VectorRows crossed(const VectorRows& a, const Eigen::Vector3d& e) {
  VectorRows result(3, a.cols());
  for (Eigen::Index column = 0; column < a.cols(); ++column)
    result.col(column) = Eigen::Vector3d(a.col(column)).cross(e);
  return result;
}

/// Coefficients of `value` + `slope` (q - from); InputError when the basis does not hold it.
Eigen::VectorXd straight_line(const Basis& basis, ErrorSymbol symbol, double value, double slope,
                              double from) {
  const BasisMoments moment = moments(basis);
  const Eigen::VectorXd right = (value - slope * from) * moment.zeroth + slope * moment.first;
  Eigen::VectorXd coefficients = coefficients_with_integrals(basis, right);
  const std::vector<double> ends = basis.pieces();
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    for (const double q : {ends[i], 0.5 * (ends[i] + ends[i + 1]), ends[i + 1]}) {
      if (!(std::abs(basis.value(q, coefficients) - value - slope * (q - from)) <= kHolds))
        throw InputError({}, "the basis of " + symbol.name() + " does not hold a constant and a slope",
                         "fit with a B-spline or a Legendre basis for it");
    }
  }
  return coefficients;
}

bool is_of_rotary_axis(const ParameterBlock& block) {
  return block.location && is_rotary(block.location->axis);
}

/// Parameters of the machine itself; the others belong to the campaign.
bool belongs_to_machine(const ParameterBlock& block) { return block.kind != ParameterKind::Nuisance; }

bool has_rotary_errors(const FitResult& result) {
  return std::ranges::any_of(result.layout.groups,
                             [](const FunctionGroup& group) { return is_rotary(group.axis); }) ||
         std::ranges::any_of(result.layout.blocks, is_of_rotary_axis);
}

class Realignment {
 public:
  Realignment(const FitResult& result, const Alignment& alignment)
      : old_(result), to_(alignment), machine_(result.machine) {
    machine_.datum = alignment.datum;
    direction_.fill(VectorRows::Zero(3, columns()));
    for (const AxisName axis : machine_.linear_axes())
      if (alignment.origin) axis_of(axis).home = (*alignment.origin)[index_of(axis)];
    for (const AxisName axis : machine_.linear_axes()) direction_[index_of(axis)] = direction(axis);
    phi_ = frame_rotation();
  }

  AlignedResult aligned() {
    AlignedResult aligned{old_};
    FitResult& result = aligned.result;
    Eigen::MatrixXd rows = parameter_rows(result.layout);
    if (has_rotary_errors(old_)) carry_rotary_axes(result.layout, rows);
    if (tool_turn_) give_turn_to_spindle(result, rows);
    result.parameters = rows * extended();
    aligned.frame_rotation = phi_ * extended();
    aligned.frame_covariance.setZero(phi_.rows(), phi_.rows());
    if (!is_stated()) {
      const Eigen::Index size = old_.parameters.size();
      const Eigen::MatrixXd jacobian = rows.leftCols(size);
      result.covariance = jacobian * old_.covariance * jacobian.transpose();
      aligned.frame_covariance = phi_.leftCols(size) * old_.covariance * phi_.leftCols(size).transpose();
    }
    if (!has_rotary_errors(old_)) turn_tools();
    result.machine = machine_;
    result.adjustment = nullptr;
    result.residuals.clear();
    update_model(result);
    update_rank(result);
    return aligned;
  }

 private:
  Axis& axis_of(AxisName name) { return *std::ranges::find(machine_.axes, name, &Axis::name); }
  bool is_stated() const { return old_.covariance.size() == 0; }
  Eigen::Index columns() const { return is_stated() ? 1 : old_.parameters.size() + 1; }
  /// Functionals times it are their values.
  Eigen::VectorXd extended() const {
    Eigen::VectorXd values = Eigen::VectorXd::Ones(columns());
    if (!is_stated()) values.head(old_.parameters.size()) = old_.parameters;
    return values;
  }
  /// The column that a parameter stands in, and what stands there for it.
  Eigen::Index column_of(Eigen::Index parameter) const { return is_stated() ? 0 : parameter; }
  double unit_of(Eigen::Index parameter) const { return is_stated() ? old_.parameters[parameter] : 1.0; }

  /// Puts `weights` of a function's coefficients into a functional; nothing where it is switched off.
  Functional of_coefficients(ErrorSymbol symbol, const auto& weights) const {
    Functional row = Functional::Zero(columns());
    const auto place = old_.layout.find(symbol);
    if (!place) return row;
    const FunctionGroup& group = old_.layout.groups[static_cast<std::size_t>(place->group)];
    const Eigen::VectorXd values = weights(*group.basis);
    for (int j = 0; j < group.basis->size(); ++j) {
      const int parameter = group.index(j, place->slot);
      row[column_of(parameter)] += values[j] * unit_of(parameter);
    }
    return row;
  }
  Functional at_origin(ErrorSymbol symbol) const {
    const double home = machine_.axis(symbol.axis).home;
    return of_coefficients(symbol, [home](const Basis& basis) { return basis.row(home); });
  }
  /// Least-squares slope over the travel (datum.h); of straightness functions alone.
  Functional slope(ErrorSymbol symbol) const {
    if (has_free_slope(symbol)) return Functional::Zero(columns());
    const Axis& axis = machine_.axis(symbol.axis);
    const double middle = 0.5 * (axis.travel_min + axis.travel_max), length = axis.travel();
    return of_coefficients(symbol, [=](const Basis& basis) {
      const BasisMoments moment = moments(basis);
      return Eigen::VectorXd(12.0 / (length * length * length) * (moment.first - middle * moment.zeroth));
    });
  }

  VectorRows angles_at_origin(AxisName axis) const {
    VectorRows rows(3, columns());
    for (const Component component : {Component::A, Component::B, Component::C})
      rows.row(direction_of(component)) = at_origin({component, axis});
    return rows;
  }

  /// Mean direction of an axis minus its nominal one: squareness, straightness slopes, angles at the new
  /// origin of the axes that carry it.
  VectorRows direction(AxisName axis) const {
    const Eigen::Vector3d e = axis_vector(axis);
    VectorRows rows = VectorRows::Zero(3, columns());
    for (const ParameterBlock& block : old_.layout.blocks) {
      if (!block.location || block.location->axis != axis) continue;
      const Eigen::Vector3d about =
          axis_vector(kAllAxes[static_cast<std::size_t>(direction_of(block.location->component))]);
      rows.col(column_of(block.offset)) += unit_of(block.offset) * about.cross(e);
    }
    for (const Component component : {Component::X, Component::Y, Component::Z})
      rows.row(direction_of(component)) += slope({component, axis});
    for (const Joint& joint : machine_.structure.joints) {
      if (joint.axis == axis && !joint.workpiece_side) break;
      if (!is_rotary(joint.axis)) rows += crossed(angles_at_origin(joint.axis), e);
      if (joint.axis == axis) break;
    }
    return rows;
  }

  VectorRows frame_rotation() const {
    const Datum& datum = machine_.datum;
    const Eigen::Vector3d e_p = axis_vector(datum.primary), e_s = axis_vector(datum.secondary);
    VectorRows reference = direction_[index_of(datum.primary)];
    if (to_.spindle_tilt)
      reference.col(columns() - 1) +=
          Eigen::Vector3d(to_.spindle_tilt->x(), to_.spindle_tilt->y(), 0.0).cross(e_p);
    const VectorRows across = -crossed(reference, e_p);
    const Functional about_primary =
        e_p.cross(e_s).transpose() * (direction_[index_of(datum.secondary)] - crossed(across, e_s));
    return across + e_p * about_primary;
  }

  /// Direction error of an axis in the new frame.
  VectorRows turned_direction(AxisName axis) const {
    return direction_[index_of(axis)] - crossed(phi_, axis_vector(axis));
  }

  /// As Datum::squareness(); without a third axis the first alone is an error of the machine.
  std::array<Functional, 3> squareness_rows() const {
    const Datum& datum = machine_.datum;
    const Eigen::Vector3d e_p = axis_vector(datum.primary), e_s = axis_vector(datum.secondary),
                          e_t = axis_vector(datum.third());
    const VectorRows secondary = turned_direction(datum.secondary), third = turned_direction(datum.third());
    return {e_t.cross(e_s).transpose() * secondary, e_p.cross(e_t).transpose() * third,
            e_s.cross(e_t).transpose() * third};
  }

  /// What is left between the primary axis and the direction of the frame; zero but for a tilted spindle.
  Functional kept_slope(ErrorSymbol symbol) const {
    if (!to_.spindle_tilt || symbol.axis != machine_.datum.primary || has_free_slope(symbol))
      return Functional::Zero(columns());
    return turned_direction(symbol.axis).row(direction_of(symbol.component));
  }

  void keep_function(const FunctionGroup& group, int slot, Eigen::MatrixXd& rows) const {
    for (int j = 0; j < group.basis->size(); ++j) {
      const int parameter = group.index(j, slot);
      rows(parameter, column_of(parameter)) += unit_of(parameter);
    }
  }

  void write_function(ErrorSymbol symbol, const FunctionGroup& group, int slot, Eigen::MatrixXd& rows) const {
    const double home = machine_.axis(symbol.axis).home;
    const Eigen::VectorXd one = straight_line(*group.basis, symbol, 1.0, 0.0, home);
    const Functional constant = at_origin(symbol);
    keep_function(group, slot, rows);
    for (int j = 0; j < group.basis->size(); ++j) rows.row(group.index(j, slot)) -= one[j] * constant;
    if (has_free_slope(symbol)) return;
    const Eigen::VectorXd line = straight_line(*group.basis, symbol, 0.0, 1.0, home);
    const Functional change = kept_slope(symbol) - slope(symbol);
    for (int j = 0; j < group.basis->size(); ++j) rows.row(group.index(j, slot)) += line[j] * change;
  }

  ParameterBlock location_block(LocationSymbol symbol) const {
    ParameterBlock block;
    block.kind = ParameterKind::Location;
    block.name = symbol.name();
    block.location = symbol;
    block.labels = {""};
    block.units = {"urad"};
    block.si_per_unit = {1e-6};
    block.guess = block.prior_mean = block.prior_sigma = Eigen::VectorXd::Zero(1);
    return block;
  }

  /// New parameters from (old ones, 1); gives `layout` the new blocks.
  Eigen::MatrixXd parameter_rows(ParameterLayout& layout) const {
    layout.blocks.clear();
    layout.size = layout.function_size;
    const auto append = [&layout](ParameterBlock block) {
      block.offset = layout.size;
      layout.size += block.size();
      layout.blocks.push_back(std::move(block));
    };
    const std::vector<LocationSymbol> angles = squareness_errors(machine_);
    for (const LocationSymbol symbol : angles) append(location_block(symbol));
    for (const ParameterBlock& block : old_.layout.blocks) {
      if (belongs_to_machine(block) && (!block.location || is_of_rotary_axis(block))) append(block);
    }
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(layout.size, columns());
    for (const FunctionGroup& group : layout.groups) {
      for (int slot = 0; slot < group.count(); ++slot) {
        if (is_rotary(group.axis)) {
          keep_function(group, slot, rows);
        } else {
          write_function(group.symbols[static_cast<std::size_t>(slot)], group, slot, rows);
        }
      }
    }
    const std::array<Functional, 3> squareness = squareness_rows();
    for (std::size_t i = 0; i < angles.size(); ++i) rows.row(layout.blocks[i].offset) = squareness[i];
    for (std::size_t i = angles.size(); i < layout.blocks.size(); ++i) {
      const ParameterBlock& block = layout.blocks[i];
      const int former = old_.layout.find_block(block.name)->offset;
      for (int k = 0; k < block.size(); ++k)
        rows(block.offset + k, column_of(former + k)) = unit_of(former + k);
    }
    return rows;
  }

  /// Displacements that the linear axes' new errors and the old ones differ by, three rows a point.
  Eigen::MatrixXd displaced(const ParameterLayout& layout, const Eigen::MatrixXd& rows,
                            const std::vector<PosedPoint>& points) const {
    const KinematicChain chain(old_.machine), chain_now(machine_);
    Eigen::MatrixXd displacements(3 * static_cast<Eigen::Index>(points.size()), columns());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PosedPoint& at = points[i];
      auto part = displacements.middleRows<3>(3 * static_cast<Eigen::Index>(i));
      part = pose_error_rows(chain_now, layout, at.position, at.offset_t, at.position).topRows<3>() * rows;
      const auto former = pose_error_rows(chain, old_.layout, at.position, at.offset_t, at.position);
      if (is_stated()) {
        part.col(0) -= former.topRows<3>() * old_.parameters;
      } else {
        part.leftCols(old_.parameters.size()) -= former.topRows<3>();
      }
    }
    return displacements;
  }

  /// The machine frame is that of the linear axes: the lines of rotary axes stand in it as the physical lines
  /// do, and where the angles of linear axes changed at their origin the tools, or the lines of a head,
  /// turned.
  void carry_rotary_axes(const ParameterLayout& layout, Eigen::MatrixXd& rows) {
    std::vector<LocationSymbol> lines;
    std::vector<int> offsets;
    for (const ParameterBlock& block : layout.blocks) {
      if (!is_of_rotary_axis(block)) continue;
      lines.push_back(*block.location);
      offsets.push_back(block.offset);
    }
    const std::vector<PosedPoint> points = spread_points(machine_, kAlignedPoses);
    const Eigen::MatrixXd missing = displaced(layout, rows, points);
    const FrameChangeColumns change = frame_change_columns(machine_, lines, points);
    const auto line_count = static_cast<Eigen::Index>(lines.size());
    Eigen::MatrixXd moved(missing.rows(), line_count + 9);
    moved << change.locations, change.workpiece, change.tools;
    Eigen::MatrixXd solution;
    for (const Eigen::Index taken : {line_count + 6, line_count + 9}) {
      solution = -solved(moved.leftCols(taken), missing);
      if ((moved.leftCols(taken) * solution + missing).norm() <= kHeld * missing.norm()) break;
      if (taken == moved.cols())
        throw InputError({},
                         "location errors of the rotary axes do not hold how the new frame moves their lines",
                         "fit with all location errors of rotary axes in the model");
    }
    for (Eigen::Index i = 0; i < line_count; ++i)
      rows.row(offsets[static_cast<std::size_t>(i)]) += solution.row(i);
    if (solution.rows() > line_count + 6) tool_turn_ = solution.bottomRows<3>();
  }

  /// The control goes on with the offsets that it knows, and a table turns what they miss the point by: the
  /// turn is an error of the spindle, and the offsets stay.
  void give_turn_to_spindle(FitResult& result, Eigen::MatrixXd& rows) const {
    EffectSpec& spindle = only_effect("spindle-direction", result.identified);
    const auto effect = find_effect(spindle.kind)->make(spindle, result.identified.file);
    for (Eigen::Index about = 0; about < 3; ++about) {
      const EffectAmplitude& amplitude = effect->amplitudes()[static_cast<std::size_t>(about)];
      const int place = place_of_amplitude(amplitude, result.layout);
      rows.conservativeResizeLike(Eigen::MatrixXd::Zero(result.layout.size, columns()));
      rows.row(place) += tool_turn_->row(about);
      amplitude.keep(rows.row(place).dot(extended()), spindle.options);
    }
  }

  static Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    Eigen::MatrixXd x(a.cols(), b.cols());
    for (Eigen::Index k = 0; k < b.cols(); ++k) {
      const bool any = b.col(k).squaredNorm() > 0.0;
      x.col(k) = any ? least_squares(a, b.col(k), 1e-9).solution : Eigen::VectorXd::Zero(a.cols());
    }
    return x;
  }

  Eigen::Vector3d tool_turn() const {
    Eigen::Vector3d turn = -(phi_ * extended());
    for (const Joint& joint : machine_.structure.joints) {
      if (!is_rotary(joint.axis)) turn += angles_at_origin(joint.axis) * extended();
    }
    return turn;
  }

  void turn_tools() {
    const Eigen::Vector3d turn = tool_turn();
    for (Tool& tool : machine_.tools) tool.offset += turn.cross(tool.offset);
  }

  void update_model(FitResult& result) const {
    for (auto& [symbol, function] : result.identified.functions) {
      if (function.coefficients.empty() || !result.layout.find(symbol)) continue;
      const Eigen::VectorXd values = result.layout.coefficients(symbol, result.parameters);
      function.coefficients.assign(values.begin(), values.end());
    }
    result.identified.locations.clear();
    std::erase_if(result.identified.locations_off,
                  [](const LocationSymbol& symbol) { return !is_rotary(symbol.axis); });
    for (const ParameterBlock& block : result.layout.blocks) {
      if (block.location) result.identified.locations[*block.location] = result.parameters[block.offset];
    }
  }

  /// A squareness of the new datum is as visible as the worst that it is made of.
  void update_rank(FitResult& result) const {
    auto& errors = result.rank.errors;
    const auto is_location = [](const Observability& error) {
      const auto symbol = error.symbol.location();
      return symbol && !is_rotary(symbol->axis);
    };
    for (Observability& error : errors) {
      const auto symbol = error.symbol.location();
      if (!symbol || !is_rotary(symbol->axis)) continue;
      if (const ParameterBlock* block = result.layout.find_location(*symbol))
        error.u_rms = std::sqrt(parameter_variance(result, block->offset));
    }
    Observability worst;
    worst.visible_fraction = 1.0;
    for (const Observability& error : errors) {
      if (!is_location(error)) continue;
      worst.visible_fraction = std::min(worst.visible_fraction, error.visible_fraction);
      if (!error.visible) worst = error;
    }
    if (std::erase_if(errors, is_location) == 0) return;
    for (const LocationSymbol& symbol : squareness_errors(machine_)) {
      const ParameterBlock& block = *result.layout.find_location(symbol);
      worst.symbol = symbol;
      worst.u_rms = std::sqrt(parameter_variance(result, block.offset));
      worst.effective_parameters = 1.0;
      errors.push_back(worst);
    }
  }

  const FitResult& old_;
  const Alignment& to_;
  Machine machine_;
  std::array<VectorRows, 3> direction_;
  VectorRows phi_;
  /// Of a machine with rotary errors, where no rotary axis carries the tools and could take it.
  std::optional<VectorRows> tool_turn_;
};

std::string alignment_words(const FitResult& result) {
  std::string text = "primary " + std::string(1, letter_of(result.machine.datum.primary)) + ", secondary " +
                     letter_of(result.machine.datum.secondary) + ", origin";
  for (const AxisName axis : result.machine.linear_axes()) {
    std::string value = std::to_string(result.machine.axis(axis).home * kPerMilli);
    value.erase(value.find_last_not_of('0') + 1);
    if (value.back() == '.') value.pop_back();
    text += std::string(" ") + letter_of(axis) + "=" + value;
  }
  return text + " mm";
}

}  // namespace

Datum wished_datum(const Datum& former, std::optional<AxisName> primary, std::optional<AxisName> secondary,
                   bool spindle) {
  Datum datum = former;
  if (primary) {
    datum.primary = *primary;
  } else if (spindle) {
    datum.primary = AxisName::Z;
  }
  if (secondary) {
    datum.secondary = *secondary;
  } else if (datum.secondary == datum.primary) {
    datum.secondary = former.primary == datum.primary ? former.third() : former.primary;
  } else if (spindle && !primary && former.primary != AxisName::Z) {
    datum.secondary = former.primary;
  }
  return datum;
}

AlignedResult align_result(const FitResult& result, const Alignment& alignment) {
  check_alignment(result, alignment);
  AlignedResult aligned = Realignment(result, alignment).aligned();
  aligned.result.alignment =
      alignment_words(aligned.result) + (alignment.spindle_tilt ? ", along the spindle" : "");
  return aligned;
}

bool is_in_other_frame(const FitResult& result, const Machine& machine) {
  if (!result.alignment.empty()) return true;
  const Datum &own = result.machine.datum, &other = machine.datum;
  return own.primary != other.primary || own.secondary != other.secondary ||
         std::ranges::any_of(machine.axes, [&](const Axis& axis) {
           return result.machine.has_axis(axis.name) &&
                  std::abs(result.machine.axis(axis.name).home - axis.home) > kSameHome;
         });
}

void adopt_alignment(Campaign& campaign, const FitResult& result) {
  if (!is_in_other_frame(result, campaign.machine)) return;
  const double most = result.alignment.empty() ? kLargestTurn : std::numeric_limits<double>::infinity();
  campaign.machine.datum = result.machine.datum;
  for (Axis& axis : campaign.machine.axes) {
    if (result.machine.has_axis(axis.name)) axis.home = result.machine.axis(axis.name).home;
  }
  for (std::size_t number = 0; number < campaign.machine.tools.size(); ++number) {
    Tool& tool = campaign.machine.tools[number];
    const auto index = result.machine.tool_index(tool.name);
    if (!index) continue;
    const Eigen::Vector3d former = tool.offset, turned = result.machine.tools[*index].offset;
    const double change = (turned - former).norm();
    if (change < kSameOffset || change > most * former.norm()) continue;
    tool.offset = turned;
    for (Setup& setup : campaign.setups) {
      if (setup.tool == number) restate_readings(campaign.machine, campaign.file, former, tool.offset, setup);
    }
  }
}

}  // namespace volcal
