#pragma once
/// Programs with tool centre point motion in tests: machines, rewritten texts and their figures.

#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/nc_programs.h"
#include "tests/support/rotary_machines.h"
#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/program/tcp/tcp_check.h"
#include "volcal/identify/program/tcp/tcp_rewriter.h"

namespace volcal::testing {

/// All errors of rotary axes, and of linear ones too. What travels a turn goes round without end: of a head,
/// too, corrections may then pass the half turn at which its travel ends.
inline FitResult five_axis_result(const std::string& structure) {
  Machine machine = rotary_machine(structure);
  for (Axis& axis : machine.axes) {
    if (axis.travels_a_turn()) axis.endless = true;
  }
  GivenErrors given;
  double phase = 0.1;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      phase += 0.6;
      const ErrorSymbol symbol{component, axis.name};
      const double size = is_rotation(component) ? 12e-6 : 4e-6;
      const double wave = is_rotary(axis.name) ? 1.0 : 5.0;
      const double zero = symbol.is_positioning() ? size * std::sin(phase) : 0.0;
      given.functions[symbol.name()] = [=](double q) { return size * std::sin(wave * q + phase) - zero; };
      const bool along = !is_rotation(component) && direction_of(component) == direction_of(axis.name);
      if (is_rotary(axis.name) && !along)
        given.locations[LocationSymbol{component, axis.name}.name()] =
            (is_rotation(component) ? 40e-6 : 15e-6) * std::cos(2.0 * phase);
    }
  }
  return result_with(machine, given, 72);
}

inline constexpr double kToolInHolder = 0.18;           // m
inline const Eigen::Vector3d kWork{0.02, -0.03, 0.02};  // m, G54
inline const Eigen::Vector3d kTcpTool{0.0, 0.0, -kToolInHolder};

inline NcSetup tcp_setup() {
  NcSetup setup;
  setup.work_offsets[0] = kWork;
  setup.tool_lengths[1] = kToolInHolder;
  return setup;
}

struct TcpDone {
  std::string text;
  std::vector<std::vector<NcWrittenLine>> groups;  ///< by line of the original
  TcpSummary summary;
  TcpErrors before, after;
  double length = 0.0;  ///< of feed motions, m
};

inline ErrorsOfOffset tcp_errors(const FitResult& result) {
  return tcp_errors_of(result, result.machine.tools.front().name, default_conditions(result));
}

inline TcpDone tcp_rewritten(const std::string& program, const FitResult& result,
                             TcpRewriteOptions options = {}, const NcSetup& setup = tcp_setup()) {
  const FunctionalPoint point{kTcpTool, Eigen::Vector3d::Zero()};
  TcpRewriter rewriter(result.machine, tcp_errors(result), setup, point, std::move(options), "part.ngc");
  TcpCheck check(result.machine, tcp_errors(result), setup, point);
  TcpDone done;
  for (const std::string& line : program_lines(program)) {
    rewriter.rewrite(line, [&](std::string_view original, std::span<const NcWrittenLine> written) {
      for (const NcWrittenLine& text : written) done.text += text.text;
      done.groups.emplace_back(written.begin(), written.end());
      check.add(original, written);
    });
  }
  done.summary = rewriter.summary();
  done.before = check.before();
  done.after = check.after();
  done.length = check.length();
  return done;
}

}  // namespace volcal::testing
