#pragma once
/// Files of instruments that become setups of a campaign. A format is one file and one line in
/// import_registry.cpp. It reads what a file says; what the file leaves open is asked for, by the option that
/// answers it, and never guessed in silence.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/text/text_encoding.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/schema.h"

namespace volcal {

/// A file to import, as UTF-8.
struct ImportSource {
  std::string path;
  std::string text;
  std::optional<char> decimal = {};  ///< sign of its numbers, as the user says; absent = the numbers tell
};

/// What the user says of a file, by the options of `volcal import`; absent = not said.
struct ImportAnswers {
  std::optional<TextEncoding> encoding;
  std::optional<std::string> unit;          ///< of deviations, or of the coordinates of points
  std::optional<std::string> runs;          ///< order of the runs: forward, backward, alternating
  std::optional<std::string> axis;          ///< "X": the axis that moves
  std::optional<std::string> measures;      ///< "EYX": the error that a line reads
  std::optional<std::string> angle_unit;    ///< "gon", "deg", "rad"
  std::optional<std::string> horizontal;    ///< "clockwise", "counterclockwise"
  std::optional<std::string> vertical;      ///< "zenith", "elevation"
  std::optional<std::string> columns;       ///< names of the columns of a list without a header
  std::optional<std::string> instrument;    ///< that the readings belong to
  std::optional<ImportSource> nominal;      ///< commanded positions of points, a table by their names
  std::map<AxisName, double> at;            ///< positions of axes, mm or deg
  std::map<std::string, std::string> keys;  ///< of the setup, as campaign.toml has them: key -> TOML value
};

/// One thing known of a file, and who says it.
struct ImportFact {
  std::string what;
  std::string value;
  std::string said_by;  ///< "line 7", "--unit", "guessed"
};

/// A column by its standard name, in the unit of that name.
struct ImportedColumn {
  std::string name;
  std::vector<double> values;
};

/// What a file holds, in the terms of a campaign.
struct ImportedReadings {
  const InstrumentSchema* instrument = nullptr;
  std::map<std::string, std::string> keys;  ///< of the setup: key -> TOML value
  std::vector<ImportedColumn> columns;
  std::vector<std::int64_t> source_line;  ///< 1-based line of each reading
  std::vector<ImportFact> facts;
  bool guessed = false;  ///< facts said by nobody are to be confirmed by the user
};

class ImportFormat {
 public:
  virtual ~ImportFormat() = default;
  virtual std::string_view name() const = 0;     ///< of the option --format
  virtual std::string_view summary() const = 0;  ///< one line
  virtual bool recognises(const ImportSource& source) const = 0;
  /// Throws InputError with the line of what is not understood, and with the option that answers what the
  /// file does not say. `tool`: of the machine, at which the points lie.
  virtual ImportedReadings read(const ImportSource& source, const ImportAnswers& answers,
                                const Machine& machine, std::size_t tool) const = 0;
};

std::span<const ImportFormat* const> import_formats();
/// The format of that name, or without a name the first that recognises the file; of a table that none does,
/// the one for any table, which says the line that is wrong. Throws InputError.
const ImportFormat& import_format_of(const ImportSource& source, const std::optional<std::string>& name);

/// Throws InputError: the file does not say WHAT; `option` answers it.
[[noreturn]] void ask_for(const ImportSource& source, const std::string& what, const std::string& option);
/// One of `choices`; throws InputError that names the option and the choices.
void require_choice(const std::string& option, const std::string& value,
                    const std::vector<std::string>& choices);

/// Column of each axis that stands still, from `--at`. Throws InputError for an axis of the machine that
/// neither moves nor stands in `at`, and for one in `at` that the machine lacks.
void add_standing_axes(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
                       const std::vector<AxisName>& moving, ImportedReadings& readings);
bool varies(const std::vector<double>& positions);
/// What `--at` adds to the positions of an axis that a table lists, mm or deg; 0 = nothing. Throws InputError
/// where the axis does not move.
double shift_of(AxisName axis, const std::vector<double>& positions, const SourcePlace& place,
                const ImportAnswers& answers);
/// "120 mm added to its positions": what `--at` does to an axis that moves.
std::string shift_text(AxisName axis, double shift);
/// Unit of a length, "um", or of an angle, "arcsec", "gon": SI per unit. Nothing where the name is none.
std::optional<double> length_unit(std::string_view name);
std::optional<double> angle_unit(std::string_view name);

}  // namespace volcal
