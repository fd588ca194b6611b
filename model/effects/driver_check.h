#pragma once
/// Drivers that the readings record and that never change: nothing can be learnt about their effects.

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// Throws InputError at the first effect of the model whose driver was recorded and has one value in all
/// readings: a direction of approach, a position, a temperature; of an expression, all its variables. A
/// driver that was not recorded is another matter: it contributes nothing, and the fit counts its readings.
void check_drivers_vary(const Campaign& campaign, const ModelSpec& model);
/// The same of one effect; `place`: where it was given.
void check_drivers_vary(const Campaign& campaign, const Effect& effect, const SourcePlace& place);

}  // namespace volcal
