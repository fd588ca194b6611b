#pragma once
/// Compensation lists of the ISG kernel's leadscrew error compensation (SSFK), one per axis: Beckhoff, TF5200
/// TwinCAT 3 CNC, Axis compensation, P-COMP-00017 to 00025. Values are actual minus set position in whole
/// numbers of 0.1 um, towards + and towards -, linear between entries, end values held.

#include <span>
#include <vector>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/text/table_text.h"

namespace volcal {

inline constexpr double kSsfkUnit = 1e-7;      ///< m
inline constexpr int kMostSsfkEntries = 1499;  ///< below the 1500 of P-COMP-00059

/// The format of these lists alone; others write them beside their own tables.
const TableFormat& isg_ssfk_format();

/// achskw1.lis to achskw3.lis. `table`: corrections of `axis` by its own position. Throws InputError for
/// lengths beyond 32 bits.
TableFile ssfk_file(AxisName axis, const AxisTable& table);

/// Of all lists among the files; none without one. Throws InputError.
std::vector<CorrectionTerm> ssfk_terms(std::span<const TableFile> files);

}  // namespace volcal
