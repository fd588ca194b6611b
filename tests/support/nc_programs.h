#pragma once
/// NC programs in tests: run, rewritten and checked as texts.

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/machines.h"
#include "tests/support/refusal.h"
#include "volcal/identify/program/nc_check.h"
#include "volcal/model/description/errors.h"

namespace volcal::testing {

/// Lines with their line ends.
inline std::vector<std::string> program_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = text.find('\n', from);
    const std::size_t stop = end == std::string::npos ? text.size() : end + 1;
    lines.push_back(text.substr(from, stop - from));
    from = stop;
  }
  return lines;
}

/// G54 at the origin, in mm, axes at 0: machine coordinates are program coordinates.
inline NcSetup simple_setup() {
  NcSetup setup;
  setup.work_offsets[0] = Eigen::Vector3d::Zero();
  setup.start = Eigen::Vector3d::Zero();
  setup.length_unit = 1e-3;
  return setup;
}

inline std::vector<NcMotion> motions_of(const std::string& program, const NcSetup& setup = simple_setup()) {
  NcInterpreter interpreter(setup, "part.ngc");
  std::vector<NcMotion> motions;
  const std::vector<std::string> lines = program_lines(program);
  for (const std::string& line : lines) {
    const NcStep& step = interpreter.execute(line);
    motions.insert(motions.end(), step.motions.begin(), step.motions.end());
  }
  return motions;
}

/// A machine of 1 m travel about 0 with this error field, smooth between the ends of `pieces` (m).
inline ProgramErrors errors_with(DisplacementField field,
                                 const std::array<std::vector<double>, 3>& pieces = {}) {
  ProgramErrors errors;
  errors.machine = testing_support::machine_of("w X' b Y Z t");
  for (Axis& axis : errors.machine.axes) axis.travel_min = -1.0;
  errors.field = [field = std::move(field)](const Eigen::Vector3d&) { return field; };
  errors.pieces = pieces;
  return errors;
}

struct Rewritten {
  std::string text;
  std::vector<std::vector<NcWrittenLine>> groups;  ///< by line of the original
  NcRewriteSummary summary;
};

inline Rewritten rewritten(const std::string& program, const ProgramErrors& errors,
                           const NcSetup& setup = simple_setup(), const NcRewriteOptions& options = {},
                           const FunctionalPoint& point = {}) {
  NcRewriter rewriter(errors, setup, point, options, "part.ngc");
  Rewritten result;
  for (const std::string& line : program_lines(program)) {
    rewriter.rewrite(line, [&](std::string_view, std::span<const NcWrittenLine> written) {
      for (const NcWrittenLine& each : written) result.text += each.text;
      result.groups.emplace_back(written.begin(), written.end());
    });
  }
  result.summary = rewriter.summary();
  return result;
}

}  // namespace volcal::testing
