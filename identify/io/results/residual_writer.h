#pragma once
/// residuals.csv of a result folder and of a comparison. Edge units (mm, deg, um, urad); truth values are 0
/// and 1.

#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// setup,row,reading,predicted,residual_um,sigma_um,standardized,redundancy,w,flagged,column,removed. `row`
/// is the line of the file; reading and predicted are in the unit of `column`; residual and sigma are urad
/// for angles.
std::string residuals_csv_header();
/// Writes the file row by row: a million readings take no memory. Throws InputError when the disk is full.
void write_residuals_csv(const std::string& path, const std::vector<ResidualRecord>& residuals,
                         const Campaign& campaign);
void write_residuals_csv(const std::string& path, const FitResult& result, const Campaign& campaign);

}  // namespace volcal
