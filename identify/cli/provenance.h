#pragma once
/// What this run of the program writes about itself.

#include "volcal/identify/report/report.h"
#include "volcal/identify/result/result.h"

namespace volcal::cli {

/// To be called first of all.
void remember_command_line(int count, char** arguments);

/// Version, present time and command line. Where the environment sets SOURCE_DATE_EPOCH (seconds since 1970,
/// reproducible-builds.org) that is the time, so that equal runs write equal files. Throws InputError when it
/// is no number.
Provenance provenance();

/// Date and provenance of a report made now.
ReportOptions report_options();

}  // namespace volcal::cli
