#pragma once
/// Errors of a machine from whatever file states them.

#include <optional>
#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"

namespace volcal {

/// A result of `volcal fit`; a model.toml with values (stated_errors.h); or a folder of `volcal tables
/// --format csv` (error_tables.csv and metadata.csv), the tables linear between their rows, with what differs
/// between the directions of approach as a reversal and its change along the travel, for their tool and their
/// conditions alone (findings_of_tables(), errors_of_tables.h). Throws InputError, also
/// for tables whose directions differ otherwise and for a model that states no value.
FitResult read_known_errors(const std::string& path, const SourcePlace& named_at = {});

/// The campaign's readings in the coordinate system of these errors (adopt_alignment()), which are judged on
/// them; absent where they stand in it. Throws InputError, at `place`, where they are those of another
/// machine.
std::optional<Campaign> readings_for(const Campaign& campaign, const FitResult& errors,
                                     const SourcePlace& place);

/// Whether the path is a folder of `volcal tables --format csv` and no result.
bool is_tables_folder(const std::string& path);

/// The model that a person begins with: model.toml, or what a result of `volcal fit` has identified; all
/// errors where no path is given. Throws InputError.
ModelSpec read_starting_model(const std::string& path, const Machine& machine);

}  // namespace volcal
