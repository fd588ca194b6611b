#pragma once
/// A model together with its machine.

#include <string>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/python/shared/bindings.h"

namespace volcal::python {

struct Model {
  ModelSpec spec;
  Machine machine;
};

/// What is assumed of `machine`: all errors where no model is given. Throws InputError for a model of another
/// machine.
ModelSpec spec_for(const Model* model, const Machine& machine);

/// An effect as a user gives it: "KIND:TARGET[:DRIVER[:SHAPE]]" of what could act in the campaign, a mapping
/// with the keys of an [[effects]] table, or an effect of a diagnosis. Throws InputError.
EffectSpec effect_spec_of(const py::handle& effect, const Machine& machine, const Campaign* campaign);

/// What messages call it.
std::string effect_text(const py::handle& effect);

}  // namespace volcal::python
