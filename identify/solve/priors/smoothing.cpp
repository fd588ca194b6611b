#include "volcal/identify/solve/priors/smoothing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/priors/basis_prior.h"

namespace volcal {
namespace {

constexpr double kSpreadOfLogLambda = 3.0;  // before any reading
constexpr double kHardlySmoothed = 1e-3;    // of lambda: thirty times the amplitude
constexpr int kStartPlace = 6;
constexpr double kSameLogLambda = 0.5;
constexpr double kSameLogLength = 0.2;

}  // namespace

std::vector<SmoothingTerm> smoothing_terms(const MeasurementModel& model, const DatumSpace& datum) {
  std::vector<SmoothingTerm> terms;
  std::map<std::pair<int, FunctionDatum>, std::shared_ptr<const FunctionPriors>> family_of;
  for (const auto& function : datum.functions()) {
    const FunctionSpec& spec = model.spec().function(function.symbol);
    const int group = model.layout().find(function.symbol)->group;
    const Basis& basis = *model.layout().groups[static_cast<std::size_t>(group)].basis;
    if (!is_smoothed(spec, basis) || function.size() == 0) continue;
    auto& family = family_of[{group, datum_of(function.symbol)}];
    if (!family) {
      const ResolvedStretch stretch =
          resolved_stretch(model.campaign(), function.symbol.axis, spec.breakpoints);
      family = std::make_shared<const FunctionPriors>(basis, stretch, function.basis);
    }
    if (family->shapes().empty()) continue;
    terms.push_back({function.symbol, function.offset, family, kStartPlace,
                     1.0 / (kUsualAmplitude * kUsualAmplitude), family->shapes()[kStartPlace]});
  }
  for (const EffectBinding& effect : model.binding().effects) {
    if (effect.effect->surface() == nullptr) continue;
    const auto own =
        std::ranges::find(datum.blocks(), effect.first_parameter, &DatumSpace::BlockCoordinates::raw_offset);
    if (own != datum.blocks().end()) terms.push_back(surface_term(*effect.effect->surface(), own->offset));
  }
  return terms;
}

SmoothingTerm surface_term(const TensorBasis& basis, int offset) {
  SmoothingTerm term;
  term.offset = offset;
  term.surface = std::make_shared<const SurfacePriors>(basis);
  term.shape = term.surface->middle();
  term.lambda = 1.0 / (kUsualAmplitude * kUsualAmplitude);
  term.prior = term.shapes()[term.shape];
  return term;
}

namespace {

/// What readings say of a surface and of everything else, which has this precision beside them.
struct SurfaceAndRest {
  Eigen::MatrixXd own, coupling, rest;
};

SurfaceAndRest apart(const Eigen::MatrixXd& data, const Eigen::MatrixXd& precision,
                     const SmoothingTerm& term) {
  const int count = static_cast<int>(term.precision().rows());
  std::vector<int> own(static_cast<std::size_t>(count)), rest;
  std::iota(own.begin(), own.end(), term.offset);
  for (int i = 0; i < data.rows(); ++i) {
    if (i < term.offset || i >= term.offset + count) rest.push_back(i);
  }
  return {data(own, own), data(rest, own), data(rest, rest) + precision(rest, rest)};
}

}  // namespace

void leave_imitated_to_the_rest(const Eigen::MatrixXd& data, const GaussianPrior& prior,
                                std::vector<SmoothingTerm>& terms) {
  for (SmoothingTerm& term : terms) {
    if (term.is_function()) continue;
    GaussianPrior total = prior;
    add_smoothing(terms, total);
    const SurfaceAndRest parts = apart(data, total.precision, term);
    const Eigen::MatrixXd imitated = imitated_coefficients(
        parts.own, parts.coupling, parts.rest, invert_precision(term.precision()).covariance / term.lambda);
    term.surface = std::make_shared<const SurfacePriors>(term.surface->without(imitated));
    term.prior = term.shapes()[term.shape];
  }
}

Eigen::VectorXd imitated_unless_smoothed(const Eigen::MatrixXd& data, const GaussianPrior& prior,
                                         std::vector<SmoothingTerm> terms, std::size_t surface,
                                         const Eigen::MatrixXd& functions) {
  for (SmoothingTerm& term : terms) {
    if (term.is_function()) term.lambda *= kHardlySmoothed;
  }
  GaussianPrior total = prior;
  add_smoothing(terms, total);
  const SurfaceAndRest parts = apart(data, total.precision, terms[surface]);
  return imitated_shares(parts.own, parts.coupling, parts.rest, functions);
}

bool alike(const std::vector<SmoothingTerm>& terms, const std::vector<SmoothingTerm>& others) {
  return std::ranges::equal(terms, others, [](const SmoothingTerm& a, const SmoothingTerm& b) {
    if (a.is_function() != b.is_function() || a.shape != b.shape) return false;
    if (std::abs(std::log(a.lambda / b.lambda)) >= kSameLogLambda) return false;
    if (!a.is_function()) return true;
    const double lengths = a.prior->correlation_length() / b.prior->correlation_length();
    return std::abs(std::log(lengths)) < kSameLogLength;
  });
}

void add_smoothing(const std::vector<SmoothingTerm>& terms, GaussianPrior& prior) {
  for (const SmoothingTerm& term : terms) {
    const Eigen::Index n = term.precision().rows();
    prior.precision.block(term.offset, term.offset, n, n) += term.lambda * term.precision();
  }
}

Eigen::MatrixXd amplitude_covariance(const std::vector<SmoothingTerm>& terms,
                                     const Eigen::MatrixXd& covariance, const Eigen::VectorXd& z) {
  const auto count = static_cast<Eigen::Index>(terms.size());
  if (count == 0) return Eigen::MatrixXd::Zero(z.size(), z.size());
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(z.size(), count);  // lambda S z
  for (Eigen::Index i = 0; i < count; ++i) {
    const SmoothingTerm& term = terms[static_cast<std::size_t>(i)];
    const Eigen::Index n = term.precision().rows();
    pull.col(i).segment(term.offset, n) = term.lambda * (term.precision() * z.segment(term.offset, n));
  }
  const Eigen::MatrixXd change = -covariance * pull;  // dz / dlog lambda
  Eigen::MatrixXd hessian = pull.transpose() * change;
  for (Eigen::Index i = 0; i < count; ++i) {
    const SmoothingTerm& a = terms[static_cast<std::size_t>(i)];
    const Eigen::Index rows = a.precision().rows();
    for (Eigen::Index j = 0; j < count; ++j) {
      const SmoothingTerm& b = terms[static_cast<std::size_t>(j)];
      const Eigen::MatrixXd cross = covariance.block(a.offset, b.offset, rows, b.precision().rows());
      hessian(i, j) -=
          0.5 * a.lambda * b.lambda * (a.precision() * cross).cwiseProduct(cross * b.precision()).sum();
    }
    const auto own = covariance.block(a.offset, a.offset, rows, rows);
    hessian(i, i) += 0.5 * (a.lambda * own.cwiseProduct(a.precision()).sum() +
                            z.segment(a.offset, rows).dot(pull.col(i).segment(a.offset, rows)));
  }
  // Where the evidence is flat or its highest point lies at a limit, the spread before any reading holds.
  const SymmetricEigen eigen = eigen_decomposition(hessian);
  const Eigen::ArrayXd information =
      eigen.values.array().max(0.0) + 1.0 / (kSpreadOfLogLambda * kSpreadOfLogLambda);
  const Eigen::MatrixXd directions = change * eigen.vectors;
  return directions * information.inverse().matrix().asDiagonal() * directions.transpose();
}

}  // namespace volcal
