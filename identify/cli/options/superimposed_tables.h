#pragma once
/// Folders of tables that say what they stand in place of. Superimposed tables (ISO/TR 16907:2015, 10.5) hold
/// what the former ones corrected and what was identified with these active. The folder keeps them below
/// superimposed_on/tables, with what the campaign said of them in superimposed_on/metadata.csv.

#include <string>

#include "volcal/identify/compensation/active_tables.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal::cli {

/// The tables in a folder, by the rules of their controller. Throws InputError.
CompensationTables active_tables(const std::string& folder);

/// Puts the former tables into the folder of those that replace them. `active_compensations`: those of the
/// errors that the new tables were made from.
void keep_former_tables(const std::string& former, const std::string& active_compensations,
                        const AtomicFolder& folder);

/// The tables in a folder, by the rules of their controller, for errors that were identified with
/// `active_compensations`. Tables stand beside these where metadata.csv says that they are superimposed on
/// none and made from errors of the same words. Throws InputError.
ActiveTables active_tables_for(const std::string& folder, const std::string& active_compensations);

}  // namespace volcal::cli
