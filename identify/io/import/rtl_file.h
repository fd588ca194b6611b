#pragma once
/// Laser files `.rtl`: targets, and deviations of several runs over them.
///
/// Text of sections, each begun by a line NAME:: (HEADER, TARGET DATA, USER-TEXT, RUNS, DEVIATIONS,
/// ENVIRONMENT, EQUIPMENT, EOF) and made of lines "key : value". `Target-count` and `Targets` give the
/// commanded positions, mm; `Run-count` the number of runs; below `Run Target Data` stand rows of run, target
/// (both from 1) and deviation, measured minus target. Line ends CRLF or LF, decimal point or comma. The unit
/// of the deviations is not stated, nor is the direction of a run whose rows are sorted by target.

#include <string>
#include <vector>

#include "volcal/identify/io/import/import_format.h"

namespace volcal {

struct LaserEntry {
  std::string section;
  std::string key;  ///< empty: a line without a colon
  std::string value;
  int line = 0;
};

struct LaserDeviation {
  int run = 0;     ///< from 1
  int target = 0;  ///< from 1
  double value = 0.0;
  int line = 0;
};

/// Once over all targets, in the order of the file.
struct LaserPass {
  int run = 0;
  bool ascending = true;  ///< by the number of the target
  std::vector<LaserDeviation> readings;
};

struct LaserFile {
  std::vector<LaserEntry> entries;
  std::vector<double> targets_mm;  ///< strictly monotone, two at least
  std::vector<LaserPass> passes;
  bool decimal_comma = false;

  /// The first entry that has a value and whose key is one of `keys`, in lower case; null = none.
  const LaserEntry* find(const std::vector<std::string>& keys) const;
};

/// Throws InputError with the line of what is not understood, of a run that is not complete, of counts that
/// do not fit, of a decimal sign that stays open (SeenSigns).
LaserFile parse_rtl(const ImportSource& source);

}  // namespace volcal
