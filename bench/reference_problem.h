#pragma once
/// The reference problem of the benchmarks: six laser-tracer set-ups on one grid of a three-axis machine,
/// cubic B-splines with 129 free error parameters, and 24 nuisance parameters (six stations and dead paths).
/// The readings are the model's own predictions for random errors, with noise; stations are guessed 2 mm off.

#include <array>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal::bench {

struct ReferenceProblem {
  Campaign campaign;
  ModelSpec model;
};

/// `grid`: positions along X, Y and Z; each set-up reads all of them. The same grid gives the same problem to
/// the bit.
ReferenceProblem reference_problem(const std::array<int, 3>& grid);

/// EAY by the product of y and z: an effect that makes the error motion of an axis depend on another.
EffectSpec coupling();

}  // namespace volcal::bench
