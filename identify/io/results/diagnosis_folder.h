#pragma once
/// The folder that `diagnose` writes.

#include <map>
#include <string>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// Writes diagnosis.json, machine.toml, extended.toml (`extended`: the model with what the diagnosis added)
/// and `more` (name -> content: diagnosis.txt, report.html); the folder is replaced as a whole
/// (atomic_folder.h). Throws InputError.
void write_diagnosis_folder(const Diagnosis& diagnosis, const Machine& machine, const ModelSpec& extended,
                            const std::string& target, const std::map<std::string, std::string>& more = {});

}  // namespace volcal
