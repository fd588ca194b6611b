#pragma once
/// The one way to extend a model: an effect is added, an error that the model leaves out is given back.

#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/data/offered_model.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// What is extended. `campaign`: where the effect has to act; none: only the machine is looked at.
struct ModelToExtend {
  ModelSpec& model;
  const Machine& machine;
  const Campaign* campaign = nullptr;
};

/// What messages say of an effect that is to be added.
struct ExtensionWords {
  std::string label;             ///< "reversal EXX"
  SourcePlace place = {};        ///< where it was given
  std::string remedy_if_known;   ///< where the model has it already
  std::string remedy_if_absent;  ///< where the machine lacks its axis
};

/// Throws InputError with the line of the model file that has the effect, or says the same in other words: an
/// expression "EAY: z", where the model has the effect EAY by z of the catalogue.
void require_not_known(const ModelSpec& model, const Effect& effect, const ExtensionWords& words);

/// Adds the effect `spec` to the model, or gives back the errors that it names (left_out.h). Returns the
/// effect; nothing where errors were given back. Throws InputError, the model unchanged, where
///   the model has it already,
///   its kind is none of the catalogue,
///   it acts on an axis that the machine does not have,
///   the campaign lacks what the effect is about, or the effect's drivers never change there.
std::unique_ptr<Effect> extend_model(const ModelToExtend& extended, const EffectSpec& spec,
                                     const ExtensionWords& words);

/// A model with effects that were found in a campaign. Throws InputError as extend_model() does.
ModelSpec extended_model(ModelSpec model, const Campaign& campaign,
                         const std::vector<EffectFinding>& effects);

/// What a diagnosis adds to a model: its effects, of every set of alternatives the chosen one, and for every
/// surface the leading law or the surface itself.
std::vector<EffectFinding> accepted_effects(const Diagnosis& diagnosis);

/// The given model with these, first, and for every other member of a set that can stand in a model file one
/// with it in the place of the chosen one.
std::vector<OfferedModel> offered_models(const ModelSpec& model, const Campaign& campaign,
                                         const Diagnosis& diagnosis);

}  // namespace volcal
