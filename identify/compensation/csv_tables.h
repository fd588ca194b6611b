#pragma once
/// volcal's own tables: errors and compensations per error (ISO/TR 16907:2015, 9.2, both directions as in
/// Table 1) and on a spatial grid (9.3, Table 2), with standard uncertainties, and what clause 9.1 asks to be
/// stated beside them. Absolute values, signs of ISO 841 and ISO 230-1; mm, um, urad, deg in the files.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/errors_of_tables.h"

namespace volcal {

/// Whether a file holds errors or compensations, which are minus the errors.
enum class TableContent { Errors, Compensations };

/// Columns symbol,axis,position,position_unit,direction,value,unit,u,U95,extrapolated; value, u and U95 in
/// `unit`; direction 0 mean of both, 1, -1. Location rows have neither axis nor position. In a file of
/// compensations the column is `compensation`.
std::string function_table_csv(const std::vector<ErrorTableRow>& rows, TableContent content);
/// Rows as they were before writing: errors, whatever the file holds. Throws InputError.
std::vector<ErrorTableRow> read_function_table(const TableFile& file, TableContent content);

/// Columns x_mm,y_mm,z_mm (and a_deg ... as the machine has axes),tool,ex_um ... ec_urad,u_ex_um ...
/// u_ec_urad,extrapolated; dx_um ... dc_urad in a file of compensations.
/// Errors to 0.1 pm or 0.1 prad, positions to 0.1 nm or 1e-7 deg. The rows are made while the file is
/// written.
TableFile spatial_grid_file(std::string name, const FitResult& result, int per_axis,
                            const Conditions& conditions, TableContent content);

/// error_tables.csv and volumetric_grid.csv, which every result folder holds.
std::vector<TableFile> result_tables(const FitResult& result, const TableFormatOptions& options);

/// The options' conditions and tool for the tables of error functions.
ErrorTableOptions function_options(const FitResult& result, const TableFormatOptions& options);

/// Key of metadata.csv: whether the tables hold what former ones corrected, too; these are kept beside them
/// (TableFormatOptions::active).
inline constexpr std::string_view kSuperimposedOn = "superimposed_on", kSuperimposedOnNone = "none",
                                  kSuperimposedOnFormer = "former tables";

/// metadata.csv, key,value: machine, tool, lines, temperatures, run, conditions.
std::string table_metadata_csv(const FitResult& result, const TableFormatOptions& options);
struct TableMetadata {
  Machine machine;        ///< structure, datum, axes, tools
  std::string tool;       ///< empty: the machine has none, the tables are for the spindle reference
  std::string alignment;  ///< empty: as identified
  CompensationType type;  ///< L-VOL in files that do not say
  std::map<std::string, std::string> entries;  ///< every key
  TablesMadeFor made_for;                      ///< of error tables; empty in files that do not say
  RecordedConditions conditions;               ///< those of `made_for`
  /// Of axes of which a part was measured, m or rad; none in files that do not say.
  std::map<AxisName, std::pair<double, double>> measured;
  /// Identified displacement of tools' offsets, m; none in files that do not say.
  std::map<std::string, Eigen::Vector3d> tool_errors;

  /// Their displacement by effects, all axes at home, m; none in files that do not say.
  std::map<std::string, Eigen::Vector3d> tool_effects;

  Eigen::Vector3d tool_offset() const;  ///< of `tool`, m
  Eigen::Vector3d tool_effect() const;  ///< the same of `tool`
};
TableMetadata read_table_metadata(const TableFile& file);

}  // namespace volcal
