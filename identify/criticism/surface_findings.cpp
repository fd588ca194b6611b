#include "volcal/identify/criticism/surface_findings.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "volcal/identify/criticism/formulas/formula_search.h"
#include "volcal/identify/result/largest_value.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/functions/drawn_places.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

constexpr double kFreeShare = 0.95;  // of what readings see of a function, imitated
constexpr int kPowers = 3;
constexpr std::size_t kMostDots = 1500;

/// Coefficients of a power of one variable, constant along the others.
Eigen::VectorXd coefficients_of_power(const TensorBasis& basis, std::size_t variable, int power) {
  Eigen::VectorXd product = Eigen::VectorXd::Ones(1);
  for (std::size_t side = 0; side < basis.sides().size(); ++side) {
    const Eigen::VectorXd own = side == variable
                                    ? Eigen::VectorXd(basis.nodes(side).array().pow(power).matrix())
                                    : Eigen::VectorXd(Eigen::VectorXd::Ones(basis.size(side)));
    Eigen::VectorXd next(product.size() * own.size());
    for (Eigen::Index k = 0; k < product.size(); ++k)
      next.segment(k * own.size(), own.size()) = product[k] * own;
    product = std::move(next);
  }
  return product;
}

/// Powers 0, 1 and 2 of every variable: of the functions of one variable alone those that look least alike.
Eigen::MatrixXd powers_of_variables(const TensorBasis& basis) {
  const auto variables = static_cast<Eigen::Index>(basis.sides().size());
  Eigen::MatrixXd powers(basis.size(), variables * kPowers);
  for (Eigen::Index i = 0; i < variables; ++i) {
    for (int power = 0; power < kPowers; ++power)
      powers.col(i * kPowers + power) = coefficients_of_power(basis, static_cast<std::size_t>(i), power);
  }
  return powers;
}

/// What the readings do not tell from the rest of the model, in words. `imitated`: shares of the powers.
std::vector<std::string> free_parts(const Eigen::VectorXd& imitated, const std::vector<Variable>& drivers) {
  const auto is_free = [&](std::size_t variable, int power) {
    return imitated[static_cast<Eigen::Index>(variable) * kPowers + power] > kFreeShare;
  };
  std::vector<std::string> words;
  for (std::size_t i = 0; i < drivers.size(); ++i) {
    if (is_free(i, 1) && is_free(i, 2)) {
      const bool is_position = drivers[i].kind == Variable::Kind::Position;
      words.push_back(fmt::format("any function of {} alone: the {} it", drivers[i].written(),
                                  is_position ? "error functions hold" : "rest of the model holds"));
    } else if (is_free(i, 1)) {
      words.push_back(
          fmt::format("what is straight in {}: the rest of the model holds it", drivers[i].written()));
    }
  }
  if (words.empty() && is_free(0, 0)) words.emplace_back("a constant: the rest of the model holds it");
  return words;
}

class SurfaceSummary {
 public:
  SurfaceSummary(const ModelState& state, const AddedSurface& surface, const Projector& projector)
      : state_(state),
        surface_(surface),
        projector_(projector),
        basis_(*surface.effect->surface()),
        coefficients_(projector.solution().segment(surface.first, surface.size())) {
    const EffectAmplitude& amplitude = surface.effect->amplitudes().front();
    out_.name = surface.effect->name();
    out_.label = effect_label(*surface.effect);
    out_.spec = surface.spec;
    out_.unit = amplitude.unit();
    out_.si_per_unit = amplitude.si_per_unit();
    out_.log_evidence = surface.log_evidence;
    out_.drivers = variables_in(*surface.spec.options.text("drivers"));
  }

  SurfaceFinding run() {
    for (std::size_t k = 0; k < surface_.effect->amplitudes().size(); ++k)
      surface_.effect->amplitudes()[k].keep(coefficients_[static_cast<Eigen::Index>(k)], out_.spec.options);
    find_rms();
    const SmoothingTerm& term = state_.model().smoothing()[surface_.term];
    out_.figure.coefficients = coefficients_;
    out_.figure.covariance = covariance_of_coefficients();
    find_largest();
    out_.effective_parameters =
        term.prior->rank - term.lambda * out_.figure.covariance.cwiseProduct(term.precision()).sum();
    if (!surface_.spec.options.text("factor")) {
      const Eigen::VectorXd imitated = state_.model().imitated_unless_smoothed(
          projector_.gram(), surface_.term, powers_of_variables(basis_));
      out_.free = free_parts(imitated, out_.drivers);
    }
    draw();
    return std::move(out_);
  }

 private:
  /// Derivatives of values to all parameters.
  Eigen::MatrixXd all_rows(const Eigen::MatrixXd& own) const {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(own.rows(), projector_.parameters());
    rows.middleCols(surface_.first, own.cols()) = own;
    return rows;
  }

  Eigen::MatrixXd covariance_of_coefficients() const {
    const Eigen::MatrixXd rotated =
        projector_.rotated_rows(all_rows(Eigen::MatrixXd::Identity(surface_.size(), surface_.size())));
    return rotated.transpose() * rotated;
  }

  Eigen::VectorXd uncertainty(const Eigen::MatrixXd& own) const {
    return projector_.prediction_variance(all_rows(own)).cwiseMax(0.0).cwiseSqrt();
  }

  /// Over the readings on which it acts.
  void find_rms() {
    double squares = 0.0;
    std::size_t count = 0;
    for (const SetupView& view : state_.model().views()) {
      const Eigen::MatrixXd rows = surface_.effect->drivers(view, surface_.effect->shape_values());
      if (rows.isZero(0.0)) continue;
      std::vector<Eigen::VectorXd> drivers;
      for (const Variable& driver : out_.drivers) drivers.push_back(*recorded_variable(view, driver));
      for (Eigen::Index row = 0; row < rows.rows(); ++row) {
        if (rows.row(row).isZero(0.0)) continue;
        const double value = rows.row(row).dot(coefficients_);
        squares += value * value;
        ++count;
        keep_dot(drivers, row);
      }
    }
    if (count > 0) out_.rms = std::sqrt(squares / static_cast<double>(count));
  }

  void find_largest() {
    LargestValue largest = largest_value(basis_, coefficients_, out_.figure.covariance);
    out_.largest = largest.value;
    out_.largest_u = largest.u;
    out_.at = std::move(largest.at);
  }

  void keep_dot(const std::vector<Eigen::VectorXd>& drivers, Eigen::Index row) {
    if (++seen_ % stride() != 0) return;
    out_.figure.dots.resize(std::min<std::size_t>(2, drivers.size()));
    for (std::size_t i = 0; i < out_.figure.dots.size(); ++i) out_.figure.dots[i].push_back(drivers[i][row]);
  }

  std::size_t stride() const { return 1 + state_.model().size() / kMostDots; }

  /// Over the range of the first two drivers, a third in the middle of its range; a factor is 1.
  void draw() {
    DrawnPlaces drawn = drawn_places(basis_);
    out_.figure.value = drawn.rows * coefficients_;
    out_.figure.u = uncertainty(drawn.rows);
    out_.figure.places = std::move(drawn.axes);
    if (basis_.sides().size() > 2) out_.figure.third = drawn.third;
  }

  const ModelState& state_;
  const AddedSurface& surface_;
  const Projector& projector_;
  const TensorBasis& basis_;
  Eigen::VectorXd coefficients_;
  SurfaceFinding out_;
  std::size_t seen_ = 0;
};

}  // namespace

std::vector<SurfaceFinding> surface_findings(const ModelState& reached) {
  std::vector<SurfaceFinding> findings;
  if (reached.surfaces().empty()) return findings;
  const auto projector = reached.projector_of_all_readings();
  for (std::size_t i = 0; i < reached.surfaces().size(); ++i) {
    findings.push_back(SurfaceSummary(reached, reached.surfaces()[i], *projector).run());
    findings.back().formulas = formulas_for(reached, i);
  }
  return findings;
}

}  // namespace volcal
