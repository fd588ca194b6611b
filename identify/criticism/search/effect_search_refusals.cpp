// EffectSearch: what stands out and is no name.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/effect_search.h"

namespace volcal {
namespace {

/// "time constant"
std::string shape_word(const EffectShape& shape) {
  const std::size_t colon = shape.label.rfind(": ");
  return colon == std::string::npos ? shape.label : shape.label.substr(colon + 2);
}

}  // namespace

/// Its own driver moves what an effect leaves: it has another shape, or is another effect. A wave is one
/// beside it.
bool EffectSearch::still_moves(const std::vector<std::string>& drivers) const {
  return std::ranges::any_of(outstanding_scans(), [&](const GenericTest* test) {
    if (test->period > 0.0) return false;
    return std::ranges::any_of(test->variables, [&](const std::string& variable) {
      return std::ranges::find(drivers, variable) != drivers.end();
    });
  });
}

/// Powers of one driver that are needed together stand for a function of it that the catalogue does not hold,
/// and a name that is less certain than what it leaves unexplained, leaves its own driver at work, or is of
/// another size here than there, is none.
void EffectSearch::find_no_names() {
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<std::size_t>> by_driver;
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const std::size_t family = added_[i].test.family;
    const EffectName name = families_[family].name();
    by_driver[{name.kind, name.target, name.driver}].push_back(family);
    const std::string reason = rejection_reason(i);
    if (!reason.empty()) given_up_[family] = reason;
  }
  for (const auto& [key, members] : by_driver) {
    if (members.size() < 2) continue;
    for (const std::size_t family : members) given_up_[family] = "several powers of its driver are needed";
  }
}

/// What the scans still see is less probable than the effect.
bool EffectSearch::leaves_more(const AddedEffect& effect) const {
  return std::ranges::any_of(outstanding_scans(), [&](const GenericTest* test) {
    return family_wise_log10_p(*test) < family_wise_log10_p(effect.test);
  });
}

/// Empty for a name that stands.
std::string EffectSearch::rejection_reason(std::size_t added) const {
  const AddedEffect& effect = added_[added];
  const Family& family = families_[effect.test.family];
  if (leaves_more(effect)) return "what it leaves stands out more than it does";
  const auto drivers = scan_variables_of(family.name());
  if (still_moves(drivers)) return fmt::format("{} still moves what it leaves", fmt::join(drivers, " or "));
  if (!family.effect) return {};
  const ConstancyTest constancy = constancy_of(family, effect.columns, first_column(added), *projector_);
  if (constancy.log10_p <= std::log10(kThresholds.constancy_risk)) {
    return fmt::format("its amplitude varies with {} (log10 p {:.1f})", constancy.variable,
                       constancy.log10_p);
  }
  if (!lies_beyond_its_scan(added)) return {};
  return "its " + shape_word(family.effect->shapes().front()) + " lies beyond what was looked for";
}

/// The best shape stands at an end of the scan, and the readings ask for one beyond.
bool EffectSearch::lies_beyond_its_scan(std::size_t added) const {
  const auto& [test, columns, rivals] = added_[added];
  const Family& family = families_[test.family];
  if (columns.cols() == family.amplitudes()) return false;  // no shape, or none that moves the readings
  const std::optional<ScanEnd> end = end_of_scan(family, test.shape[0]);
  if (!end) return false;
  const Eigen::Index column = first_column(added) + family.amplitudes();
  Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, projector_->parameters());
  row(0, column) = 1.0;
  const double change = projector_->solution()[column];
  const double outwards = *end == ScanEnd::Lowest ? -change : change;
  return outwards > kThresholds.beyond_scan * std::sqrt(projector_->prediction_variance(row)[0]);
}

/// `first`: of its columns among the projector's parameters.
ConstancyTest EffectSearch::constancy_of(const Family& family, const Eigen::MatrixXd& columns,
                                         Eigen::Index first, const Projector& projector) const {
  const Eigen::Index count = family.amplitudes();
  const Eigen::VectorXd moved = columns.leftCols(count) * projector.solution().segment(first, count);
  return least_constant(family, moved, constancy_variables_, projector);
}

/// In the place of an added effect.
double EffectSearch::constancy_of_rival(std::size_t added, const FamilyTest& rival) const {
  const Family& family = families_[rival.family];
  if (!family.effect) return 0.0;
  const auto projector = projector_without({added});
  const Eigen::Index first = projector->parameters();
  const Eigen::MatrixXd columns = accept(rival, *projector);
  return constancy_of(family, columns, first, *projector).log10_p;
}

/// Of the amplitudes among the projector's parameters.
Eigen::Index EffectSearch::first_column(std::size_t added) const {
  Eigen::Index first = projector_->parameters() - projector_->accepted();
  for (std::size_t i = 0; i < added; ++i) first += added_[i].columns.cols();
  return first;
}

/// Rivals whose amplitude varies, where the added effect's plainly does not.
void EffectSearch::drop_inconsistent_rivals() {
  for (std::size_t i = 0; i < added_.size(); ++i) {
    AddedEffect& effect = added_[i];
    const Family& family = families_[effect.test.family];
    if (effect.rivals.empty() || !family.effect) continue;
    const double own = constancy_of(family, effect.columns, first_column(i), *projector_).log10_p;
    if (own < std::log10(kThresholds.plainly_constant)) continue;
    std::erase_if(effect.rivals, [&](const FamilyTest& rival) {
      return constancy_of_rival(i, rival) < std::log10(kThresholds.rival_constancy_risk);
    });
  }
}

/// The first rival that would stand where the added effect is refused.
const FamilyTest* EffectSearch::standing_rival(std::size_t added) const {
  for (const FamilyTest& rival : added_[added].rivals) {
    if (!given_up_.contains(rival.family) &&
        constancy_of_rival(added, rival) > std::log10(kThresholds.plainly_constant))
      return &rival;
  }
  return nullptr;
}

void EffectSearch::reject() {
  find_no_names();
  if (!given_up_.empty()) {
    std::vector<FamilyTest> kept;
    std::set<std::size_t> stood;
    for (std::size_t i = 0; i < added_.size(); ++i) {
      const FamilyTest& own = added_[i].test;
      if (!given_up_.contains(own.family)) {
        stood.insert(own.family);
        kept.push_back(own);
      } else if (const FamilyTest* rival = standing_rival(i)) {
        kept.push_back(*rival);
      }
    }
    keep(kept);
    recheck(stood);
  }
  drop_inconsistent_rivals();
}

/// What has come in place of others, if it is no name either, and what is weaker than what these have left.
void EffectSearch::recheck(const std::set<std::size_t>& stood) {
  std::vector<FamilyTest> kept;
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const std::size_t family = added_[i].test.family;
    std::string reason;
    if (!stood.contains(family)) {
      reason = rejection_reason(i);
    } else if (leaves_more(added_[i])) {
      reason = "what has no name stands out more than it does";
    }
    if (!reason.empty()) given_up_[family] = reason;
    if (reason.empty()) kept.push_back(added_[i].test);
  }
  if (kept.size() < added_.size()) keep(kept);
}

void EffectSearch::keep(const std::vector<FamilyTest>& tests) {
  add_again(tests);
  settle([] {});
  test();
}

}  // namespace volcal
