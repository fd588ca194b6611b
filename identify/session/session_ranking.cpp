#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/search/climb.h"
#include "volcal/identify/criticism/search/model_tests.h"
#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/identify/session/hidden_effects.h"
#include "volcal/identify/session/proposed_measurements.h"
#include "volcal/identify/session/session_tree.h"
#include "volcal/identify/session/session_work.h"

namespace volcal {
namespace {

/// Best first.
void sort_by_gain(std::vector<const FamilyTest*>& tests) {
  std::ranges::stable_sort(tests, std::greater{}, [](const FamilyTest* test) { return test->gain; });
}

/// Whether a formula was written again, by the same name with other values.
bool is_written_again(const SearchSetting& setting, std::size_t family) {
  const std::size_t listed = setting.families.size() - setting.own;
  if (family < listed) return false;
  const EffectName name = setting.families[family].name();
  return std::any_of(setting.families.begin() + static_cast<std::ptrdiff_t>(family) + 1,
                     setting.families.end(), [&](const Family& later) { return later.name() == name; });
}

}  // namespace

/// With the effects that the user thought of meanwhile.
void Session::renew_setting() {
  Node& here = node();
  const SearchSetting& known = *here.recipe.setting;
  if (known.own == own_.size()) return;
  const std::vector<EffectSpec> more(own_.begin() + static_cast<std::ptrdiff_t>(known.own), own_.end());
  here.with_setting(std::make_shared<const SearchSetting>(known.with_more(here.state().model(), more)));
}

/// Tests of all effects at the current model.
const std::vector<FamilyTest>& Session::tests() {
  renew_setting();
  return node().tests->get().families;
}

std::function<void()> Session::testing() {
  renew_setting();
  return [tests = node().tests] { tests->get(); };
}

SessionWork Session::scan() {
  renew_setting();
  return interruptible([recipe = node().recipe, state = node().state(), tests = node().tests,
                        number = current_](const SessionProgress& progress) -> SessionChange {
    report_stage(progress, "tests of the catalogue", 0.1);
    const std::vector<FamilyTest>& families = tests->get().families;
    report_stage(progress, "scans without a catalogue", 0.3);
    const ModelState scanned = state.with_tests(tests_of(state, families));
    std::vector<UnknownFinding> unknown = unknown_findings(scanned, {});
    report_what_is_certain(unknown);
    const std::vector<std::size_t>& exceeding = scanned.tests().exceeding;
    const bool leads =
        !unknown.empty() &&
        (exceeding.empty() || any_scan_does_better(scanned, scanned.tests().families[exceeding.front()]));
    report_stage(progress, "what to measure next", 0.9);
    std::vector<MeasurementProposal> proposals = proposed_measurements(scanned, recipe.base->result());
    report_stage(progress, "done", 1.0);
    return [scanned, unknown = std::move(unknown), leads, proposals = std::move(proposals),
            base = recipe.base, refit = recipe.refit, number](Session& session) {
      Node& of = *session.nodes_[number];
      if (of.recipe.base != base || of.recipe.refit != refit) return;  // refitted or confirmed meanwhile
      of.scanned = scanned;
      of.unknown = unknown;
      of.unknown_leads = leads;
      of.proposals = proposals;
    };
  });
}

bool Session::is_scanned() const { return node().unknown.has_value(); }

/// With the scans.
const ModelState& Session::scanned() {
  renew_setting();
  if (!node().scanned) scan()({})(*this);
  return *node().scanned;
}

/// The last of a name: of a formula that was written again with other values the one that is asked for now.
const FamilyTest& Session::test_of(const EffectName& effect) {
  const std::vector<FamilyTest>& all = tests();
  for (std::size_t i = all.size(); i-- > 0;) {
    const Family& family = node().state().setting().families[all[i].family];
    if (family.effect && family.name() == effect && !node().state().has(all[i].family)) return all[i];
  }
  throw std::invalid_argument(full_name(effect) + " is not an effect that can be added to this model");
}

/// What shows and is not in the model, best first.
std::vector<const FamilyTest*> Session::ranked() {
  std::vector<const FamilyTest*> order;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof > 0 && !node().state().has(test.family) &&
        !is_written_again(*node().recipe.setting, test.family))
      order.push_back(&test);
  }
  sort_by_gain(order);
  return order;
}

const std::vector<EffectFinding>& Session::rank() {
  const std::vector<const FamilyTest*> order = ranked();
  Node& here = node();
  if (!here.ranking) {
    std::vector<EffectFinding> ranking;
    for (const FamilyTest* test : order) ranking.push_back(finding(here.state().setting(), *test));
    here.ranking = std::move(ranking);
  }
  return *here.ranking;
}

std::vector<EffectFinding> Session::not_visible() {
  std::vector<EffectFinding> hidden;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof == 0 && !node().state().has(test.family) &&
        !is_written_again(*node().recipe.setting, test.family))
      hidden.push_back(finding(node().state().setting(), test));
  }
  return hidden;
}

std::vector<Explanation> Session::why_not_visible(const std::vector<EffectFinding>& effects) {
  std::map<EffectName, Explanation>& known = node().why_not_visible;
  std::vector<const FamilyTest*> asked;
  for (const EffectFinding& effect : effects) {
    if (!known.contains(effect.name)) asked.push_back(&test_of(effect.name));
  }
  const std::vector<Explanation> found = why_hidden(node().state(), asked);
  for (std::size_t i = 0; i < asked.size(); ++i)
    known[node().recipe.setting->families[asked[i]->family].name()] = found[i];
  std::vector<Explanation> all;
  for (const EffectFinding& effect : effects) all.push_back(known.at(effect.name));
  return all;
}

Rivalry Session::rivals(std::size_t most) {
  std::vector<const FamilyTest*> leading = ranked();
  std::erase_if(leading, [&](const FamilyTest* test) {
    return node().state().setting().families[test->family].effect == nullptr;
  });
  leading.resize(std::min(leading.size(), most));
  const ModelState& state = node().state();
  const auto count = static_cast<Eigen::Index>(leading.size());
  Rivalry rivalry{{}, Eigen::MatrixXd::Identity(count, count)};
  if (leading.empty()) return rivalry;
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(state.model().size()), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const FamilyTest& test = *leading[static_cast<std::size_t>(k)];
    const Family& family = state.setting().families[test.family];
    rivalry.names.push_back(family.name());
    moved.col(k) = displacement(state.model(), family, test);
  }
  const ProjectedColumns projected = state.projector().project(moved);
  const Eigen::MatrixXd gram = projected.gram(0, count);
  const Eigen::VectorXd size = gram.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) {
      if (i != k && size[i] * size[k] > 0.0)
        rivalry.cosine(i, k) = std::min(1.0, std::abs(gram(i, k)) / (size[i] * size[k]));
    }
  }
  return rivalry;
}

const std::vector<UnknownFinding>& Session::unknown() {
  if (!is_scanned()) scanned();
  return *node().unknown;
}

bool Session::unknown_leads() {
  if (!is_scanned()) scanned();
  return node().unknown_leads;
}

const std::vector<MeasurementProposal>& Session::next_measurements() {
  if (!is_scanned()) scanned();
  return node().proposals;
}

}  // namespace volcal
