#pragma once
/// A campaign under somebody's hands: look, try, add, watch the error fall.
///
/// A session holds a campaign, the model that was fitted to it, and a tree of models that came of it by
/// adding and removing effects. A step is first a linear preview: the fitted model's derivatives, with noise
/// and smoothing of its last full fit, in tens of milliseconds. confirm() fits the model in full and says
/// whether the preview held. No step is lost: undo, redo and go_to() move between models, and further steps
/// from an earlier one are another branch. Lines that judge are chosen before the first step and choose
/// nothing; what a person tries counts as a test, like those of the catalogue.
///
///   Session session(campaign, model, {});
///   session.rank();                                   // effects of the catalogue, best first
///   session.add({"reversal", "EXX", "dir_x", "step"});
///   session.current().figures.systematic;             // on lines that did not choose, m
///   session.confirm();
///   session.model();                                  // for a model file
///
/// Numbers are those of diagnose() to the bit: both stand on identify/criticism. SI. Not for several threads
/// at once; results do not depend on the number that work inside.

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/result/result.h"
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

enum class ModelStanding {
  Fitted,       ///< by a full fit
  Preview,      ///< linear, at the noise of the last full fit
  Contradicted  ///< by a full fit, which differs from the preview by more than U95/4
};

/// One model of the tree.
struct SessionModel {
  std::size_t number = 0;
  std::optional<std::size_t> parent;  ///< none: as given
  std::string change;                 ///< "+ reversal EXX", "- ECX by z"; empty for the first
  ModelStanding standing = ModelStanding::Fitted;
  LadderStep figures;                  ///< on fitted and on held-out readings
  std::vector<EffectFinding> effects;  ///< added to the given model, with their amplitudes in this one
};

/// What an effect would be if it were added to the current model.
struct EffectPreview {
  EffectFinding effect;      ///< amplitude, U, MDB, p with all tests counted
  Eigen::VectorXd residual;  ///< then, of all observations, m or rad; the rest of the model adjusted to it
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

  const Campaign& campaign() const;
  /// All models, in the order in which they were made.
  const std::vector<SessionModel>& models() const;
  const SessionModel& current() const;
  /// Reading minus prediction of the current model; setup, row, channel order, m or rad.
  Eigen::VectorXd residual() const;

  /// Effects that are not in the current model, best first; with more of an error function, which cannot be
  /// added here.
  std::vector<EffectFinding> rank();
  EffectPreview preview(const EffectName& effect);
  /// An effect of the kind `custom` as the user writes it, tested beside the catalogue; from here on it can
  /// be added by its name. Throws InputError where it cannot be read or cannot act.
  EffectPreview formula(const EffectSpec& custom);
  /// Marked observations.
  SelectionSummary summary(const std::vector<bool>& selected) const;

  /// A linear preview with a further effect, or without one that was added, becomes the current model.
  /// Throws std::invalid_argument where there is no such effect.
  const SessionModel& add(const EffectName& effect);
  /// Where the effect is part of a full fit, by another one.
  const SessionModel& remove(const EffectName& effect, const SessionProgress& progress = {});
  /// The current model by a full fit, noise and smoothing anew. Throws SessionStopped.
  const SessionModel& confirm(const SessionProgress& progress = {});

  /// To the model before, and back. False: there is none.
  bool undo();
  bool redo();
  /// Throws std::out_of_range.
  const SessionModel& go_to(std::size_t number);

  /// The given model with the effects of the current one.
  ModelSpec model() const;

 private:
  struct Fitted;
  struct Node;

  std::shared_ptr<const Fitted> fitted(const ModelSpec& model, const SessionProgress& progress) const;
  Node& node() const;
  const std::vector<FamilyTest>& tests();
  const FamilyTest& test_of(const EffectName& effect);
  const SessionModel& append(Node made, std::string change, ModelStanding standing);
  void describe(const Node& made, SessionModel& shown) const;

  SessionOptions options_;
  Campaign campaign_;
  ModelSpec given_;
  std::vector<EffectSpec> own_;
  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<SessionModel> models_;
  std::size_t current_ = 0;
  std::vector<std::size_t> undone_;
};

}  // namespace volcal
