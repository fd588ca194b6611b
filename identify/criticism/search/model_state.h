#pragma once
/// A fitted model with the effects that were added to it, at the noise and smoothing that its residuals then
/// have: what every test of a search is made against.
///
/// In: a linear model about a fit, effects with the shapes and amplitudes of their tests. Out: noise model,
/// projector off the model, tests. SI. Noise by restricted likelihood from all readings
/// (restricted_likelihood.h), smoothing of the error functions by evidence (smoothing.h) and tests from those
/// that are not held out. Valid near the fit: effects enter linearly, with the derivative of their shape
/// where the readings see it. Immutable and cheap to copy: a further effect gives another state.

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_tests.h"
#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {

struct SurfaceTest;

/// An effect that is in the model.
struct AddedEffect {
  FamilyTest test;                 ///< against a model with the other effects
  Eigen::MatrixXd columns;         ///< of its amplitudes, then of its shape where that is smooth
  std::vector<FamilyTest> rivals;  ///< that the readings do not tell from it, best first
};

/// A function without a formula that is in the model (kind `empirical`), its coefficients among the
/// parameters of the linear model.
struct AddedSurface {
  EffectSpec spec;  ///< without coefficients
  std::shared_ptr<const Effect> effect;
  UnknownFinding finding;     ///< that it was drawn for
  double log_evidence = 0.0;  ///< over the model before, when it was drawn
  Eigen::Index first = 0;     ///< parameter
  std::size_t term = 0;       ///< of the model's smoothing
  LinearModel before;         ///< without it

  Eigen::Index size() const { return static_cast<Eigen::Index>(effect->amplitudes().size()); }
};

/// Noise and smoothing once an effect was in the model, and how many readings were then left out.
struct ModelStep {
  NoiseEstimate noise;
  std::vector<SmoothingTerm> smoothing;
  std::size_t removed = 0;
};

class ModelState {
 public:
  /// Without any effect.
  ModelState(LinearModel model, std::shared_ptr<const SearchSetting> setting);
  /// The same at a noise that was found before, with the smoothing of `model`.
  ModelState(LinearModel model, std::shared_ptr<const SearchSetting> setting, NoiseEstimate noise);

  /// With a further effect, noise and smoothing found anew, and the readings back in use that agree with it:
  /// a fit without the effect takes what it moves most for outliers.
  ModelState with(const FamilyTest& effect) const;
  /// With the first of the added effects alone, at the noise and smoothing that were found when the last of
  /// these came in. Absent where readings have come back into use since then.
  std::optional<ModelState> with_first(std::size_t effects) const;
  /// With a further effect at the same noise and smoothing, its shape as tested: a first answer.
  ModelState with_at_this_noise(const FamilyTest& effect) const;
  /// With other residuals of the linear model at the same noise and smoothing. Throws std::logic_error where
  /// effects were added.
  ModelState with_residual(Eigen::VectorXd residual) const;
  /// The same with more effects of the user's own in the catalogue.
  ModelState with_setting(std::shared_ptr<const SearchSetting> setting) const;
  /// With a further surface and none of the effects that were added. What `beside`, effects that are to be
  /// added again, can imitate of it is theirs.
  ModelState with_surface(const SurfaceTest& surface, const std::vector<AddedEffect>& beside) const;
  /// The noise that the added effects leave, in the time of a few whitened columns (readjust_noise()).
  /// `without_effects`: off the model without them at this noise, from all readings.
  NoiseEstimate readjusted_noise(const Projector& without_effects) const;
  /// The added effects at their amplitudes and, where the readings see a shape move, at the shape that `all`
  /// finds: this model's projector from all readings.
  std::vector<FamilyTest> moved_effects(const Projector& all) const;
  /// With the shapes that the readings see move where all readings together want them beside all that was
  /// added: moved_effects() again and again. Each was found when fewer effects were in the model.
  ModelState with_settled_shapes() const;
  /// Readings that are left out and no outliers of this model.
  std::vector<std::size_t> explained_outliers() const;
  /// With tests().
  ModelState tested() const;
  ModelState with_tests(ModelTests tests) const;
  /// The same model; only tests and rivals of its effects differ.
  ModelState with_comparisons(std::vector<AddedEffect> added) const;

  const LinearModel& model() const { return model_; }
  const SearchSetting& setting() const { return *setting_; }
  const std::shared_ptr<const SearchSetting>& shared_setting() const { return setting_; }
  const std::vector<AddedEffect>& added() const { return added_; }
  bool has(std::size_t family) const;
  const std::vector<AddedSurface>& surfaces() const { return surfaces_; }
  bool has_surface(const EffectName& name) const;
  const Family& family_of(const AddedEffect& added) const { return setting_->families[added.test.family]; }
  const NoiseEstimate& noise_estimate() const { return noise_estimate_; }
  const std::vector<NoiseParameters>& noise() const { return noise_; }
  /// With intervals.
  NoiseEstimate noise_with_uncertainty() const;
  NoiseOptions noise_options() const;
  const Projector& projector() const { return *projector_; }
  bool is_tested() const { return tests_ != nullptr; }
  /// Throws std::logic_error of a state that is not tested().
  const ModelTests& tests() const;
  /// The given model, then with every effect as it was added.
  const std::vector<ModelStep>& steps() const { return steps_; }

  /// Reading minus prediction, all observations.
  Eigen::VectorXd residual() const;
  /// The linear model with the added effects, but those in `left_out`, as further columns.
  NoiseProblem problem(const std::set<std::size_t>& left_out = {}) const;
  /// Without some of the added effects, by their places.
  std::unique_ptr<Projector> projector_without(const std::set<std::size_t>& left_out) const;
  /// At the same noise and smoothing, `left_out` of the added effects.
  std::unique_ptr<Projector> projector_without_surface(const AddedSurface& surface,
                                                       const std::set<std::size_t>& left_out = {}) const;
  std::unique_ptr<Projector> projector_at(const std::vector<NoiseParameters>& noise) const;
  /// With another smoothing.
  std::unique_ptr<Projector> projector_at(const std::vector<NoiseParameters>& noise,
                                          const std::vector<SmoothingTerm>& smoothing) const;
  /// From all readings, those that are held out as well.
  std::unique_ptr<Projector> projector_of_all_readings() const;
  /// Of an added effect's amplitudes among the projector's parameters.
  Eigen::Index first_column(std::size_t added) const;

 private:
  std::unique_ptr<Projector> make_projector(const LinearModel& model, const NoiseData& data,
                                            const std::vector<NoiseParameters>& noise,
                                            const std::set<std::size_t>& left_out = {}) const;
  bool move_shapes();
  void accept_added(const std::set<std::size_t>& left_out, Projector& projector) const;
  void find_noise();
  bool refine_shape_of_last();
  bool reinstate_outliers();
  ModelStep step() const;

  std::shared_ptr<const SearchSetting> setting_;
  LinearModel model_;
  std::vector<AddedSurface> surfaces_;
  std::vector<AddedEffect> added_;
  NoiseEstimate noise_estimate_;
  std::vector<NoiseParameters> noise_;
  std::shared_ptr<const Projector> projector_;
  std::shared_ptr<const ModelTests> tests_;
  std::vector<ModelStep> steps_;
};

void append_columns(const Eigen::MatrixXd& more, Eigen::MatrixXd& all);

/// With further columns, the last, of independent amplitudes about 0; `precision` of each, 0 = free.
NoiseProblem with_columns(NoiseProblem problem, const Eigen::MatrixXd& columns,
                          const Eigen::VectorXd& precision);

/// Takes an effect into the model of `projector`: columns of its amplitudes, of those alone that stand
/// (orders of Family), and of its shape where the readings see it move.
Eigen::MatrixXd accept(const LinearModel& model, const Family& family, const FamilyTest& effect,
                       Projector& projector);

}  // namespace volcal
