#pragma once
/// What stands behind the models of a session's tree. Of a full fit stays what it found; the linear model
/// about it, some hundred bytes a reading and parameter, is let go of and made again, to the bit.

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/criticism/search/model_tests.h"
#include "volcal/identify/session/session.h"

namespace volcal {

/// A model by a full fit, and what tests stand on. For several threads at once.
class Session::Fitted {
 public:
  Fitted(std::shared_ptr<const Campaign> campaign, FitResult result, ModelState state);

  const std::shared_ptr<const Campaign>& campaign() const { return campaign_; }
  const FitResult& result() const { return result_; }
  double noise_variance() const { return noise_variance_; }  ///< mean over the readings in use
  /// Per observation; infinite: left out.
  const std::vector<double>& variance() const { return variance_; }
  const std::vector<NoiseParameters>& noise() const { return noise_; }
  const std::vector<SmoothingTerm>& smoothing() const { return smoothing_; }
  const std::shared_ptr<const SearchSetting>& setting() const { return setting_; }
  /// As it was, kept from here on.
  ModelState state() const;
  /// Off its model, from all readings, those that are held out as well.
  std::shared_ptr<const Projector> projector_of_all_readings() const;
  /// Effects of the model as this fit found them, at the noise that it leaves.
  EffectFinding fitted(const EffectFinding& added) const;
  void let_go() const;
  bool is_kept() const;

 private:
  void find_values();

  std::shared_ptr<const Campaign> campaign_;
  FitResult result_;
  std::shared_ptr<const SearchSetting> setting_;
  NoiseEstimate noise_estimate_;
  std::vector<NoiseParameters> noise_;
  std::vector<SmoothingTerm> smoothing_;
  std::vector<double> variance_;
  double noise_variance_;
  Eigen::VectorXd values_;  ///< of all parameters, SI
  mutable std::mutex mutex_;
  mutable std::optional<ModelState> kept_;
  mutable std::shared_ptr<const Projector> all_readings_;
};

/// What a refit has found besides amplitudes and shapes of effects.
struct Session::Refit {
  NoiseEstimate noise;
  std::vector<SmoothingTerm> smoothing;
  std::vector<double> variance;         ///< of every reading
  Eigen::VectorXd residual;             ///< of the linear model; empty: as it was
  std::vector<std::size_t> reinstated;  ///< readings that are no outliers of this model
};

/// How a model is made: of a full fit, and effects that were added since.
struct Session::Recipe {
  std::shared_ptr<const Fitted> base;
  std::shared_ptr<const SearchSetting> setting;
  std::vector<FamilyTest> added;
  std::shared_ptr<const Refit> refit = nullptr;  ///< none: noise of the full fit

  ModelState make() const;
  ModelState without_effects() const;
  /// At the noise and with the readings of the refit, residuals as those of the fit. Only of a refit.
  ModelState with_residuals_of_fit() const;
  ModelState with_effects(ModelState state) const;
  /// From all readings, off the model without the effects that were added.
  std::shared_ptr<const Projector> projector_without_effects() const;
  /// From readings that are not held out, at the noise of a fit and the smoothing of the model's own, off
  /// this model, which is `state`.
  std::shared_ptr<const Projector> projector_at(const Fitted& least, const ModelState& state) const;
  /// Of every reading by the model's noise; infinite: left out.
  const std::vector<double>& variance() const { return refit ? refit->variance : base->variance(); }
  std::vector<std::size_t> reinstated() const {
    return refit ? refit->reinstated : std::vector<std::size_t>{};
  }
};

/// A refit with what was made on the way.
struct Session::RefittedModel {
  Recipe recipe;
  ModelState state;
  std::shared_ptr<const Projector> all_readings;
  std::shared_ptr<SharedTests> tests = nullptr;
  /// At the noise of that fit, from readings that are not held out.
  std::shared_ptr<const Projector> at_least = nullptr;
  std::shared_ptr<const Fitted> least = nullptr;
};

/// The refit of a model, in further steps while its noise changes much, made once, by whoever asks first. Who
/// makes it may be stopped: the next one begins anew.
class Session::SharedRefit {
 public:
  /// `least`: that the figures of the session's models are against.
  SharedRefit(Recipe preview, ModelState state, std::shared_ptr<const Fitted> least)
      : preview_(std::move(preview)), state_(std::move(state)), least_(std::move(least)) {}
  /// Throws SessionStopped.
  const RefittedModel& get(const SessionProgress& progress);

 private:
  std::mutex mutex_;
  Recipe preview_;
  ModelState state_;
  std::shared_ptr<const Fitted> least_;
  std::optional<RefittedModel> made_;
};

/// What the figures of a full fit's model stand on, against the noise of `least`. Those of refits are at the
/// smoothing of the full fit as well.
struct Session::FiguresOfModel {
  std::shared_ptr<const Fitted> base, least;
  std::vector<std::size_t> reinstated;  ///< readings that are in use against the fit
  KeptFigures figures;

  bool is_of(const Recipe& recipe, const std::shared_ptr<const Fitted>& against) const;
  /// Makes them.
  static std::shared_ptr<const FiguresOfModel> of(const Recipe& recipe,
                                                  const std::shared_ptr<const Fitted>& against);
};

/// Tests of a model, made once by whoever asks first, in whichever thread; others wait for them.
class Session::SharedTests {
 public:
  using Make = std::function<CatalogueTests()>;
  explicit SharedTests(Make make) : make_(std::move(make)) {}
  explicit SharedTests(CatalogueTests made) : made_(std::move(made)) {}
  const CatalogueTests& get();
  /// Stopped as other work is; the next one begins anew.
  const CatalogueTests& get_unless_stopped();

 private:
  std::mutex mutex_;
  Make make_;
  std::optional<CatalogueTests> made_;
};

/// What stands behind a model of the tree.
struct Session::Node {
  Recipe recipe;
  std::vector<EffectFinding> effects;  ///< of the given model, then those that were added
  std::shared_ptr<SharedTests> tests;
  std::optional<std::vector<EffectFinding>> ranking;
  std::map<EffectName, Explanation> why_not_visible;   ///< as far as it was asked for
  std::optional<ModelState> scanned;                   ///< the state with all tests, once asked for
  std::optional<std::vector<UnknownFinding>> unknown;  ///< of that
  bool unknown_leads = false;
  std::vector<MeasurementProposal> proposals;
  std::vector<SurfaceFinding> drawn;                ///< for some of these
  std::map<EffectName, Eigen::VectorXd> previewed;  ///< residuals with an effect in the model
  /// Models with a further effect that are ready to be added.
  std::map<EffectName, std::shared_ptr<const Node>> prepared;
  bool is_prepared = false;  ///< their refits and the tests behind these are made
  std::optional<Eigen::VectorXd> residual;
  /// At the least noise of a full fit, from readings that are not held out; and that fit.
  std::shared_ptr<const Projector> at_least;
  std::shared_ptr<const Fitted> least;
  mutable std::shared_ptr<const Projector> all_readings;  ///< the same from all readings at the model's noise

  Node(std::shared_ptr<const Fitted> fitted, std::vector<EffectFinding> added);
  /// With another recipe.
  void becomes(Recipe other);
  void becomes(RefittedModel refitted);
  /// With a further effect, whose test was found here.
  Node with(const FamilyTest& test, EffectFinding finding) const;
  /// With more effects of the user's own in the catalogue.
  void with_setting(std::shared_ptr<const SearchSetting> setting);
  void forget_prepared();
  const ModelState& state() const;
  const std::shared_ptr<SharedRefit>& shared_refit(const std::shared_ptr<const Fitted>& least_noise) const;
  std::shared_ptr<const Projector> of_all_readings() const;
  /// What can be made again.
  void let_go();
  std::size_t in_base() const { return effects.size() - recipe.added.size(); }

 private:
  mutable std::optional<ModelState> state_;
  mutable std::shared_ptr<SharedRefit> refit_;
};

/// A fit, and where its noise is the least so far the figures of the models before against that noise: of
/// those of the same readings.
struct Session::FittedModel {
  std::shared_ptr<const Fitted> fitted;
  std::vector<std::optional<LadderStep>> figures;
};

/// What full fits need, apart from the session.
struct Session::Fitting {
  SessionOptions options;
  std::vector<EffectSpec> own;
  std::vector<Recipe> before;  ///< models of the tree
  double least_variance;       ///< of those of the same readings

  std::vector<std::optional<LadderStep>> figures_at(const Fitted& least) const;
  FittedModel operator()(const std::shared_ptr<const Campaign>& campaign, const ModelSpec& model,
                         const SessionProgress& progress) const;
};

}  // namespace volcal
