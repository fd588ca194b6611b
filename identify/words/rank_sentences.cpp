/// What the readings do not determine: why, and what to measure.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

Explanation axis_at_rest(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  return {"axis " + axis + " does not move in this campaign", "measure along axis " + axis};
}

Explanation tools_on_one_axis(const Finding& finding) {
  const std::string& about = finding.text("about");
  return {"every tool offset lies on " + about,
          "add setups with a tool offset sideways to " + about + " (100 mm or more)"};
}

Explanation no_lever_arm(const Finding& finding) {
  const std::string& about = finding.text("about");
  if (finding.has("table"))
    return {
        "no reading stands to the side of the axis of " + finding.text("table") + ", across " + about,
        "measure at places on the table 100 mm or more from that axis, or with an angle instrument about " +
            about};
  return {"no reading has a lever arm about " + about,
          "add setups with another tool offset, or an angle instrument about " + about};
}

Explanation no_reading_changes(const Finding& finding) {
  std::string off;
  if (finding.has("switch"))
    off = fmt::format(" ([{}] {} = {})", finding.text("switch"), finding.text("error"),
                      finding.text("switch") == "functions" ? "{ basis = \"zero\" }" : "\"zero\"");
  return {"no reading changes when it changes",
          "add readings that are sensitive to it, or switch it off in the model" + off};
}

/// Of a function with more periods a turn than the places of its axis tell.
Explanation few_places(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  const std::int64_t told = finding.count("told"), harmonics = finding.count("harmonics");
  const bool is_regular = finding.has("spacing");
  const std::string apart =
      is_regular ? fmt::format(", on a grid of {:.4g} deg", finding.number("spacing").in_unit()) : "";
  return {
      fmt::format("the readings stand at {} different positions of axis {}{}; nothing there tells waves of "
                  "more than {} a turn from longer ones, and its function has up to {}",
                  finding.count("positions"), axis, apart, told, harmonics),
      fmt::format("add positions of axis {}{}, {} or more in all, or give its function {}", axis,
                  is_regular ? " off that grid" : "", 2 * harmonics + 1,
                  told > 0 ? fmt::format("degree = {}", told) : "the basis \"zero\"")};
}

Explanation few_positions(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  if (finding.has("told") && finding.count("told") < finding.count("harmonics")) return few_places(finding);
  return {"the readings stand at too few positions of axis " + axis + " to tell its course between them",
          "add positions along axis " + axis};
}

Explanation like_straightness(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  return {"the readings stand at too few positions of axis " + axis +
              ", or on too little of its travel, to tell it from " + finding.text("straightness"),
          "add positions along the whole travel of axis " + axis};
}

Explanation readings_too_few(const Finding&) {
  return {"the readings that depend on it are too few or too noisy", "add readings far from its pivot"};
}

std::string remedy_in_words(const std::string& remedy, const Finding& finding) {
  if (remedy == "positions") return "add positions along axis " + finding.text("axis");
  if (remedy == "one-axis-standing")
    return fmt::format("move {} while {} stands, at several positions of {}: they move together only",
                       finding.text("moving"), finding.text("standing"), finding.text("standing"));
  if (remedy == "measured-travel") {
    const auto degrees = [&](const char* key) { return finding.number(key).in_unit(); };
    return fmt::format(
        "measure {} over its travel, {:.4g} to {:.4g} deg, or state in the machine file the {:.4g} to {:.4g} "
        "deg that were measured",
        finding.text("partly"), degrees("travel_from"), degrees("travel_to"), degrees("from"), degrees("to"));
  }
  if (remedy == "stations") return "measure from more stations (four, well apart)";
  if (remedy == "second-tool" && finding.has("turning"))
    return fmt::format(
        "turn {} with a second tool offset, sideways and of another length: other tools are in use where it "
        "stands still",
        finding.text("turning"));
  if (remedy == "mandrel" && finding.has("turning"))
    return fmt::format(
        "turn {} with a mandrel whose tip lies 60 mm or more to the side of the spindle's axis",
        finding.text("turning"));
  if (remedy == "second-tool") return "repeat with a second tool offset, sideways and of another length";
  if (remedy == "third-tool") {
    return fmt::format(
        "repeat with a third tool, its tip 100 mm or more to the side in {} (those of the tools in use lie "
        "on "
        "one line)",
        finding.text("third_tool_across"));
  }
  if (remedy == "holding-instrument") {
    return "add an instrument that holds position or direction over the whole travel (tracer, straightness, "
           "square)";
  }
  if (remedy == "combined-poses")
    return "turn both rotary axes at once, over a grid of their positions: one at a time they exchange "
           "errors";
  if (remedy == "linear-axes")
    return "measure the linear axes, too, with the rotary axes at 0 (tracer, straightness, square): without "
           "that, their errors while they follow a rotary axis cannot be separated from those of that axis";
  if (remedy == "spheres") return "measure at three places on the table that do not lie on one line";
  if (remedy == "mandrel")
    return "add a mandrel whose tip lies 60 mm or more to the side of the spindle's axis";
  if (remedy == "other-lines")
    return "add lines at other offsets, straightness or angle readings that tell them apart";
  throw std::invalid_argument("a remedy \"" + remedy + "\" is not known");
}

Explanation exchangeable(const Finding& finding) {
  std::vector<std::string> remedies;
  for (const std::string& remedy : finding.texts("remedies"))
    remedies.push_back(remedy_in_words(remedy, finding));
  return {"a change of it can be exchanged with " + list_in_words(finding.texts("partners")) +
              " without changing any reading",
          list_in_words(remedies)};
}

Explanation as_written(const Finding& finding) { return {finding.text("reason"), finding.text("remedy")}; }

using Explain = Explanation (*)(const Finding&);
constexpr auto kExplanations = std::to_array<std::pair<FindingCode, Explain>>({
    {FindingCode::NotVisibleVerbatim, as_written},
    {FindingCode::NotVisibleAxisAtRest, axis_at_rest},
    {FindingCode::NotVisibleToolsOnOneAxis, tools_on_one_axis},
    {FindingCode::NotVisibleNoLeverArm, no_lever_arm},
    {FindingCode::NotVisibleNoReadingChanges, no_reading_changes},
    {FindingCode::NotVisibleFewPositions, few_positions},
    {FindingCode::NotVisibleLikeStraightness, like_straightness},
    {FindingCode::NotVisibleReadingsTooFew, readings_too_few},
    {FindingCode::NotVisibleExchangeable, exchangeable},
});

std::string not_visible(const Finding& finding) {
  const Explanation words = explanation(finding);
  return finding.text("error") + ": not visible, " + words.reason + "; " + words.remedy;
}

std::string held_by_prior(const Finding& finding) {
  const FindingNumber& sigma = finding.number("sigma");
  return fmt::format("{} {}: held at its guess +- {:g} {}", finding.text("block"), finding.text("parameter"),
                     sigma.in_unit(), sigma.unit);
}

}  // namespace

Explanation explanation(const std::optional<Finding>& cause) {
  if (!cause) return {};
  const auto found = std::ranges::find(kExplanations, cause->code, &std::pair<FindingCode, Explain>::first);
  if (found == kExplanations.end())
    throw std::invalid_argument("\"" + std::string(to_string(cause->code)) +
                                "\" is not a reason for what is not visible");
  return found->second(*cause);
}

std::span<const SentenceMaker> rank_sentences() {
  static constexpr auto kSentences = [] {
    std::array<SentenceMaker, kExplanations.size() + 1> all = {};
    for (std::size_t i = 0; i < kExplanations.size(); ++i) all[i] = {kExplanations[i].first, not_visible};
    all.back() = {FindingCode::RankHeldByPrior, held_by_prior};
    return all;
  }();
  return kSentences;
}

}  // namespace volcal
