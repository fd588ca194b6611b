#pragma once
/// A campaign under somebody's hands: look, try, add, watch the error fall.
///
/// A session holds a campaign, the model that was fitted to it, and a tree of models that came of it by
/// adding and removing effects. A step is first a linear preview: the fitted model's derivatives, with noise
/// and smoothing of its last full fit, in tens of milliseconds. A refit lets the noise give back what it took
/// for drift or offsets of lines and finds smoothing anew, and takes along what is not linear; resolution and
/// derivatives are kept. The full fit finds all anew and says whether what stood before held. No step is
/// lost: undo, redo and go_to() move between models, and further steps from an earlier one are another
/// branch. Lines that judge are chosen before the first step and choose nothing; what a person tries counts
/// as a test, like those of the catalogue.
///
///   Session session(campaign, model, {});
///   session.rank();                                   // effects of the catalogue, best first
///   session.add({"reversal", "EXX", "dir_x", "step"});
///   session.current().figures.systematic;             // on lines that did not choose, m
///   session.take(session.confirmation());
///   session.model();                                  // for a model file
///
/// Numbers of models by a full fit are those of diagnose() to the bit: both stand on identify/criticism.
/// Those of a preview follow from the products of the model before (catalogue/family_products.h). Amplitudes
/// are from all readings, at the noise that the model leaves; tests and the ladder from those that are not
/// held out. SI. Not for several threads at once, but for SessionWork; results do not depend on the number of
/// threads that work inside.

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// False: stop. A step that is stopped leaves the session as it was.
using SessionProgress = std::function<bool(const std::string& stage, double done)>;

struct SessionStopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SessionOptions {
  int threads = 0;  ///< 0 = as many as the machine has
  double heldout_share = 0.1;
  SessionProgress progress;
};

class KeptFigures;
class Session;
struct SessionModel;

/// What work that takes long has found, put into the session that it is of.
using SessionChange = std::function<void(Session&)>;
/// Work apart from the session: it may run in another thread while the session is used. Throws
/// SessionStopped, InputError.
using SessionWork = std::function<SessionChange(const SessionProgress&)>;

/// Throws SessionStopped, InputError.
using DiagnosisWork = std::function<DiagnosedModel(const SessionProgress&)>;

enum class ModelStanding {
  Fitted,       ///< by a full fit
  Preview,      ///< linear, at the noise of the last full fit or refit
  Refitted,     ///< noise and smoothing found again, functions and derivatives of the last full fit
  Contradicted  ///< by a full fit, which differs from the preview or refit by more than U95/4
};

/// Not yet by a full fit.
inline bool awaits_full_fit(ModelStanding standing) {
  return standing == ModelStanding::Preview || standing == ModelStanding::Refitted;
}

/// How far an amplitude of a preview, or of the refit that followed it, was off.
struct Contradiction {
  ModelStanding of = ModelStanding::Preview;
  std::string label;
  double previewed = 0.0;  ///< SI
  double fitted = 0.0;
  double u = 0.0;  ///< of the full fit
  std::string unit;
  double si_per_unit = 1.0;
};

/// One model of the tree.
struct SessionModel {
  std::size_t number = 0;
  std::optional<std::size_t> parent;  ///< none: as given
  std::string change;                 ///< "+ reversal EXX", "- ECX by z"; empty for the first
  ModelStanding standing = ModelStanding::Fitted;
  std::optional<Contradiction> contradiction = {};
  /// On fitted and on held-out readings, against the least noise of a full fit of the same readings so far.
  LadderStep figures = {};
  /// With their amplitudes in this model: those of the given model that it has, then those that were added.
  std::vector<EffectFinding> effects = {};
};

/// What an effect would be if it were added to the current model.
struct EffectPreview {
  EffectFinding effect;      ///< amplitude, U, MDB, p with all tests counted
  Eigen::VectorXd residual;  ///< then, of all observations, m or rad; the rest of the model adjusted to it
  double rms_heldout = 0.0;  ///< then, SI; NaN without held-out readings
};

/// The leading effects beside each other.
struct Rivalry {
  std::vector<EffectName> names;
  Eigen::MatrixXd cosine;  ///< of what they explain, projected off the model; 0..1
};

/// Residuals of some readings at the current model.
struct SelectionSummary {
  std::size_t readings = 0;
  double mean = 0.0;            ///< m or rad
  double u = 0.0;               ///< of the mean, from the noise of each reading as if independent
  double share_positive = 0.0;  ///< 0..1
};

class Session {
 public:
  /// Fits the model. Throws InputError as fit() does, SessionStopped.
  Session(Campaign campaign, ModelSpec model, SessionOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Of the current model: with the readings that were left out.
  const Campaign& campaign() const;
  /// All models, in the order in which they were made.
  const std::vector<SessionModel>& models() const;
  const SessionModel& current() const;
  bool can_undo() const { return !visited_.empty() || current().parent.has_value(); }
  bool can_redo() const { return !undone_.empty(); }
  /// Observations of the linear model: setup, row, channel order.
  const LinearModel& linear() const;
  /// Observations that judge and never choose.
  const std::vector<bool>& heldout() const;
  /// Effects that the user thought of so far.
  std::size_t tried() const { return own_.size(); }
  /// Reading minus prediction of a model, m or rad. Throws std::out_of_range.
  const Eigen::VectorXd& residual(std::size_t model) const;
  const Eigen::VectorXd& residual() const { return residual(current_); }
  /// Standard uncertainty of every reading by the noise of a model, m or rad; infinite: left out.
  Eigen::VectorXd sigma(std::size_t model) const;
  /// The full fit that the current model stands on.
  const FitResult& fitted_result() const;
  /// Full fits of which the linear model is in memory: those of the last models that were looked at, at most
  /// kKeptFits. Others are made again, to the bit, when they are looked at.
  std::size_t kept_fits() const;
  static constexpr std::size_t kKeptFits = 3;

  /// Effects that are not in the current model, best first; with more of an error function, which cannot be
  /// added here.
  const std::vector<EffectFinding>& rank();
  /// Makes the tests of all effects at the current model, on which rank(), preview(), formula() and add()
  /// stand and which they make where they are not there: it may run in another thread while the session is
  /// used.
  std::function<void()> testing();
  /// Effects of which nothing shows.
  std::vector<EffectFinding> not_visible();
  /// Why the readings do not tell these effects of the current model from it, and what to measure. Throws
  /// std::invalid_argument where there is no such effect.
  std::vector<Explanation> why_not_visible(const std::vector<EffectFinding>& effects);
  /// Of the first of the ranking, at most `most`.
  Rivalry rivals(std::size_t most);
  /// The scans of the current model without a catalogue and what to measure next, which unknown() and
  /// next_measurements() make where they are not there.
  SessionWork scan();
  bool is_scanned() const;
  /// What moves the residuals of the current model without a name, leading first.
  const std::vector<UnknownFinding>& unknown();
  /// Something without a name explains the residuals better than the leading effect.
  bool unknown_leads();
  /// What to measure next, by the current model (proposed_measurements.h).
  const std::vector<MeasurementProposal>& next_measurements();
  EffectPreview preview(const EffectName& effect);
  /// What an effect would move the readings by per unit of its amplitude, added up over its amplitudes.
  Eigen::VectorXd driver(const EffectName& effect);
  /// An effect of the kind `custom` as the user writes it, tested beside the catalogue; from here on it can
  /// be added by its name, which is that of the last one of this name. Throws InputError where it cannot be
  /// read, cannot act or is in the model: it is then forgotten.
  EffectPreview formula(const EffectSpec& custom);
  /// Marked observations.
  SelectionSummary summary(const std::vector<bool>& selected) const;

  /// A linear preview with a further effect becomes the current model. Throws std::invalid_argument where
  /// there is no such effect, InputError where the readings do not tell it from the model.
  const SessionModel& add(const EffectName& effect);
  /// Whether an effect is of the model that the session began with.
  bool was_given(const EffectName& effect) const;
  /// Whether an effect was added since the last full fit: it can be removed at once.
  bool is_preview(const EffectName& effect) const;
  /// A linear preview without it. Throws std::invalid_argument where it is_preview() not.
  const SessionModel& remove_preview(const EffectName& effect);

  /// A full fit without an effect of the current model. Throws std::invalid_argument where there is no such
  /// effect.
  SessionWork removal(const EffectName& effect) const;
  /// A linear preview with its noise and smoothing found again, shapes of its effects moved to where readings
  /// want them, and residuals of the exact model; 0.25 s of processor time at 6,720 readings. Nothing changes
  /// where it has been refitted or fitted. Throws std::out_of_range.
  SessionWork refit(std::size_t model) const;
  SessionWork refit() const { return refit(current_); }
  /// Makes refits of the current model with each of the effects that lead its ranking, and the tests behind
  /// them, before anybody asks: refit() and rank() then take what is there. Kept until another model is the
  /// current one. Not beside other work of the session: who asks for what is being made waits for it, and it
  /// asks `progress` meanwhile.
  SessionWork preparation();
  /// Of the current model.
  bool is_prepared() const;
  /// A model of the tree by a full fit, noise and smoothing anew; nothing changes where it is one already.
  /// Throws std::out_of_range.
  SessionWork confirmation(std::size_t model) const;
  SessionWork confirmation() const { return confirmation(current_); }
  /// A surface or curve for an unknown finding of the current model, kept in drawn(). Throws
  /// std::out_of_range.
  SessionWork drawing(std::size_t unknown);
  /// What was drawn for the current model.
  const std::vector<SurfaceFinding>& drawn() const;
  /// A full fit with a surface that was drawn. Throws std::invalid_argument where there is no such surface.
  SessionWork surface(const EffectName& name) const;
  /// A full fit without these observations: another campaign. Throws std::invalid_argument where none are
  /// marked, InputError where no more remain than the model has parameters that readings determine.
  SessionWork leaving_out(const std::vector<bool>& selected, const std::string& reason) const;
  /// What a diagnosis says of the current model: by the full fit that is there, or by one that is made for
  /// it. `options`: its threads, share of held-out lines and progress are the session's.
  DiagnosisWork diagnosis(DiagnoseOptions options) const;
  /// The search of a diagnosis from the current model to its end; every effect is a further model by a full
  /// fit.
  SessionWork climb() const;
  /// Runs the work here and takes what it found.
  const SessionModel& take(const SessionWork& work, const SessionProgress& progress = {});

  /// To the model before, after go_to() the one that was left, and back. False: there is none.
  bool undo();
  bool redo();
  /// Throws std::out_of_range.
  const SessionModel& go_to(std::size_t number);

  /// The given model with the effects of the current one.
  ModelSpec model() const;

 private:
  class Fitted;
  class SharedTests;
  class SharedRefit;
  struct Recipe;
  struct Refit;
  struct RefittedModel;
  struct Node;
  struct Fitting;
  struct FittedModel;
  struct FiguresOfModel;

  Fitting fitting(const std::shared_ptr<const Campaign>& campaign) const;
  static RefittedModel refitted(const Recipe& preview, const ModelState& state,
                                const SessionProgress& progress);
  const std::shared_ptr<const Fitted>& least_of(const Recipe& recipe) const;
  void put_in_place(const FittedModel& fitted);
  static void set_figures(LadderStep figures, SessionModel& shown);
  Node& node() const { return *nodes_[current_]; }
  void go(std::size_t number);
  void renew_setting();
  void require_drivers(const EffectSpec& custom, const Effect& effect) const;
  const std::vector<FamilyTest>& tests();
  const ModelState& scanned();
  Eigen::VectorXd previewed_residual(const FamilyTest& test);
  void preview_leading();
  std::shared_ptr<const Node> node_with(const FamilyTest& test);
  std::vector<const FamilyTest*> ranked();
  const FamilyTest& test_of(const EffectName& effect);
  const SessionModel& append(std::size_t parent, std::unique_ptr<Node> made, std::string change,
                             ModelStanding standing);
  SessionWork fit_of(const std::shared_ptr<const Campaign>& campaign,
                     const std::vector<EffectFinding>& effects, const std::string& change) const;
  static SessionChange appending(std::size_t parent, FittedModel fitted, std::vector<EffectFinding> effects,
                                 std::string change);
  void describe(Node& made, SessionModel& shown);
  const KeptFigures& figures_of(const Recipe& recipe);
  std::size_t place_of(const EffectName& effect) const;

  SessionOptions options_;
  ModelSpec given_;
  std::vector<EffectSpec> own_;
  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<SessionModel> models_;
  std::vector<std::shared_ptr<const Fitted>> least_;  ///< of the least noise, one for each set of readings
  std::size_t current_ = 0;
  std::vector<std::size_t>
      visited_;  ///< models that were left since the last one was made, the last one last
  std::vector<std::size_t> undone_;
  std::vector<std::size_t> recent_;  ///< models, the last one first
  /// Of the models without added effects that were described last; at most kKeptFigures.
  std::vector<std::shared_ptr<const FiguresOfModel>> kept_figures_;
};

}  // namespace volcal
