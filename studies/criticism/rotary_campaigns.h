#pragma once
/// Campaigns of machines with rotary axes for the study of model criticism: linear axes by a tracer with the
/// rotary axes at home, rotary axes by spheres over all combinations of their positions. m, rad.

#include <span>
#include <string>

#include "volcal/model/description/model_spec.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/study.h"

namespace volcal::studies {

/// Kinds of sim/ that are hidden in rotary axes, all of them in the catalogue.
std::span<const std::string> rotary_kinds();

/// The four structures of five_axis_machines.h take turns.
Machine rotary_machine(int index);

/// Appends both measurements, `readings` in all, about, two thirds of them components of the spheres.
void measure_rotary_axes(sim::Study& study, int readings, const sim::NoiseLevel& noise);

/// With all keys drawn from plausible ranges; `study` holds machine, environment and measurements already.
sim::HiddenEffect random_rotary_effect(const std::string& kind, const sim::Study& study,
                                       sim::RandomStream& random);

/// A model that knows linear axes alone: error motions and location errors of rotary axes are zero.
ModelSpec without_rotary_errors(const Machine& machine);

}  // namespace volcal::studies
