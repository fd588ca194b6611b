#pragma once
/// Folders of tables, by the rules of their controller, and what they stand in place of
/// (io/results/former_tables.h).

#include <string>

#include "volcal/identify/compensation/active_tables.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal::cli {

/// The tables in a folder, by the rules of their controller. Throws InputError.
CompensationTables active_tables(const std::string& folder);

/// Puts the tables of the folder `former` into the folder of those that replace them. `active_compensations`:
/// those of the errors that the new tables were made from.
void keep_former_folder(const std::string& former, const std::string& active_compensations,
                        const AtomicFolder& folder);

/// The tables in a folder, by the rules of their controller, for errors that were identified with
/// `active_compensations`. Tables stand beside these where metadata.csv says that they are superimposed on
/// none and made from errors of the same words. Throws InputError.
ActiveTables active_tables_for(const std::string& folder, const std::string& active_compensations);

}  // namespace volcal::cli
