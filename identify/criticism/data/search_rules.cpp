#include "volcal/identify/criticism/data/search_rules.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace volcal {
namespace {

struct RuleWords {
  SearchRule rule;
  std::string_view name;
  std::string_view description;
};

constexpr auto kWords = [] {
  using enum SearchRule;
  return std::to_array<RuleWords>({
      {OneCause, "one-cause", "a curve takes the place of two names"},
      {WiderSurface, "wider-surface", "a surface of more variables takes the place of one and a name"},
      {Surfaces, "surfaces", "what has no name is drawn"},
      {CrossedFindings, "crossed-findings", "surfaces of one scan's variables on another's target"},
      {ReplacedSurfaces, "replaced-surfaces", "names are tried in the place of surfaces"},
      {ScanVeto, "scan-veto", "no name is added that a scan beats"},
      {ComponentMargin, "component-margin", "a wider margin for displacements of independent components"},
      {NamesTogether, "names-together", "several names are tried at once against a scan"},
      {AbsorbedEffects, "absorbed-effects", "effects that the noise may hold are tested jointly with it"},
      {OpenErrors, "open-errors", "no effect that errors which the model holds at zero may hold"},
      {OneAmplitude, "one-amplitude",
       "no name of several axes is added whose amplitude differs between them"},
      {Departure, "departure", "a name that is weak beside the others leaves"},
      {Exchange, "exchange", "a better name replaces another"},
      {LeavesMore, "leaves-more", "no name: what it leaves is less probable than it"},
      {DriverStillMoves, "driver-still-moves", "no name: its driver moves what it leaves"},
      {AmplitudeVaries, "amplitude-varies", "no name: its amplitude is not constant"},
      {ShapeBeyondScan, "shape-beyond-scan", "no name: its shape lies beyond the scan"},
      {StandingRival, "standing-rival", "a rival takes the place of what is no name"},
      {Recheck, "recheck", "what stands after a rejection is judged again"},
      {NearByLm, "near-by-lm", "rivals by LM alone, whatever their number of amplitudes"},
      {EstimatedNoise, "estimated-noise", "F in place of chi-squared: noise is known by estimation"},
      {DoubtfulScans, "doubtful-scans", "chi-squared for scans where many exceed"},
      {Reinstated, "reinstated-outliers", "outliers that a name explains are readings again"},
      {SimplestFirst, "simplest-first", "of scans that stand out nearly alike the simplest is reported"},
      {CertainVariable, "certain-variable", "a second variable is reported where no other does as well"},
  });
}();

constexpr auto kRules = [] {
  std::array<SearchRule, kWords.size()> rules{};
  for (std::size_t i = 0; i < rules.size(); ++i) rules[i] = kWords[i].rule;
  return rules;
}();

const RuleWords& words_of(SearchRule rule) {
  const auto* found = std::ranges::find(kWords, rule, &RuleWords::rule);
  if (found == kWords.end()) throw std::logic_error("a rule of the search has no words");
  return *found;
}

}  // namespace

std::span<const SearchRule> search_rules() { return kRules; }

std::string_view name_of(SearchRule rule) { return words_of(rule).name; }

std::string_view description_of(SearchRule rule) { return words_of(rule).description; }

std::optional<SearchRule> search_rule_of(std::string_view name) {
  const auto* found = std::ranges::find(kWords, name, &RuleWords::name);
  if (found == kWords.end()) return std::nullopt;
  return found->rule;
}

}  // namespace volcal
