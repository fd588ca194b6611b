#include "volcal/identify/criticism/model_extension.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/model/effects/driver_check.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// `as`: what the model calls it, where that is another name.
[[noreturn]] void refuse_known(const ModelSpec& model, int line, const std::string& what,
                               const std::string& as, const ExtensionWords& words) {
  throw InputError({model.file, line},
                   "the model has " + what + " already" + (as == what ? "" : ", as " + as),
                   words.remedy_if_known);
}

void require_axis(const ModelToExtend& extended, AxisName axis, const ExtensionWords& words) {
  if (extended.machine.has_axis(axis)) return;
  throw InputError({extended.model.file, 0},
                   words.label + " acts on an axis that the model's machine does not have",
                   words.remedy_if_absent);
}

void give_back(const ModelToExtend& extended, const EffectSpec& spec, const ExtensionWords& words) {
  const std::vector<MachineError> errors = errors_given_back(spec);
  for (const MachineError& error : errors) {
    if (const auto axis = error.axis()) require_axis(extended, *axis, words);
  }
  const bool lacks_one = std::ranges::any_of(
      errors, [&](const MachineError& error) { return is_left_out(error, extended.model); });
  if (!lacks_one) {
    const std::string symbols = *spec.options.text("symbol");
    refuse_known(extended.model, 0, symbols, symbols, words);
  }
  restore_left_out(spec, extended.machine, extended.model);
}

/// Of an error left out alone and of several left out together one can be given back by the other.
bool is_given_back(const EffectSpec& spec, const ModelSpec& model) {
  return spec.kind == kLeftOut &&
         std::ranges::none_of(errors_given_back(spec),
                              [&](const MachineError& error) { return is_left_out(error, model); });
}

/// By its name, or by a label: an expression may say what an effect of the catalogue says.
bool is_same(const Effect& known, const Effect& effect) {
  if (known.name() == effect.name()) return true;
  return std::ranges::any_of(effect.amplitudes(), [&](const EffectAmplitude& amplitude) {
    return std::ranges::find(known.amplitudes(), amplitude.label, &EffectAmplitude::label) !=
           known.amplitudes().end();
  });
}

}  // namespace

void require_not_known(const ModelSpec& model, const Effect& effect, const ExtensionWords& words) {
  for (const EffectSpec& present : model.effects) {
    const EffectKind* kind = find_effect(present.kind);
    if (kind == nullptr) continue;
    const std::unique_ptr<Effect> known = kind->make(present, model.file);
    if (is_same(*known, effect))
      refuse_known(model, present.source_line, words.label, effect_label(*known), words);
  }
}

std::unique_ptr<Effect> extend_model(const ModelToExtend& extended, const EffectSpec& spec,
                                     const ExtensionWords& words) {
  if (spec.kind == kLeftOut) {
    give_back(extended, spec, words);
    return nullptr;
  }
  ModelSpec& model = extended.model;
  const EffectKind* kind = find_effect(spec.kind);
  if (kind == nullptr) {
    throw InputError(words.place, words.label + " is of a kind of effect that this program does not know",
                     "volcal diagnose --list prints all kinds");
  }
  std::unique_ptr<Effect> effect = kind->make(spec, words.place.file);
  require_not_known(model, *effect, words);
  if (extended.campaign != nullptr) effect->check(*extended.campaign, words.place);
  for (const EffectTerm& term : effect->terms()) {
    if (term.target.kind == TargetKind::Motion) require_axis(extended, term.target.symbol.axis, words);
  }
  if (extended.campaign != nullptr) check_drivers_vary(*extended.campaign, *effect, words.place);
  model.effects.push_back(spec);
  return effect;
}

namespace {

void add_new(const EffectFinding& effect, std::vector<EffectFinding>& accepted) {
  if (std::ranges::find(accepted, effect.name, &EffectFinding::name) == accepted.end())
    accepted.push_back(effect);
}

/// `instead`: of a set, by its place, the member in the place of the chosen one. What is in two sets enters
/// once.
std::vector<EffectFinding> accepted_with(const Diagnosis& diagnosis,
                                         const std::map<std::size_t, std::size_t>& instead) {
  std::vector<EffectFinding> accepted = diagnosis.effects;
  const auto sets = sets_of_alternatives(diagnosis);
  for (std::size_t i = 0; i < std::min(sets.size(), diagnosis.sets.size()); ++i) {
    const auto other = instead.find(i);
    if (other != instead.end()) {
      add_new((*sets[i])[other->second], accepted);
    } else if (const auto chosen = diagnosis.sets[i].chosen) {
      add_new((*sets[i])[*chosen], accepted);
    }
  }
  std::ranges::move(drawn_effects(diagnosis), std::back_inserter(accepted));
  return accepted;
}

}  // namespace

ModelSpec extended_model(ModelSpec model, const Campaign& campaign,
                         const std::vector<EffectFinding>& effects) {
  for (const EffectFinding& effect : effects) {
    if (is_given_back(effect.spec, model)) continue;
    extend_model({model, campaign.machine, &campaign}, effect.spec,
                 {.label = effect.label,
                  .remedy_if_known = "diagnose the campaign with a model without it",
                  .remedy_if_absent = "diagnose the campaign with a model of its machine"});
  }
  return model;
}

std::vector<EffectFinding> accepted_effects(const Diagnosis& diagnosis) {
  return accepted_with(diagnosis, {});
}

std::vector<OfferedModel> offered_models(const ModelSpec& model, const Campaign& campaign,
                                         const Diagnosis& diagnosis) {
  std::vector<OfferedModel> models{{"extended.toml",
                                    "the given model with the effects that volcal diagnose added",
                                    extended_model(model, campaign, accepted_effects(diagnosis))}};
  const auto sets = sets_of_alternatives(diagnosis);
  for (std::size_t i = 0; i < std::min(sets.size(), diagnosis.sets.size()); ++i) {
    for (std::size_t k = 0; k < sets[i]->size(); ++k) {
      const EffectFinding& member = (*sets[i])[k];
      if (k == diagnosis.sets[i].chosen || member.resolution) continue;
      models.push_back({alternative_model_file(i, k),
                        "as extended.toml, with " + member.label +
                            " in the place of what the readings do not tell from it",
                        extended_model(model, campaign, accepted_with(diagnosis, {{i, k}}))});
    }
  }
  return models;
}

}  // namespace volcal
