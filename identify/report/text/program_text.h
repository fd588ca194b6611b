#pragma once
/// What `volcal compensate` did, as text and JSON.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "volcal/identify/program/nc_check.h"
#include "volcal/identify/program/tcp_rewriter.h"

namespace volcal {

/// Errors along a program before and after.
struct ProgramCheck {
  PathErrors before;
  PathErrors after;
  double length = 0.0;  ///< of feed motions, m
};

std::string program_summary_text(const NcRewriteSummary& summary);
std::string program_check_text(const ProgramCheck& check);
nlohmann::ordered_json program_json(const NcRewriteSummary& summary,
                                    const std::optional<ProgramCheck>& check);

/// Of programs with tool centre point motion; `checked`: its figures of errors were filled.
std::string tcp_summary_text(const TcpSummary& summary, bool checked);
nlohmann::ordered_json tcp_summary_json(const TcpSummary& summary, bool checked);

}  // namespace volcal
