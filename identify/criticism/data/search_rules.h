#pragma once
/// The rules of a search that can be done without: what each does, and a way to leave some out, for the study
/// that counts what they are worth (`volcal study rules`). A diagnosis follows them all.

#include <concepts>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string_view>

namespace volcal {

enum class SearchRule {
  OneCause,          ///< a curve takes the place of two names
  WiderSurface,      ///< a surface of more variables takes the place of one and a name
  Surfaces,          ///< what has no name is drawn
  CrossedFindings,   ///< surfaces of one scan's variables on another's target
  ReplacedSurfaces,  ///< names in the place of surfaces
  ScanVeto,          ///< no name is added that a scan beats
  ComponentMargin,   ///< a wider margin for displacements whose components are independent
  NamesTogether,     ///< several names at once against a scan
  AbsorbedEffects,   ///< effects that the noise may hold
  OpenErrors,        ///< no effect that errors which the model holds at zero may hold
  OneAmplitude,      ///< no name of several axes is added whose amplitude differs between them
  Departure,         ///< a name that is weak beside the others leaves
  Exchange,          ///< a better name replaces another
  LeavesMore,        ///< no name: what it leaves is less probable than it
  DriverStillMoves,  ///< no name: its driver moves what it leaves
  AmplitudeVaries,   ///< no name: its amplitude is not constant
  ShapeBeyondScan,   ///< no name: its shape lies beyond the scan
  StandingRival,     ///< a rival takes the place of what is no name
  Recheck,           ///< what stands after a rejection is judged again
  NearByLm,          ///< rivals by LM alone
  EstimatedNoise,    ///< F in place of chi-squared
  DoubtfulScans,     ///< chi-squared where many scans exceed
  Reinstated,        ///< outliers that a name explains are readings again
  SimplestFirst,     ///< of scans that are nearly alike the simplest is reported
  CertainVariable    ///< a second variable is reported where it is certain
};

std::span<const SearchRule> search_rules();
/// "one-cause"
std::string_view name_of(SearchRule rule);
/// "a curve takes the place of two names"
std::string_view description_of(SearchRule rule);
std::optional<SearchRule> search_rule_of(std::string_view name);

/// Which rules a search follows, and who hears when one of them decides something. A search in which a
/// rule decided nothing is the same to the bit without it.
struct SearchRules {
  std::set<SearchRule> off;
  std::function<void(SearchRule)> decided;  ///< by one thread at a time; may be empty

  bool follows(SearchRule rule) const { return !off.contains(rule); }
  void tell(SearchRule rule) const {
    if (decided) decided(rule);
  }
  /// Whether the rule is followed and its condition, not asked for otherwise, holds.
  template <std::predicate Condition>
  bool decide(SearchRule rule, const Condition& condition) const {
    if (!follows(rule) || !condition()) return false;
    tell(rule);
    return true;
  }
};

}  // namespace volcal
