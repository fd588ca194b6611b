#pragma once
/// Whether two descriptions are of one machine.

#include <string>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"

namespace volcal {

/// First difference between two machines that makes the errors of one meaningless for the other, in words;
/// empty when there is none. Names, tools and expansions of scales may differ.
std::string machine_difference(const Machine& a, const Machine& b);

/// Throws InputError, at `place`, where a model of the machine `own` is given for `machine` and they differ
/// (machine_difference()).
void require_machine_of_model(const Machine& own, const Machine& machine, const SourcePlace& place);

}  // namespace volcal
