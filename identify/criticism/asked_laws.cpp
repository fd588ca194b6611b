#include "volcal/identify/criticism/asked_laws.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/formulas/formula_search.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect.h"
#include "volcal/model/effects/kinds/open/empirical.h"

namespace volcal {
namespace {

constexpr const char* kOfModel = "model";

std::vector<EffectSpec> taken_out(ModelSpec& model, const std::function<bool(const EffectSpec&)>& is_wanted) {
  std::vector<EffectSpec> taken;
  std::ranges::copy_if(model.effects, std::back_inserter(taken), is_wanted);
  std::erase_if(model.effects, is_wanted);
  return taken;
}

/// "surface EZZ by x y"
std::string label_of(const EffectSpec& surface, const ModelSpec& model) {
  return effect_label(*empirical_effect().make(surface, model.file));
}

std::vector<std::string> surface_labels(const ModelSpec& model) {
  std::vector<std::string> labels;
  for (const EffectSpec& effect : model.effects) {
    if (is_surface(effect)) labels.push_back(label_of(effect, model));
  }
  return labels;
}

bool is_listed(const std::string& label, const std::vector<std::string>& labels) {
  return std::ranges::find(labels, label) != labels.end();
}

}  // namespace

std::vector<EffectSpec> asked_laws(const std::string& text, ModelSpec& model) {
  if (text == kOfModel) {
    std::vector<EffectSpec> surfaces =
        taken_out(model, [](const EffectSpec& effect) { return is_surface(effect); });
    if (surfaces.empty())
      throw InputError({model.file, 0}, "--formula model: the model has no effect of kind \"empirical\"",
                       "give a model that has one with --model, or write --formula \"TARGET: DRIVERS\"");
    return surfaces;
  }
  const EffectSpec asked = written_surface("--formula", text);
  std::vector<EffectSpec> surfaces = taken_out(model, [&asked](const EffectSpec& effect) {
    return is_surface(effect) && is_same_function(effect, asked);
  });
  if (surfaces.empty()) surfaces = {asked};
  return surfaces;
}

std::optional<Finding> surfaces_taken_out(const ModelSpec& given, const ModelSpec& criticised) {
  const std::vector<std::string> kept = surface_labels(criticised);
  std::vector<std::string> taken = surface_labels(given);
  std::erase_if(taken, [&kept](const std::string& label) { return is_listed(label, kept); });
  if (taken.empty()) return std::nullopt;
  return Finding{FindingCode::DiagnosisWithoutSurfaces, {{"effects", taken}}};
}

std::vector<std::string> take_out_surfaces(const Diagnosis& diagnosis, ModelSpec& model) {
  std::vector<std::string> taken;
  for (const Finding& finding : diagnosis.findings) {
    if (finding.code != FindingCode::DiagnosisWithoutSurfaces) continue;
    const std::vector<std::string> absent = finding.texts("effects");
    const auto surfaces = taken_out(model, [&](const EffectSpec& effect) {
      return is_surface(effect) && is_listed(label_of(effect, model), absent);
    });
    for (const EffectSpec& surface : surfaces) taken.push_back(label_of(surface, model));
  }
  return taken;
}

}  // namespace volcal
