#include "volcal/identify/cli/options/effect_list.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/figure_data.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal::cli {
namespace {

using Json = nlohmann::ordered_json;

struct WordList {
  const char* key;
  const char* title;
  std::vector<EffectWord> words;
};

std::vector<WordList> word_lists() {
  return {{"targets", "Targets: what an effect acts on", effect_words(NamePart::Target)},
          {"drivers", "Drivers: what it depends on", effect_words(NamePart::Driver)},
          {"shapes", "Shapes: how it depends on it", effect_words(NamePart::Shape)},
          {"variables",
           "Variables of the scans without a catalogue (\"unknown\" in diagnosis.json)",
           {scan_words().begin(), scan_words().end()}}};
}

std::string words_text(const WordList& list) {
  std::string text = fmt::format("\n{}\n", list.title);
  for (const EffectWord& word : list.words) {
    const std::string_view more = word.kind.ends_with('-') ? "..." : "";
    const std::string only = word.kind.empty() ? "" : fmt::format(" ({}{})", word.kind, more);
    text += fmt::format("    {:<24} {}{}\n", word.pattern, word.meaning, only);
  }
  return text;
}

Json words_json(const std::vector<EffectWord>& words) {
  Json json = Json::array();
  for (const EffectWord& word : words) {
    json.push_back({{"name", word.pattern}, {"meaning", word.meaning}});
    if (!word.kind.empty()) json.back()["kind"] = word.kind;
  }
  return json;
}

Json keys_json(const EffectSchema& schema) {
  Json keys = Json::array();
  for (const KeySchema& key : schema.keys) {
    keys.push_back({{"key", key.key}, {"required", key.required}, {"help", key.help}});
    if (!key.choices.empty()) keys.back()["choices"] = key.choices;
  }
  return keys;
}

}  // namespace

std::vector<std::string> testable_effects(const Campaign& campaign, const ModelSpec& spec) {
  const MeasurementModel model(campaign, resolve_knots(spec, campaign));
  std::set<EffectName> present;
  for (const EffectBinding& each : model.binding().effects) present.insert(each.effect->name());
  std::vector<std::string> names;
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& candidate : kind->candidates(campaign)) {
      const EffectName name = kind->make(candidate, {})->name();
      if (!present.contains(name)) names.push_back(full_name(name));
    }
  }
  for (const LeftOutError& error : left_out_errors(model)) names.push_back(full_name(error.effect->name()));
  for (const ErrorSymbol symbol : model.layout().symbols())
    names.push_back(full_name(resolution_name(symbol)));
  return names;
}

std::string effect_list_text(const std::vector<std::string>& testable) {
  std::string text =
      "Effects are called KIND:TARGET:DRIVER:SHAPE. Words in capitals stand for names of your files.\n\n";
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSchema& schema = kind->schema();
    text += fmt::format("{}\n  {}\n  source: {}\n", schema.kind, schema.summary, schema.source);
    for (const KeySchema& key : schema.keys) text += fmt::format("    {:<24} {}\n", key.key, key.help);
  }
  for (const ModelChange& change : model_change_kinds())
    text += fmt::format("{}\n  {}\n", change.kind, change.summary);
  for (const WordList& list : word_lists()) text += words_text(list);
  text += fmt::format("\nDirections of these scans: {}\n", fmt::join(kScanDirectionNames, ", "));
  if (testable.empty()) return text;
  text += fmt::format("\nTested in this campaign: {} effects and changes of the model\n", testable.size());
  for (const std::string& name : testable) text += "    " + name + "\n";
  return text;
}

std::string effect_list_json(const std::vector<std::string>& testable, const std::vector<Finding>& notes) {
  Json json = {{"format", "volcal-effects-1"}, {"kinds", Json::array()}};
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSchema& schema = kind->schema();
    json["kinds"].push_back({{"kind", schema.kind},
                             {"summary", schema.summary},
                             {"source", schema.source},
                             {"keys", keys_json(schema)}});
  }
  json["model_changes"] = Json::array();
  for (const ModelChange& change : model_change_kinds()) {
    json["model_changes"].push_back({{"kind", change.kind}, {"summary", change.summary}});
  }
  for (const WordList& list : word_lists()) json[list.key] = words_json(list.words);
  json["directions"] = kScanDirectionNames;
  if (!testable.empty()) json["testable"] = testable;
  add_notes(notes, json);
  return json_text(json, 2) + "\n";
}

}  // namespace volcal::cli
