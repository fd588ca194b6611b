#include "volcal/identify/criticism/search/explained.h"

#include <optional>
#include <set>
#include <utility>

#include "volcal/identify/criticism/search/climb.h"
#include "volcal/identify/criticism/search/rivals.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

void keep(const std::vector<FamilyTest>& effects, const SearchOptions& options, Reached& reached) {
  reached.restart_with(effects);
  reached = Rivals(std::move(reached), options).settle([](Reached changed) { return changed; });
  reached.test();
}

/// What has come in place of others, if it is no name either, and what is weaker than what these have left.
void recheck(const std::set<std::size_t>& stood, const SearchOptions& options, Reached& reached) {
  const Rejection rejection(reached.state);
  std::vector<FamilyTest> kept;
  for (std::size_t i = 0; i < reached.state.added().size(); ++i) {
    const AddedEffect& effect = reached.state.added()[i];
    std::optional<Finding> reason;
    if (!stood.contains(effect.test.family)) {
      reason = rejection.rejection_reason(i);
    } else if (rejection.leaves_more(effect)) {
      reason =
          Finding{FindingCode::RejectedUnnamedExceeds, {{"effect", reached.state.family_of(effect).label()}}};
    }
    if (reason) reached.rejected[effect.test.family] = *reason;
    if (!reason) kept.push_back(effect.test);
  }
  if (kept.size() == reached.state.added().size()) return;
  reached.rules().tell(SearchRule::Recheck);
  keep(kept, options, reached);
}

void reject(const SearchOptions& options, Reached& reached) {
  const Rejection rejection(reached.state);
  reached.rejected = rejection.rejection_reasons();
  if (reached.rejected.empty()) return;
  std::vector<FamilyTest> kept;
  std::set<std::size_t> stood;
  for (std::size_t i = 0; i < reached.state.added().size(); ++i) {
    const FamilyTest& own = reached.state.added()[i].test;
    if (!reached.rejected.contains(own.family)) {
      stood.insert(own.family);
      kept.push_back(own);
    } else if (const FamilyTest* rival = rejection.standing_rival(i, reached.rejected)) {
      kept.push_back(*rival);
    }
  }
  keep(kept, options, reached);
  if (reached.rules().follows(SearchRule::Recheck)) recheck(stood, options, reached);
}

}  // namespace

Reached explained(Reached from, const SearchOptions& options) {
  const auto climb = [&](Reached reached) { return Climb(std::move(reached), options).run(); };
  Reached reached = Rivals(climb(std::move(from)), options).settle(climb);
  reject(options, reached);
  return reached;
}

}  // namespace volcal
