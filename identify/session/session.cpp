#include "volcal/identify/session/session.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/session/session_effects.h"
#include "volcal/identify/session/session_tree.h"
#include "volcal/identify/session/session_work.h"

namespace volcal {
namespace {

constexpr std::size_t kKeptFigures = 2;  // of models: 100 to 200 MB at 10^5 readings each
constexpr std::size_t kKeptModels = 8;   // linear models in memory; those of previews share a full fit's

constexpr auto readings_of = [](const auto& fitted) { return fitted->campaign(); };

}  // namespace

Session::Session(Campaign campaign, ModelSpec model, SessionOptions options)
    : options_(std::move(options)), given_(std::move(model)) {
  options_.threads = thread_count(options_.threads);
  const auto shared = std::make_shared<const Campaign>(std::move(campaign));
  const SessionWork load = interruptible([this, shared](const SessionProgress& progress) {
    return appending(0, fitting(shared)(shared, given_, progress), given_effects(given_), "");
  });
  load(options_.progress)(*this);
}

Session::~Session() = default;

Session::Fitting Session::fitting(const std::shared_ptr<const Campaign>& campaign) const {
  std::vector<Recipe> before;
  for (const auto& node : nodes_) before.push_back(node->recipe);
  const auto least = std::ranges::find(least_, campaign, readings_of);
  return {options_, own_, std::move(before),
          least != least_.end() ? (*least)->noise_variance() : std::numeric_limits<double>::max()};
}

/// Of the least noise at the readings of a model.
const std::shared_ptr<const Session::Fitted>& Session::least_of(const Recipe& recipe) const {
  return *std::ranges::find(least_, recipe.base->campaign(), readings_of);
}

/// Noise that was estimated without an effect holds part of it and hides its fall, so that all models are
/// told against the least noise that a full fit of the same readings has found.
void Session::put_in_place(const FittedModel& found) {
  const auto known = std::ranges::find(least_, found.fitted->campaign(), readings_of);
  if (known == least_.end()) {
    least_.push_back(found.fitted);
  } else if (found.fitted->noise_variance() < (*known)->noise_variance()) {
    *known = found.fitted;
  } else {
    return;
  }
  for (std::size_t i = 0; i < std::min(found.figures.size(), models_.size()); ++i) {
    if (found.figures[i]) set_figures(*found.figures[i], models_[i]);
  }
}

/// Another model is the current one. Of those that were looked at longest ago nothing stays that can be made
/// again.
void Session::go(std::size_t number) {
  current_ = number;
  std::erase(recent_, number);
  recent_.insert(recent_.begin(), number);
  std::vector<const Fitted*> kept;
  std::size_t models = 0;
  for (const std::size_t each : recent_) {
    Node& of = *nodes_[each];
    if (each != number) of.forget_prepared();
    const Fitted* base = of.recipe.base.get();
    const bool known = std::ranges::find(kept, base) != kept.end();
    if (++models <= kKeptModels && (known || kept.size() < kKeptFits)) {
      if (!known) kept.push_back(base);
      continue;
    }
    of.let_go();
    if (!known) base->let_go();
  }
}

std::size_t Session::kept_fits() const {
  std::vector<const Fitted*> kept;
  for (const auto& node : nodes_) {
    const Fitted* base = node->recipe.base.get();
    if (base->is_kept() && std::ranges::find(kept, base) == kept.end()) kept.push_back(base);
  }
  return kept.size();
}

void Session::set_figures(LadderStep figures, SessionModel& shown) {
  shown.figures = std::move(figures);
  shown.figures.model = std::to_string(shown.number);
  shown.figures.added = shown.change;
}

const Campaign& Session::campaign() const { return *node().recipe.base->campaign(); }
const std::vector<SessionModel>& Session::models() const { return models_; }
const SessionModel& Session::current() const { return models_[current_]; }
const LinearModel& Session::linear() const { return node().state().model(); }
const std::vector<bool>& Session::heldout() const { return node().recipe.setting->heldout; }
const FitResult& Session::fitted_result() const { return node().recipe.base->result(); }

const Eigen::VectorXd& Session::residual(std::size_t model) const {
  Node& of = *nodes_.at(model);
  if (!of.residual) of.residual = of.state().residual();
  return *of.residual;
}

Eigen::VectorXd Session::sigma(std::size_t model) const {
  const std::vector<double>& variance = nodes_.at(model)->recipe.variance();
  return Eigen::Map<const Eigen::VectorXd>(variance.data(), static_cast<Eigen::Index>(variance.size()))
      .cwiseSqrt();
}

const SessionModel& Session::append(std::size_t parent, std::unique_ptr<Node> made, std::string change,
                                    ModelStanding standing) {
  SessionModel shown;
  shown.number = models_.size();
  if (!models_.empty()) shown.parent = parent;
  shown.change = std::move(change);
  shown.standing = standing;
  describe(*made, shown);
  nodes_.push_back(std::move(made));
  models_.push_back(std::move(shown));
  visited_.clear();
  undone_.clear();
  go(models_.size() - 1);
  return models_.back();
}

SessionChange Session::appending(std::size_t parent, FittedModel found, std::vector<EffectFinding> effects,
                                 std::string change) {
  return [parent, found = std::move(found), effects = std::move(effects),
          change = std::move(change)](Session& session) {
    session.put_in_place(found);
    session.append(parent, std::make_unique<Node>(found.fitted, effects), change, ModelStanding::Fitted);
  };
}

void Session::describe(Node& made, SessionModel& shown) {
  const KeptFigures& figures = figures_of(made.recipe);
  const auto& least = least_of(made.recipe);
  if (made.recipe.base == least && !made.recipe.refit) {
    set_figures(figures.last_step(made.state(), made.state().projector()), shown);
  } else {
    if (made.least != least) {
      made.at_least = made.recipe.projector_at(*least, made.state());
      made.least = least;
    }
    set_figures(figures.last_step(made.state(), *made.at_least), shown);
  }
  shown.effects.clear();
  for (std::size_t i = 0; i < made.in_base(); ++i)
    shown.effects.push_back(made.recipe.base->fitted(made.effects[i]));
  if (made.recipe.added.empty()) return;
  for (EffectFinding& added : added_findings(made.state(), *made.of_all_readings()))
    shown.effects.push_back(std::move(added));
}

/// Of the recipe's model without added effects, against the least noise.
const KeptFigures& Session::figures_of(const Recipe& recipe) {
  const auto& least = least_of(recipe);
  const auto known =
      std::ranges::find_if(kept_figures_, [&](const auto& each) { return each->is_of(recipe, least); });
  auto found = known != kept_figures_.end() ? *known : nullptr;
  std::erase(kept_figures_, found);
  if (kept_figures_.size() >= kKeptFigures) kept_figures_.pop_back();
  if (!found) found = FiguresOfModel::of(recipe, least);
  kept_figures_.insert(kept_figures_.begin(), found);
  return found->figures;
}

/// Throws std::invalid_argument.
std::size_t Session::place_of(const EffectName& effect) const {
  const std::vector<EffectFinding>& effects = node().effects;
  const auto found = std::ranges::find(effects, effect, &EffectFinding::name);
  if (found == effects.end()) throw std::invalid_argument(full_name(effect) + " is not in this model");
  return static_cast<std::size_t>(found - effects.begin());
}

const SessionModel& Session::take(const SessionWork& work, const SessionProgress& progress) {
  work(progress)(*this);
  return current();
}

/// Back from a model that was gone to, else from what was made to what it was made of.
bool Session::undo() {
  if (!can_undo()) return false;
  undone_.push_back(current_);
  if (visited_.empty()) {
    go(*current().parent);
  } else {
    go(visited_.back());
    visited_.pop_back();
  }
  return true;
}

bool Session::redo() {
  if (undone_.empty()) return false;
  visited_.push_back(current_);
  go(undone_.back());
  undone_.pop_back();
  return true;
}

const SessionModel& Session::go_to(std::size_t number) {
  const SessionModel& wanted = models_.at(number);
  if (number != current_) visited_.push_back(current_);
  go(number);
  return wanted;
}

ModelSpec Session::model() const { return given_model_with(given_, campaign(), current().effects); }

}  // namespace volcal
