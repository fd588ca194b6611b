#pragma once
/// CSV tables of a result folder: error_tables.csv, volumetric_grid.csv, residuals.csv. Edge units (mm, deg,
/// um, urad); truth values are 0 and 1.

#include <string>
#include <vector>

#include "volcal/identify/solve/result.h"
#include "volcal/identify/tables/error_tables.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// symbol,axis,position,position_unit,direction,value,unit,u,U95,extrapolated; value, u and U95 in `unit`.
/// direction: 0 mean of both, 1, -1. Location rows have neither axis nor position.
std::string error_tables_csv(const std::vector<ErrorTableRow>& rows);

/// x_mm,y_mm,z_mm (and a_deg ... as the machine has axes),tool,ex_um ... ec_urad,u_ex_um ...
/// u_ec_urad,extrapolated.
std::string volumetric_grid_csv(const std::vector<VolumetricError>& grid, const Machine& machine);

/// setup,row,reading,predicted,residual_um,sigma_um,standardized,redundancy,w,flagged,column,removed. `row`
/// is the line of the file; reading and predicted are in the unit of `column`; residual and sigma are urad
/// for angles.
std::string residuals_csv_header();
/// Writes the file row by row: a million readings take no memory. Throws InputError when the disk is full.
void write_residuals_csv(const std::string& path, const std::vector<ResidualRecord>& residuals,
                         const Campaign& campaign);
void write_residuals_csv(const std::string& path, const FitResult& result, const Campaign& campaign);

}  // namespace volcal
