#pragma once
/// A measuring campaign: setups, each with an instrument, a tool and its readings. Plain data, SI units.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/finding.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/schema.h"

namespace volcal {

/// Readings of one setup, by columns. Columns that the file lacks are empty; others have `size()` entries.
struct Readings {
  std::array<std::vector<double>, kAxisCount>
      position;                            ///< commanded, m or rad; filled for the machine's axes
  std::vector<std::vector<double>> value;  ///< [channel][row], SI, order of the column set
  std::size_t column_set = 0;              ///< which of the instrument's column sets was found
  std::vector<std::vector<double>> given;  ///< [given column of the set][row], SI; known, no observations
  std::vector<double> sigma;               ///< m or rad; replaces the setup's noise
  std::array<std::vector<std::int8_t>, kAxisCount> direction;  ///< -1, 0 (unknown), +1
  std::vector<double> time;                                    ///< s, campaign clock
  std::vector<std::int32_t> line;                              ///< id of one pass, unique within the setup
  std::vector<std::int32_t> run;
  std::vector<double> feed;                                ///< m/s
  std::map<std::string, std::vector<double>> temperature;  ///< degC, by channel
  std::vector<std::int64_t> source_line;                   ///< 1-based line of the file

  std::size_t size() const { return source_line.size(); }
  std::size_t channels() const { return value.size(); }
  /// By axis, m or rad; 0 for axes without a column.
  std::array<double, kAxisCount> commanded_position(std::size_t row) const;
};

/// A reading known to be wrong: no adjustment and no figure rests on it.
struct LeftOutReading {
  std::size_t row = 0;
  std::size_t channel = 0;
  std::string reason;
};

struct Setup {
  std::string name;
  std::string instrument;
  std::size_t tool = 0;    ///< index into Machine::tools
  std::string data;        ///< path as resolved; empty when made in memory
  int source_line = 0;     ///< of the [[setups]] table in the campaign file
  Options options;         ///< keys of the instrument's schema, SI
  Options noise;           ///< `noise` table: constant (m), per_metre (m per m), constant of angles (rad) ...
  bool has_noise = false;  ///< a noise table, campaign-wide or of the setup, applies
  double repeatability = 0;  ///< m, per component along the reading
  Readings readings;
  std::vector<LeftOutReading> left_out;  ///< by row and channel, each once

  /// Per row: every channel is left out.
  std::vector<bool> rows_left_out() const;
};

struct Campaign {
  std::string file;
  Machine machine;
  std::vector<Setup> setups;
  std::string active_compensations =
      {};  ///< of the control while it was measured, in words; empty = not stated

  std::vector<Finding> notes = {};  ///< what was noticed while it was read

  std::size_t reading_count() const;  ///< observations: rows times channels, over all setups
};

/// Whether the words of active_compensations name some: not where nothing is stated, nor "none".
bool names_compensations(std::string_view active);

}  // namespace volcal
