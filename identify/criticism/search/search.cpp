#include "volcal/identify/criticism/search/search.h"

#include <algorithm>
#include <utility>

#include "volcal/identify/criticism/search/drawing.h"
#include "volcal/identify/criticism/search/errors_first.h"
#include "volcal/identify/criticism/search/explained.h"
#include "volcal/identify/criticism/search/rivals.h"

namespace volcal {
namespace {

std::shared_ptr<const SearchSetting> setting_of(const LinearModel& model, std::vector<bool> heldout,
                                                const SearchOptions& options) {
  auto setting = std::make_shared<SearchSetting>(model, std::move(heldout), options.leave_out,
                                                 options.threads, options.own);
  setting->rules = options.rules;
  return setting;
}

/// Where error functions came back: each takes part of what a shape was found by before it.
void settle_shapes(Reached& reached) {
  if (!any_function_came_back(reached.state)) return;
  reached.state = reached.state.with_settled_shapes();
  reached.test();
}

/// What was rejected on the way and did not return.
void recall_rejected(Reached& reached) {
  for (const auto& [family, reason] : reached.rejected_before) {
    if (!reached.state.has(family)) reached.rejected.try_emplace(family, reason);
  }
}

/// False: there is none.
bool take(std::optional<Reached> next, Reached& reached) {
  if (next) reached = *std::move(next);
  return next.has_value();
}

}  // namespace

Search::Search(LinearModel model, std::vector<bool> heldout, SearchOptions options)
    : options_(std::move(options)) {
  auto setting = setting_of(model, std::move(heldout), options_);
  begin_ = [model = std::move(model), setting = std::move(setting)] { return ModelState(model, setting); };
}

Search::Search(const ModelState& given, SearchOptions options) : options_(std::move(options)) {
  begin_ = [given = given.with_setting(setting_of(given.model(), given.setting().heldout, options_))] {
    return given;
  };
}

void Search::run() {
  options_.report("noise model", 0.05);
  Reached& reached = reached_.emplace(begin_());
  const auto explain = [&] { reached = explained(std::move(reached), options_); };
  const Drawing drawing(options_);
  explain();
  while (take(drawing.one_cause(reached), reached)) explain();
  reached.names_before_surfaces = reached.state.added().size();
  do {
    while (take(drawing.surface(reached), reached)) explain();
  } while (take(drawing.wider_surface(reached), reached));
  reached = drawing.names_for_surfaces(std::move(reached));
  settle_shapes(reached);
  if (!options_.climb) keep_one_step();
  recall_rejected(reached);
}

/// The first effect, and the changes of the model before it; or the first surface where no effect came
/// before.
void Search::keep_one_step() {
  Reached& reached = *reached_;
  if (reached.base.surfaces().size() == 1 && reached.state.added().empty()) return;
  if (!reached.base.surfaces().empty()) {
    const AddedSurface first = reached.base.surfaces().front();
    more_is_known_ = reached.state.added().size() > reached.names_before_surfaces;
    if (reached.names_before_surfaces == 0) {
      reached =
          rebuilt(std::move(reached), {{first.spec, first.effect, first.finding, first.log_evidence}}, {});
    } else {
      const std::vector<FamilyTest> names = added_tests(reached.state.added());
      reached = rebuilt(std::move(reached), {}, names);
      reached = Rivals(std::move(reached), options_).settle([](Reached changed) { return changed; });
    }
    reached.test();
    if (reached.names_before_surfaces == 0) return;
  }
  const auto is_effect = [&](const AddedEffect& each) {
    return reached.setting().families[each.test.family].effect != nullptr;
  };
  const std::vector<AddedEffect>& added = reached.state.added();
  const auto first = std::ranges::find_if(added, is_effect);
  if (first == added.end() || first + 1 == added.end()) return;
  more_is_known_ = std::any_of(first + 1, added.end(), is_effect);
  const std::vector<AddedEffect> before(added.begin(), first + 1);
  reached.restart_with(added_tests(before));
  std::vector<AddedEffect> kept = reached.state.added();
  for (std::size_t i = 0; i < before.size(); ++i) kept[i].rivals = before[i].rivals;
  reached.state = reached.state.with_comparisons(std::move(kept));
  reached.test();
}

}  // namespace volcal
