#pragma once
/// Priors on the amplitudes, coefficient by coefficient, of functions with `knots = "auto"` and of surfaces:
/// a shape (function_prior.h, surface_prior.h) times an amplitude, both found by evidence (evidence.h).

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/identify/solve/priors/function_prior.h"
#include "volcal/identify/solve/priors/surface_prior.h"

namespace volcal {

inline constexpr double kUsualAmplitude = 5e-6;  ///< before any reading, m or rad

/// Of a function or of a surface.
struct SmoothingTerm {
  ErrorSymbol symbol = {};                            ///< of a function
  int offset = 0;                                     ///< in the reduced vector
  std::shared_ptr<const FunctionPriors> family = {};  ///< of a function, else null
  std::size_t shape = 0;                              ///< of shapes(), that the prior is about
  double lambda = 0.0;                                ///< 1 / amplitude^2, 1/m^2 or 1/rad^2
  std::shared_ptr<const PriorShape> prior = {};
  std::shared_ptr<const SurfacePriors> surface = {};  ///< of a surface, else null

  bool is_function() const { return surface == nullptr; }
  const std::vector<std::shared_ptr<const PriorShape>>& shapes() const {
    return is_function() ? family->shapes() : surface->shapes();
  }
  const Eigen::MatrixXd& precision() const { return prior->precision; }  ///< of unit amplitude
};

/// Terms for the functions that are smoothed and for surfaces, with a wide start.
std::vector<SmoothingTerm> smoothing_terms(const MeasurementModel& model, const DatumSpace& datum);
/// A term for a surface whose coefficients stand at `offset`.
SmoothingTerm surface_term(const TensorBasis& basis, int offset);
/// Leaves to the rest of the model what it can imitate of surfaces. `data`: normal matrix of the readings,
/// `prior`: of everything but smoothing; reduced coordinates.
void leave_imitated_to_the_rest(const Eigen::MatrixXd& data, const GaussianPrior& prior,
                                std::vector<SmoothingTerm>& terms);
/// Shares of functions of the surface terms[surface] (coefficients, one column each) that the rest of the
/// model would imitate if error functions were hardly smoothed: readings do not tell them from error
/// functions that happen to be rougher than others.
Eigen::VectorXd imitated_unless_smoothed(const Eigen::MatrixXd& data, const GaussianPrior& prior,
                                         std::vector<SmoothingTerm> terms, std::size_t surface,
                                         const Eigen::MatrixXd& functions);
/// Same shapes, amplitudes within 28 %, correlation lengths within 22 %: less than evidence knows of one, and
/// nothing that the noise beside them would notice.
bool alike(const std::vector<SmoothingTerm>& terms, const std::vector<SmoothingTerm>& others);
void add_smoothing(const std::vector<SmoothingTerm>& terms, GaussianPrior& prior);

/// What not knowing the amplitudes exactly adds to the covariance of the reduced parameters z: J V J^T with J
/// = dz / dlog lambda and V the inverse Hessian of minus log evidence (Kass and Steffey 1989, JASA 84, 717;
/// Wood, Pya and Saefken 2016, JASA 111, 1548).
Eigen::MatrixXd amplitude_covariance(const std::vector<SmoothingTerm>& terms,
                                     const Eigen::MatrixXd& covariance, const Eigen::VectorXd& z);

}  // namespace volcal
