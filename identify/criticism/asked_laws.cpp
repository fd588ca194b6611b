#include "volcal/identify/criticism/asked_laws.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/formulas/formula_search.h"
#include "volcal/model/description/errors.h"
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

}  // namespace volcal
