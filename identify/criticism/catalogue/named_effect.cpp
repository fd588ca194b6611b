#include "volcal/identify/criticism/catalogue/named_effect.h"

#include <set>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

EffectSpec named_effect(const std::string& option, const std::string& text, const Campaign& campaign) {
  const std::vector<std::string> wanted = parts_of(text);
  const EffectKind* kind = find_effect(wanted[0]);
  const std::string usage =
      "write KIND:TARGET, KIND:TARGET:DRIVER or KIND:TARGET:DRIVER:SHAPE; volcal diagnose --list "
      "prints all kinds";
  if (kind == nullptr)
    throw InputError({}, option + " " + text + ": \"" + wanted[0] + "\" is not a kind of effect", usage);
  std::vector<EffectSpec> matching;
  std::string names, all;
  for (const EffectSpec& spec : kind->candidates(campaign)) {
    const EffectName name = kind->make(spec, {})->name();
    const std::string fields[] = {name.kind, name.target.name(), name.driver.name(), name.shape};
    all += (all.empty() ? "" : ", ") + full_name(name);
    bool fits = wanted.size() <= 4;
    for (std::size_t k = 1; fits && k < wanted.size(); ++k)
      fits = wanted[k].empty() || wanted[k] == fields[k];
    if (!fits) continue;
    matching.push_back(spec);
    names += (names.empty() ? "" : ", ") + full_name(name);
  }
  if (matching.size() == 1) return matching.front();
  if (matching.empty()) {
    const bool by_hand = all.empty() && !kind->examples(campaign).empty();
    const std::string remedy = by_hand ? "this kind is written into the model file, as an [[effects]] table"
                               : all.empty() ? "give --campaign: this kind depends on what was recorded"
                                             : "choose one of " + all;
    throw InputError({}, option + " " + text + " names nothing that could act here", remedy);
  }
  throw InputError({}, option + " " + text + " fits " + std::to_string(matching.size()) + " effects",
                   "choose one of " + names);
}

std::vector<EffectSpec> named_effects(const std::string& option, const std::vector<std::string>& texts,
                                      const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  std::set<std::string> named;
  for (const std::string& text : texts) {
    specs.push_back(named_effect(option, text, campaign));
    const std::string name = full_name(find_effect(specs.back().kind)->make(specs.back(), {})->name());
    if (!named.insert(name).second)
      throw InputError({}, option + " names " + name + " twice", "give every effect once");
  }
  return specs;
}

}  // namespace volcal
