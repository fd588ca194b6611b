#pragma once
/// A plan as a linear problem, small enough to be solved thousands of times: what its readings say of the
/// machine, and how well the target is then known.
///
/// Readings are linearised on the nominal machine. Unknown are the error functions (with automatic knots:
/// eight cubic pieces and the Gaussian-process prior of the fit, solve/priors/function_prior.h, with the
/// roughness that is assumed; else as the model says), squareness, the model's effects, and everything that
/// the setups bring along: stations, dead paths, a tracker's orientation, uncertain tool offsets. Noise is
/// independent, as stated. What nothing is known of has the wide priors of solve/rank.h, so that an error
/// that is not visible counts as 1 mm or 1 mrad and is made visible before anything else.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/planning/design_criterion.h"
#include "volcal/identify/planning/exchange_design.h"
#include "volcal/identify/planning/plan_layout.h"
#include "volcal/identify/planning/plan_settings.h"
#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/identify/solve/priors/smoothing.h"

namespace volcal {

/// Terms of a model's smoothed functions with the roughness that is assumed.
std::vector<SmoothingTerm> assumed_smoothing(const MeasurementModel& model, const DatumSpace& datum,
                                             const FunctionRoughnessGuess& guess);

class PlanProblem {
 public:
  /// Throws InputError where the model does not fit the machine or the target is not in the model. The
  /// settings must outlive the object.
  explicit PlanProblem(const PlanSettings& settings);

  const DesignCriterion& criterion() const { return *criterion_; }
  /// Of the criterion with `readings` in place of those of the layout, evenly: the mean or largest variance,
  /// m^2, rad^2 or of an effect. 0 readings: as many as the layout has.
  double value(const PlanLayout& layout, std::size_t readings = 0) const;

  /// Positions of a layout as candidates of an exchange, both directions of each together, and what is known
  /// without them.
  struct Pool {
    DesignPool pool;
    Eigen::MatrixXd base;
  };
  Pool pool_of(const PlanLayout& layout) const;

 private:
  struct Linearised;

  ModelSpec search_model() const;
  void learn_machine();
  void learn_existing();
  /// Calls use(position, tool) at every pose of the volume.
  template <class Use>
  void for_each_volume_pose(const Use& use) const;
  Eigen::MatrixXd volume_functionals(const Linearised& at) const;
  Eigen::MatrixXd table_functionals(const Linearised& at) const;
  Eigen::MatrixXd symbol_functionals(const Linearised& at, const MachineError& error) const;
  Eigen::MatrixXd effect_functionals(const Linearised& at) const;
  Eigen::MatrixXd known(const Linearised& at) const;
  Campaign campaign_with_existing(const PlanLayout& layout) const;

  const PlanSettings& settings_;
  ModelSpec model_;
  bool both_directions_ = false;       ///< matter to the target: an effect depends on them
  Eigen::Index machine_size_ = 0;      ///< reduced parameters that do not come from setups; they lead
  Eigen::MatrixXd machine_precision_;  ///< of them, without readings
  std::unique_ptr<DesignCriterion> criterion_;
  Campaign thin_;                            ///< existing setups with few readings: their unknowns
  std::vector<std::string> existing_names_;  ///< of reduced parameters behind the machine's
  Eigen::MatrixXd existing_;                 ///< information of the existing readings
};

}  // namespace volcal
