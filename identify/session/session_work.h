#pragma once
/// Work of a session: it reports its stages, and ends where nobody wants it any more.

#include <string>

#include "volcal/identify/session/session.h"

namespace volcal {

/// Throws SessionStopped where `progress` says so.
void report_stage(const SessionProgress& progress, const std::string& stage, double done);

/// Work that is stopped wherever it is, between two items that threads take, not between its stages alone.
SessionWork interruptible(SessionWork work);

}  // namespace volcal
