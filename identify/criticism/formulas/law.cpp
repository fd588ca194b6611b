#include "volcal/identify/criticism/formulas/law.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

const std::vector<std::string> kShapeNames = {"p", "q"};

/// A unit by its base units and their powers.
using Powers = std::vector<std::pair<std::string, int>>;

void add_power(Powers& powers, const std::string& unit, int power) {
  if (unit.empty() || power == 0) return;
  const auto known = std::ranges::find(powers, unit, &Powers::value_type::first);
  if (known == powers.end()) {
    powers.emplace_back(unit, power);
  } else {
    known->second += power;
  }
}

/// Of a difference of two values: "K" of temperatures.
Powers unit_of_difference(const Variable& variable) {
  if (variable.kind == Variable::Kind::Temperature) return {{"K", 1}};
  if (variable.kind == Variable::Kind::Feed) return {{"mm", 1}, {"min", -1}};
  return {{unit_text(variable.unit().suffix), 1}};
}

std::string raised(const std::string& unit, int power) {
  return power == 1 ? unit : unit + std::to_string(power);
}

std::string unit_of_shape(const Variable& variable, bool is_span) {
  return is_span && variable.kind == Variable::Kind::Temperature ? "K" : unit_text(variable.unit().suffix);
}

/// LM of one column.
double lm_of_column(double score, double square) { return square > 0.0 ? score * score / square : 0.0; }

Eigen::VectorXd kronecker(const Eigen::VectorXd& first, const Eigen::VectorXd& second) {
  Eigen::VectorXd product(first.size() * second.size());
  for (Eigen::Index k = 0; k < first.size(); ++k)
    product.segment(k * second.size(), second.size()) = first[k] * second;
  return product;
}

}  // namespace

std::vector<double> Law::shape_of(std::size_t factor) const {
  std::size_t at = 0;
  for (std::size_t i = 0; i < factor; ++i) at += factors[i].function->shapes();
  const auto begin = shape.begin() + static_cast<std::ptrdiff_t>(at);
  return {begin, begin + static_cast<std::ptrdiff_t>(factors[factor].function->shapes())};
}

std::string Law::expression() const {
  std::vector<std::string> parts;
  std::size_t at = 0;
  for (const LawFactor& factor : factors) {
    const std::string part =
        factor.function->text({kShapeNames.begin() + static_cast<std::ptrdiff_t>(at), kShapeNames.end()});
    at += factor.function->shapes();
    if (!part.empty()) parts.push_back(part);
  }
  return fmt::format("{}", fmt::join(parts, " * "));
}

std::string Law::amplitude_unit(const std::string& of_target) const {
  Powers below;
  for (const LawFactor& factor : factors) {
    if (factor.function->power == 0) continue;
    for (const auto& [unit, power] : unit_of_difference(factor.range->variable))
      add_power(below, unit, power * factor.function->power);
  }
  std::string above = of_target, text;
  for (const auto& [unit, power] : below) {
    if (power < 0) above += " " + raised(unit, -power);
    if (power > 0) text += "/" + raised(unit, power);
  }
  return above + text;
}

std::string Law::shape_text() const {
  std::string text;
  std::size_t at = 0;
  for (const LawFactor& factor : factors) {
    for (const bool is_span : factor.function->is_span) {
      const std::string unit = unit_of_shape(factor.range->variable, is_span);
      text += fmt::format("{}{} = {:.4g}{}{}", at > 0 ? ", " : "", kShapeNames[at], shape[at],
                          unit.empty() ? "" : " ", unit);
      ++at;
    }
  }
  return text;
}

bool Law::smooth_in_shape() const {
  return std::ranges::all_of(factors,
                             [](const LawFactor& factor) { return factor.function->smooth_in_shape; });
}

bool Law::depends() const {
  return std::ranges::any_of(
      factors, [](const LawFactor& factor) { return !factor.function->text(kShapeNames).empty(); });
}

LawMeasure::LawMeasure(const TensorBasis& basis, const ProjectedColumns& surface)
    : basis_(basis), gram_(surface.gram(0, surface.count())), score_(surface.score) {
  for (std::size_t i = 0; i < basis.sides().size(); ++i) {
    const Eigen::MatrixXd samples = basis.samples(i);
    to_coefficients_.push_back(solve_positive_definite(samples.transpose() * samples, samples.transpose()));
  }
}

Eigen::VectorXd LawMeasure::along(std::size_t driver, const ElementaryFunction& function,
                                  const std::vector<double>& shape) const {
  const TensorBasis::Side& side = basis_.sides()[driver];
  Eigen::VectorXd values(to_coefficients_[driver].cols());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(values.size() - 1);
    values[i] = function.at(side.from + share * (side.to - side.from), shape);
  }
  return to_coefficients_[driver] * values;
}

double LawMeasure::lm(const Law& law) const {
  Eigen::VectorXd product = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < law.factors.size(); ++i)
    product = kronecker(product, along(i, *law.factors[i].function, law.shape_of(i)));
  return lm_of_column(product.dot(score_), product.dot(gram_ * product));
}

LawMeasure::OfDriver::OfDriver(const LawMeasure& measure, const Law& law, std::size_t driver)
    : measure_(measure), driver_(driver) {
  Eigen::VectorXd before = Eigen::VectorXd::Ones(1), after = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < law.factors.size(); ++i) {
    if (i == driver) continue;
    Eigen::VectorXd& product = i < driver ? before : after;
    product = kronecker(product, measure.along(i, *law.factors[i].function, law.shape_of(i)));
  }
  const Eigen::Index own = measure.basis_.size(driver);
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(measure.score_.size(), own);
  for (Eigen::Index b = 0; b < before.size(); ++b) {
    for (Eigen::Index m = 0; m < own; ++m)
      spread.block((b * own + m) * after.size(), m, after.size(), 1) = before[b] * after;
  }
  gram_ = spread.transpose() * (measure.gram_ * spread);
  score_ = spread.transpose() * measure.score_;
}

double LawMeasure::OfDriver::lm(const ElementaryFunction& function, const std::vector<double>& shape) const {
  const Eigen::VectorXd own = measure_.along(driver_, function, shape);
  return lm_of_column(own.dot(score_), own.dot(gram_ * own));
}

}  // namespace volcal
