#pragma once
/// What `volcal compensate` did, as text and JSON.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/program/nc_check.h"
#include "volcal/identify/program/tcp/tcp_check.h"
#include "volcal/identify/program/tcp/tcp_rewriter.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/finding.h"

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

/// Errors along a program with tool centre point motion before and after.
struct TcpProgramCheck {
  TcpErrors before;
  TcpErrors after;
  double length = 0.0;  ///< of the path of the functional point in feed motions, m
};

std::string tcp_summary_text(const TcpSummary& summary, const std::optional<TcpProgramCheck>& check);
nlohmann::ordered_json tcp_summary_json(const TcpSummary& summary,
                                        const std::optional<TcpProgramCheck>& check);

/// What is to be said of the errors that a program is rewritten by.
struct ProgramFindings {
  std::vector<Finding> not_compensated;
  std::vector<Finding> invisible;
  std::vector<Finding> of_tables;
  std::vector<Finding> contradicted;

  /// In the order in which they are told.
  std::vector<Finding> all() const;
};

/// `tool`: corrected while no tool length is active, empty = the first. `with_rotary_axes`: their errors are
/// corrected, too, as with tool centre point motion.
ProgramFindings program_findings(const FitResult& result, const std::string& tool, bool with_rotary_axes);
/// Adds them, and the conditions that the errors are stated for.
void add_program_findings(const ProgramFindings& findings, const FitResult& result,
                          const Conditions& conditions, nlohmann::ordered_json& json);

}  // namespace volcal
