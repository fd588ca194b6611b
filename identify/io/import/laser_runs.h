#pragma once
/// Runs of a laser over the targets of one axis as readings of a campaign.

#include "volcal/identify/io/import/rtl_file.h"

namespace volcal {

/// Readings in the order in which they were taken: position of the axis that moves, its direction of
/// approach, line (one pass over the targets), run, and the deviation. Where every run lists its targets from
/// the first to the last the file does not say in which direction it went: answers.runs does. Temperatures of
/// the file become columns, but 0, which stands for a sensor that was not there.
ImportedReadings laser_readings(const LaserFile& laser, const ImportSource& source,
                                const ImportAnswers& answers, const Machine& machine);

}  // namespace volcal
