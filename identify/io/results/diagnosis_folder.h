#pragma once
/// The folder that `diagnose` writes.

#include <map>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/data/offered_model.h"
#include "volcal/model/description/machine.h"

namespace volcal {

/// Writes diagnosis.json, machine.toml, the models that the diagnosis offers
/// and `more` (name -> content: diagnosis.txt, report.html); the folder is replaced as a whole
/// (atomic_folder.h). Throws InputError.
void write_diagnosis_folder(const Diagnosis& diagnosis, const Machine& machine,
                            const std::vector<OfferedModel>& models, const std::string& target,
                            const std::map<std::string, std::string>& more = {});

}  // namespace volcal
