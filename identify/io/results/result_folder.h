#pragma once
/// The folder that `fit` writes, and reading it again.

#include <map>
#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"

namespace volcal {

/// Points per axis of volumetric_grid.csv.
inline constexpr int kGridPointsPerAxis = 5;

/// Writes result.json, error_tables.csv, volumetric_grid.csv, residuals.csv, identified.toml, machine.toml
/// and `more` (name -> content: report.html); the folder is replaced as a whole (atomic_folder.h). Throws
/// InputError.
void write_result_folder(const FitResult& result, const Campaign& campaign, const std::string& target,
                         const std::map<std::string, std::string>& more = {});

/// Reads result.json of a result folder (or the file itself). `residuals` stays empty: they are in
/// residuals.csv. `named_at`: the line of a file that names it. Throws InputError.
FitResult read_result(const std::string& path, const SourcePlace& named_at = {});

/// True when `path` is a folder that holds a result.json, or such a file.
bool is_result(const std::string& path);

}  // namespace volcal
