#pragma once
/// A folder of superimposed tables keeps those that they stand in place of (ISO/TR 16907:2015, 10.5) below
/// superimposed_on/tables, and in superimposed_on/metadata.csv what was active while the errors were
/// identified that the new ones were made from.

#include <span>
#include <string>

#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/table_text.h"

namespace volcal {

inline constexpr const char* kFormerFolder = "superimposed_on";
inline constexpr const char* kFormerTables = "superimposed_on/tables";
inline constexpr const char* kFormerMetadata = "superimposed_on/metadata.csv";

/// Puts the former tables into the folder of those that replace them. `active_compensations`: those of the
/// errors that the new tables were made from.
void keep_former_tables(std::span<const TableFile> former, const std::string& active_compensations,
                        const AtomicFolder& folder);

/// `active_compensations` as keep_former_tables() wrote them. Throws InputError where the file lacks them.
std::string active_before_former_tables(const TableFile& metadata);

}  // namespace volcal
