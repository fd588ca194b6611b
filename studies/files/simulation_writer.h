#pragma once
/// A simulated campaign as the folder that `volcal simulate` leaves, with what is known of it.

#include "volcal/identify/text/atomic_folder.h"
#include "volcal/sim/study.h"

namespace volcal {

/// machine.toml, the campaign, model.toml (cubic splines, automatic knots), and truth/: the validation
/// campaign and error_functions.csv (symbol,axis,position,position_unit,value,unit in the datum of
/// sim/machine/datum.h; squareness and the location errors of rotary axes last with neither axis nor
/// position); of a study that hides something also hidden.json (hidden_answer_writer.h) and the noise-free
/// campaigns unseen/ and unseen_without_hidden/. The caller commits the folder.
void write_simulation(const sim::SimulatedCampaign& simulated, const AtomicFolder& folder);

}  // namespace volcal
