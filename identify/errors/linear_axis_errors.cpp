#include "volcal/identify/errors/linear_axis_errors.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/error_field.h"
#include "volcal/model/kinematics/vector_loops.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Powers of the local coordinate lose digits where there are many: 2.5 times with each.
constexpr int kHighestDegree = 8;
constexpr std::size_t kMostBins = 4096;
constexpr std::size_t kNumbersOfVector = 4;
constexpr double kShortestPiece = 1e-9;    // m
constexpr double kHeldPiece = 0.25;        // of the travel: length of a piece beyond it; the piece goes on
constexpr int kEffectDegree = 3;           // of effects that are looked at as polynomials
constexpr double kSamePolynomial = 1e-13;  // of the largest driver

/// Errors of an axis on one piece, by power of the local coordinate: displacement and rotation.
using PieceErrors = std::vector<Vector6d>;

/// Ends of the pieces on which all functions of an axis are polynomials. Beyond what was measured, and beyond
/// the travel, there are pieces on which errors are held.
std::vector<double> pieces_of(const FitResult& result, const Axis& axis) {
  std::vector<double> ends = {axis.travel_min, axis.travel_max};
  const MeasuredTravel measured(result);
  const double first = measured[axis.name].first, last = measured[axis.name].last;
  if (std::isfinite(first)) {
    const double held_piece = kHeldPiece * axis.travel();
    ends.insert(ends.end(), {first, last, std::min(first, axis.travel_min) - held_piece,
                             std::max(last, axis.travel_max) + held_piece});
  }
  for (const FunctionGroup& group : result.layout.groups) {
    if (group.axis != axis.name) continue;
    const std::vector<double> pieces = group.basis->pieces();
    ends.insert(ends.end(), pieces.begin(), pieces.end());
  }
  std::ranges::sort(ends);
  const auto is_same = [](double one, double other) { return other - one <= kShortestPiece; };
  ends.erase(std::unique(ends.begin(), ends.end(), is_same), ends.end());
  return ends;
}

/// Highest degree of an axis' functions; none where one is no polynomial of low degree.
std::optional<int> degree_of(const ParameterLayout& layout, AxisName axis) {
  int highest = 0;
  for (const FunctionGroup& group : layout.groups) {
    if (group.axis != axis) continue;
    const std::optional<int> degree = group.basis->degree();
    if (!degree || *degree > kHighestDegree) return std::nullopt;
    highest = std::max(highest, *degree);
  }
  return highest;
}

/// Whether a piece lies beyond the measured positions, where errors are held.
bool is_held(const FitResult& result, AxisName axis, double middle) {
  const MeasuredTravel measured(result);
  return middle < measured[axis].first || middle > measured[axis].last;
}

double held_position(const FitResult& result, AxisName axis, double q) {
  return MeasuredTravel(result)[axis].nearest(q);
}

/// Taylor series about the middle of a piece; exact, since the functions are polynomials there.
PieceErrors series_of(const FitResult& result, AxisName axis, int degree, double middle, double half) {
  PieceErrors errors(static_cast<std::size_t>(degree) + 1, Vector6d::Zero());
  const int last_power = is_held(result, axis, middle) ? 0 : degree;
  const double place = held_position(result, axis, middle);
  for (const FunctionGroup& group : result.layout.groups) {
    if (group.axis != axis) continue;
    double scale = 1.0;  // half^k / k!
    for (int power = 0; power <= last_power; ++power) {
      const Eigen::VectorXd row = group.basis->row(place, power);
      for (int slot = 0; slot < group.count(); ++slot) {
        double sum = 0.0;
        for (int j = 0; j < group.basis->size(); ++j) sum += row[j] * result.parameters[group.index(j, slot)];
        const Component component = group.symbols[static_cast<std::size_t>(slot)].component;
        errors[static_cast<std::size_t>(power)][static_cast<int>(index_of(component))] += scale * sum;
      }
      scale *= half / (power + 1);
    }
  }
  return errors;
}

/// What all pieces of an axis share.
struct AxisFrame {
  const Axis& axis;
  bool workpiece_side;
  Vector3d arm;                  ///< from the reference point to the functional point with all axes at 0, m
  Vector3d location;             ///< displacement per m of travel: squareness
  std::vector<Vector3d> behind;  ///< directions of the axes behind
};

/// Displacements that the errors make, by vector and power; those of D have one power more where the arm
/// moves with the axis.
using PieceVectors = std::vector<std::vector<Vector3d>>;

PieceVectors vectors_of(const AxisFrame& frame, const PieceErrors& errors, double middle, double half) {
  const std::size_t powers = errors.size() + 1;
  PieceVectors vectors(1 + frame.behind.size(), std::vector<Vector3d>(powers, Vector3d::Zero()));
  const Vector3d own = Vector3d::Unit(direction_of(frame.axis.name));
  const Vector3d moving = frame.workpiece_side ? own : Vector3d::Zero();
  for (std::size_t power = 0; power < errors.size(); ++power) {
    const Vector3d shift = errors[power].head<3>(), rotation = errors[power].tail<3>();
    vectors[0][power] += shift + rotation.cross(frame.arm + middle * moving);
    vectors[0][power + 1] += half * rotation.cross(moving);
    for (std::size_t k = 0; k < frame.behind.size(); ++k)
      vectors[k + 1][power] = rotation.cross(frame.behind[k]);
  }
  vectors[0][0] += middle * frame.location;
  vectors[0][1] += half * frame.location;
  return vectors;
}

void append(const PieceVectors& vectors, int powers, std::vector<double>& coefficients) {
  for (auto power = static_cast<std::size_t>(powers); power-- > 0;) {
    for (const std::vector<Vector3d>& vector : vectors) {
      coefficients.insert(coefficients.end(), vector[power].begin(), vector[power].end());
      coefficients.push_back(0.0);
    }
  }
}

/// Bins no longer than the shortest piece, so that a position is found with one step at most.
void make_bins(const std::vector<double>& ends, AxisPolynomials& polynomials) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) shortest = std::min(shortest, ends[i + 1] - ends[i]);
  const double travel = ends.back() - ends.front();
  const double wanted = std::ceil(travel / shortest * (1.0 - 1e-9));
  const auto bins = static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(kMostBins)));
  polynomials.first = ends.front();
  polynomials.bins_per_m = static_cast<double>(bins) / travel;
  polynomials.last_bin = static_cast<double>(bins - 1);
  std::size_t piece = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double begin = ends.front() + travel * static_cast<double>(bin) / static_cast<double>(bins);
    while (piece + 2 < ends.size() && begin >= ends[piece + 1]) ++piece;
    polynomials.piece_of_bin.push_back(static_cast<std::int32_t>(piece));
  }
}

/// Of an axis that the machine lacks.
AxisPolynomials no_polynomials(int vectors) {
  AxisPolynomials none;
  none.vectors = vectors;
  none.piece_of_bin = {0};
  none.end = {std::numeric_limits<double>::infinity()};
  none.middle = none.per_half = {0.0};
  none.coefficients.assign(3 * static_cast<std::size_t>(vectors) * kNumbersOfVector, 0.0);
  return none;
}

/// Effects on the motions of one axis by its own position and direction, as polynomials of pieces.
class AxisEffects {
 public:
  AxisEffects(const FitResult& result, const MachineEffects& effects, const Axis& axis,
              const std::vector<double>& ends)
      : result_(result), axis_(axis.name), ends_(ends), effects_(effects.subset({})) {
    std::vector<std::size_t> kept;
    for (const std::size_t effect : effects_of_axis(effects)) {
      const std::vector<std::size_t> one = {effect};
      const bool declared = effects.is_polynomial(effect);
      (declared && is_polynomial(effects.subset(one)) ? kept : left_out_).push_back(effect);
    }
    effects_ = effects.subset(kept);
  }

  bool empty() const { return effects_.empty(); }
  const std::vector<std::size_t>& left_out() const { return left_out_; }

  /// By power of the local coordinate, kEffectDegree + 1 of them.
  PieceErrors series(double middle, double half, int direction) const {
    const std::vector<double> nodes = fit_nodes();
    const Eigen::MatrixXd drivers = drivers_at(effects_, nodes, middle, half, direction);
    const Eigen::MatrixXd powers = vandermonde(nodes).inverse() * drivers;
    PieceErrors errors(static_cast<std::size_t>(powers.rows()), Vector6d::Zero());
    for (std::size_t c = 0; c < effects_.amplitude_count(); ++c) {
      const EffectColumn& column = effects_.columns()[c];
      for (Eigen::Index power = 0; power < powers.rows(); ++power)
        errors[static_cast<std::size_t>(power)][static_cast<int>(index_of(column.target.symbol.component))] +=
            powers(power, static_cast<Eigen::Index>(c)) * result_.parameters[column.parameter];
    }
    return errors;
  }

 private:
  static std::vector<double> fit_nodes() { return {-1.0, -0.5, 0.5, 1.0}; }
  static std::vector<double> check_nodes() { return {-0.87, -0.31, 0.07, 0.77}; }

  /// Powers of the nodes.
  static Eigen::Matrix4d vandermonde(const std::vector<double>& nodes) {
    Eigen::Matrix4d matrix;
    for (int i = 0; i <= kEffectDegree; ++i) {
      double power = 1.0;
      for (int k = 0; k <= kEffectDegree; ++k, power *= nodes[static_cast<std::size_t>(i)])
        matrix(i, k) = power;
    }
    return matrix;
  }

  std::vector<std::size_t> effects_of_axis(const MachineEffects& effects) const {
    std::vector<std::size_t> numbers;
    for (const EffectColumn& column : effects.columns()) {
      const bool known = !numbers.empty() && numbers.back() == column.effect;
      if (column.shape < 0 && column.target.symbol.axis == axis_ && !known) numbers.push_back(column.effect);
    }
    return numbers;
  }

  Eigen::MatrixXd drivers_at(const MachineEffects& effects, const std::vector<double>& nodes, double middle,
                             double half, int direction) const {
    std::vector<AxisPosition> positions(nodes.size(), AxisPosition{});
    for (std::size_t i = 0; i < nodes.size(); ++i)
      positions[i][index_of(axis_)] = held_position(result_, axis_, middle + nodes[i] * half);
    ApproachDirection approach{};
    approach[index_of(axis_)] = static_cast<std::int8_t>(direction);
    return effects.drivers(positions, {&approach, 1});
  }

  bool is_polynomial(const MachineEffects& effect) const {
    const Eigen::Matrix4d to_checks = vandermonde(check_nodes()) * vandermonde(fit_nodes()).inverse();
    double largest = 0.0, deviation = 0.0;
    for (const int direction : {-1, 0, 1}) {
      for (std::size_t i = 0; i + 1 < ends_.size(); ++i) {
        const double half = 0.5 * (ends_[i + 1] - ends_[i]), middle = ends_[i] + half;
        const Eigen::MatrixXd fitted = drivers_at(effect, fit_nodes(), middle, half, direction);
        const Eigen::MatrixXd there = drivers_at(effect, check_nodes(), middle, half, direction);
        largest = std::max(largest, fitted.cwiseAbs().maxCoeff());
        deviation = std::max(deviation, (to_checks * fitted - there).cwiseAbs().maxCoeff());
      }
    }
    return deviation <= kSamePolynomial * largest;
  }

  const FitResult& result_;
  AxisName axis_;
  const std::vector<double>& ends_;
  MachineEffects effects_;
  std::vector<std::size_t> left_out_;
};

AxisPolynomials polynomials_of(const FitResult& result, const AxisFrame& frame, int degree,
                               const MachineEffects& all_effects, std::vector<std::size_t>& left_out) {
  const std::vector<double> ends = pieces_of(result, frame.axis);
  const AxisEffects effects(result, all_effects, frame.axis, ends);
  left_out.insert(left_out.end(), effects.left_out().begin(), effects.left_out().end());
  if (!effects.empty()) degree = std::max(degree, kEffectDegree);
  AxisPolynomials polynomials;
  polynomials.axis = index_of(frame.axis.name);
  polynomials.vectors = static_cast<int>(1 + frame.behind.size());
  polynomials.powers = degree + (frame.workpiece_side || degree == 0 ? 2 : 1);
  make_bins(ends, polynomials);
  for (const int direction : {-1, 0, 1}) {
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double half = 0.5 * (ends[i + 1] - ends[i]), middle = ends[i] + half;
      PieceErrors errors = series_of(result, frame.axis.name, degree, middle, half);
      if (!effects.empty()) {
        const PieceErrors added = effects.series(middle, half, direction);
        for (std::size_t power = 0; power < added.size(); ++power) errors[power] += added[power];
      }
      append(vectors_of(frame, errors, middle, half), polynomials.powers, polynomials.coefficients);
      if (direction != 0) continue;
      polynomials.end.push_back(ends[i + 1]);
      polynomials.middle.push_back(middle);
      polynomials.per_half.push_back(1.0 / half);
    }
  }
  polynomials.end.back() = std::numeric_limits<double>::infinity();
  return polynomials;
}

/// Vectors of x, y, z and a zero, in registers and as they stand in memory.
using Four = double __attribute__((vector_size(32)));
using FourInMemory = double __attribute__((vector_size(32), aligned(8), may_alias));

/// The polynomials at q, by Horner's rule, all vectors side by side.
template <int kVectors>
inline __attribute__((always_inline)) void evaluate(const AxisPolynomials& axis, double q, int direction,
                                                    Four* values) {
  const double guess = (q - axis.first) * axis.bins_per_m;
  const int bin = guess > 0.0 ? static_cast<int>(guess < axis.last_bin ? guess : axis.last_bin) : 0;
  auto piece = static_cast<std::size_t>(axis.piece_of_bin[static_cast<std::size_t>(bin)]);
  while (q >= axis.end[piece]) ++piece;
  const double t = (q - axis.middle[piece]) * axis.per_half[piece];
  const Four factor = {t, t, t, t};
  const std::size_t side = direction > 0 ? 2 : direction < 0 ? 0 : 1;
  const std::size_t numbers = static_cast<std::size_t>(axis.powers) * kVectors * kNumbersOfVector;
  const double* const at = axis.coefficients.data() + (side * axis.end.size() + piece) * numbers;
  const auto* coefficient = reinterpret_cast<const FourInMemory*>(at);
  for (int v = 0; v < kVectors; ++v) values[v] = coefficient[v];
  for (int power = 1; power < axis.powers; ++power) {
    coefficient += kVectors;
    for (int v = 0; v < kVectors; ++v) values[v] = values[v] * factor + coefficient[v];
  }
}

/// `direction_step`: 1, or 0 where one direction is meant for all.
VOLCAL_VECTOR_LOOPS void sum_errors(const AxisPolynomials* axes, std::size_t count,
                                    const AxisPosition* positions, const ApproachDirection* directions,
                                    std::size_t direction_step, Vector3d* errors) {
  const std::size_t a = axes[0].axis, b = axes[1].axis, c = axes[2].axis;
  for (std::size_t i = 0; i < count; ++i, directions += direction_step) {
    const AxisPosition& position = positions[i];
    const ApproachDirection& direction = *directions;
    Four of_a[3], of_b[2], of_c[1];
    evaluate<3>(axes[0], position[a], direction[a], of_a);
    evaluate<2>(axes[1], position[b], direction[b], of_b);
    evaluate<1>(axes[2], position[c], direction[c], of_c);
    const double q = position[b], p = position[c];
    const Four along_b = {q, q, q, q}, along_c = {p, p, p, p};
    const Four sum = of_a[0] + of_b[0] + of_c[0] + along_b * of_a[1] + along_c * (of_a[2] + of_b[1]);
    double* const to = errors[i].data();
    to[0] = sum[0];
    to[1] = sum[1];
    to[2] = sum[2];
  }
}

}  // namespace

std::optional<LinearAxisErrors> LinearAxisErrors::make(const FitResult& result, const Vector3d& tool_offset,
                                                       const MachineEffects& effects) {
  const Machine& machine = result.machine;
  const PoseErrors<double> at_zero = pose_errors(result.layout, {}, result.parameters);
  LinearAxisErrors made;
  std::vector<Vector3d> behind;
  std::size_t place = made.axes_.size();
  for (auto joint = machine.structure.joints.rbegin(); joint != machine.structure.joints.rend(); ++joint) {
    if (is_rotary(joint->axis)) continue;
    const Axis& axis = machine.axis(joint->axis);
    const std::optional<int> degree = degree_of(result.layout, joint->axis);
    if (!degree || place == 0 || !(axis.travel() > 0.0)) return std::nullopt;
    const Vector3d own = Vector3d::Unit(direction_of(joint->axis));
    const auto& location = at_zero.location[index_of(joint->axis)];
    const Vector3d orientation(location[3], location[4], location[5]);
    const AxisFrame frame{axis, joint->workpiece_side, tool_offset - axis.reference_point,
                          orientation.cross(own), behind};
    made.axes_[--place] = polynomials_of(result, frame, *degree, effects, made.effects_left_out_);
    behind.insert(behind.begin(), own);
  }
  // An axis that is lacking stands before the others: the vectors for those behind it are zeros.
  while (place-- > 0) made.axes_[place] = no_polynomials(static_cast<int>(made.axes_.size() - place));
  return made;
}

Vector3d LinearAxisErrors::at(const AxisPosition& position, const ApproachDirection& direction) const {
  Vector3d error;
  sum_errors(axes_.data(), 1, &position, &direction, 0, &error);
  return error;
}

void LinearAxisErrors::at(std::span<const AxisPosition> positions,
                          std::span<const ApproachDirection> directions, std::span<Vector3d> errors) const {
  if (errors.size() != positions.size() || (directions.size() != positions.size() && directions.size() != 1))
    throw std::invalid_argument("as many errors as positions are needed, and one direction or as many");
  sum_errors(axes_.data(), positions.size(), positions.data(), directions.data(),
             directions.size() == 1 ? 0 : 1, errors.data());
}

}  // namespace volcal
