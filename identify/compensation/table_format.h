#pragma once
/// Table formats: an identified machine as the files that a program or a controller reads, and what that
/// reader makes of them. A new format is one file that defines a `TableFormat` and one line in
/// table_formats.cpp; the command line, its help, the check of what is left in the volume, the fuzzer and the
/// contract tests follow from the registration.

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/text/table_text.h"

namespace volcal {

/// What a controller can hold.
struct CompensationLimits {
  int points_per_table = 0;      ///< positions of one table; 0 = none stated
  double resolution = 0.0;       ///< step of the values in the file, m (or the unit stated by the format)
  bool both_directions = false;  ///< approach towards + and towards - apart
  bool equidistant = false;      ///< positions at one step
  bool sampled = true;           ///< false: no positions, as with skew factors
};

/// A value that only this format asks for: --set NAME=VALUE.
struct TableSetting {
  std::string_view name;
  std::string_view help;       ///< values, unit, what follows
  std::string_view otherwise;  ///< value when it is not given; empty = must be given
  std::string_view example;    ///< one valid value
};

/// What clause 9.1 of ISO/TR 16907:2015 asks to be recorded beside the tables and no result knows.
struct TableRecord {
  std::string run;                                ///< which identification: folder of the result
  std::map<std::string, std::string> conditions;  ///< by one of recordable_conditions()
};
/// Keys of TableRecord::conditions: machine_state, load, feed ...
std::span<const std::string_view> recordable_conditions();

struct TableFormatOptions {
  ErrorTableOptions functions;
  int grid_per_axis = 5;  ///< positions per axis where a format holds volumetric errors of every tool
  CompensationType type = CompensationType::volumetric();
  std::string tool;                   ///< that the compensation is for; empty = the machine's first
  std::optional<AxisPosition> lines;  ///< where the specific lines cross; middle_of_travel() otherwise
  double step = 0.0;                  ///< between positions, m; 0 = the format's own
  double rotary_step = 0.0;           ///< at most, between positions of rotary axes, rad; 0 = default
  std::map<std::string, std::string> settings;  ///< of the format
  std::optional<Conditions> conditions;         ///< default_conditions() when absent
  TableRecord record;
  /// Tables that were active while the machine was measured and that the new ones replace: what they correct
  /// is added to what was identified (ISO/TR 16907:2015, 10.5).
  std::optional<CompensationTables> active;
};

/// Of TableFormatOptions::grid_per_axis.
inline constexpr int kMostGridPerAxis = 301;
/// Of TableFormatOptions::rotary_step that a user states, deg; 0 is allowed too.
inline constexpr double kFinestRotaryStep_deg = 0.01, kCoarsestRotaryStep_deg = 180.0;

struct TableFormat {
  std::string_view name;          ///< as the user writes it: "csv"
  std::string_view summary;       ///< one sentence for the user
  std::string_view source;        ///< which document fixes the format
  std::string_view verified;      ///< on what it was verified, and what of it is not confirmed
  CompensationType supported;     ///< of the linear axes' errors
  CompensationType rotary = {};   ///< of the rotary axes' errors, where any were identified
  bool rigid = false;             ///< holds what single axes do, no error motion that depends on another axis
  bool indivisible = false;       ///< `supported` as a whole only, no part of it
  bool parallel_axes = false;     ///< holds U, V, W: errors or corrections that depend on them
  bool positions_of_own = false;  ///< has positions of its own where neither a step nor a tolerance is given
  std::string_view refusal;       ///< why no other type can be had
  CompensationLimits limits;
  std::span<const TableSetting> settings;
  /// Content of every file, errors turned into what the format holds. The same result gives the same bytes.
  /// Call write_tables(), which checks the options. Throws InputError for what the format cannot hold.
  std::vector<TableFile> (*write)(const FitResult& result, const TableFormatOptions& options);
  /// The files as the controller evaluates them: its interpolation, its quantisation, its sign. Throws
  /// InputError with file, line and remedy.
  CompensationTables (*read)(std::span<const TableFile> files);
  /// Step that is written for the one asked for, where the format has not every step; null otherwise.
  double (*step_of)(const TableFormatOptions& options) = nullptr;
};

std::span<const TableFormat* const> table_formats();
const TableFormat* find_table_format(std::string_view name);  ///< nullptr when unknown
/// Adds a format of the program's own, which lives as long as the program; call it before the library is
/// used. Throws std::invalid_argument for no name, one that is taken, and a format that does not write and
/// read.
const TableFormat& register_table_format(std::unique_ptr<const TableFormat> format);
std::vector<std::string> table_format_names();

/// A controller whose tables are not written, and why.
struct RefusedFormat {
  std::string_view name;
  std::string_view reason;
};
std::span<const RefusedFormat> refused_table_formats();

/// All that the format can do of this machine: rotary types where errors of rotary axes were identified.
CompensationType default_type(const TableFormat& format, const FitResult& result);

/// Throws InputError for a type or a setting that the format does not have, and where the active tables
/// correct something that the type does not hold and would be lost.
void check_table_options(const TableFormat& format, const FitResult& result,
                         const TableFormatOptions& options);
std::vector<TableFile> write_tables(const TableFormat& format, const FitResult& result,
                                    const TableFormatOptions& options);
std::size_t bytes_of(std::span<const TableFile> files);
/// What tables may take together where their steps are chosen.
inline constexpr std::size_t kMostTableBytes = 30'000'000;

/// Value of a setting, given or declared.
std::string table_setting(std::span<const TableSetting> settings, const TableFormatOptions& options,
                          std::string_view name);
/// As a number. Throws InputError.
double table_setting_number(std::span<const TableSetting> settings, const TableFormatOptions& options,
                            std::string_view name);

/// Whether a setting is the first of two words. Throws InputError for another; where it must be given and is
/// not, it is something about the controller that is not confirmed publicly.
bool is_first_word(std::span<const TableSetting> settings, const TableFormatOptions& options,
                   std::string_view name, std::string_view first, std::string_view second);

/// The tool that the options name. Throws InputError.
const Tool& tool_of(const Machine& machine, const TableFormatOptions& options);
/// The conditions that the tables hold for.
Conditions conditions_of(const FitResult& result, const TableFormatOptions& options);
/// Errors that tables must correct: those identified, and those that the active tables correct.
DisplacementField errors_to_correct(const FitResult& result, const TableFormatOptions& options);
/// Where the specific lines cross.
AxisPosition lines_of(const Machine& machine, const TableFormatOptions& options);
/// The ideal compensation.
Compensation ideal_compensation(const FitResult& result, const TableFormatOptions& options);
/// What a format samples of it: the ideal compensation, or of a format without coupled axes the nearest that
/// a rigid body has.
Compensation sampled_compensation(const TableFormat& format, const FitResult& result,
                                  const TableFormatOptions& options);
/// Whether the errors to correct are sums of terms of two axes each (plane_tables.h).
bool is_of_two_axes(const FitResult& result, const TableFormatOptions& options);
/// Throws InputError where a table would be longer than the controller's.
void require_points(const TableFormat& format, const Axis& axis, std::size_t points);

}  // namespace volcal
