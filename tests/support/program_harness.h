#pragma once
/// The NC interpreter and rewriter on any text: a program whose rewriting goes where it should, or
/// InputError.

#include <cstdint>
#include <stdexcept>
#include <string>

#include "tests/support/nc_programs.h"
#include "tests/support/reader_harness.h"

namespace volcal::testing {

/// A program with everything that is followed.
inline std::string sample_program() {
  return "%\n(sample)\nN1 G21 G90 G17 G94 G98 G40 G49 G80\nF500 S1000 M3\nT1 M6\nG43 H1\nG0 X10 Y10 Z20\nG1 "
         "Z-1\n"
         "X35.5 Y12.25\nG2 X45 Y12.25 I4.75 J0\nG3 X40 Y10 R20\nG18 G2 X45 Z2 R8\nG19 G3 Y12 Z5 R4\nG17 "
         "G91 G1 X1 Y-1\n"
         "G90 G90.1 G2 X46 Y11 I50 J11\nG91.1\nG93 G1 X10 F2\nG94\nF200\nG95\nF0.1\nG94\nF200\nG81 X5 Y5 "
         "Z-3 R2\nG80\nG83 "
         "X6 Z-4 R2 Q1.5\nG73 X7 Z-4 R2 Q1.5\nG99 G82 X8 Z-3 R2 P0.1\nG89 X9 Z-3 R2\nG80\nG4 P0.5\nG52 X1 "
         "Y1\nG0 "
         "X0\nG52 X0 "
         "Y0\nG10 L2 P2 X1 Y2 Z3\nG55 G0 X1\nG53 G0 Z0\nG20\nG0 X1\n/G0 X2\nM1\nG49\nG43.1 Z1\nM30\n%\n";
}

inline std::string sample_local_program() {
  return "G21\nF100\nG0 X5\nG92 X0 Y1\nG1 X2\nG92.2\nG1 X1\nG92.3\nG1 X3\nG92.1\nG2 I1 P2\nM2\n";
}

/// Errors far above the tolerance everywhere, with a corner and a lost motion.
inline const ProgramErrors& harness_errors() {
  static const ProgramErrors errors = errors_with(
      [](const AxisPosition& q, const ApproachDirection& d) {
        return Eigen::Vector3d(2e-4 + 1e-3 * q[0] + 1e-4 * d[0], -3e-4 + 2e-3 * q[0] * q[1],
                               1e-3 * std::abs(q[0]));
      },
      {std::vector<double>{-1.0, 0.0, 1.0}, {}, {}});
  return errors;
}

/// Rewrites the program; the check must find every place of it within the tolerance. Throws InputError for
/// what is refused, std::logic_error for a wrong rewriting.
inline void rewrite_and_check(const std::string& text, unsigned choice) {
  NcSetup setup = simple_setup();
  setup.tool_lengths = {{1, 0.05}};
  setup.work_offsets[1] = Eigen::Vector3d(0.01, 0.02, 0.03);
  if ((choice & 1U) != 0) setup.start.reset();
  if ((choice & 2U) != 0) setup.block_delete = (choice & 4U) != 0;
  NcRewriteOptions options;
  options.tolerance = options.arc_tolerance = 20e-6;
  NcRewriter rewriter(harness_errors(), setup, {}, options, "part.ngc");
  NcCheck check(harness_errors(), setup, {});
  std::size_t written_size = 0;
  for (const std::string& line : program_lines(text)) {
    rewriter.rewrite(line, [&](std::string_view original, std::span<const NcWrittenLine> written) {
      check.add(original, written);
      for (const NcWrittenLine& each : written) written_size += each.text.size();
    });
    constexpr std::size_t kEnough = 1 << 22;
    if (written_size > kEnough) break;
  }
  // Tolerances of path and chords, rounding to 0.1 um, and to 0.25 um in inches.
  if (check.after().max > 42e-6) throw std::logic_error("the rewritten program leaves its tolerance");
}

/// True when the program was accepted.
inline bool accepts_program(const std::string& text, unsigned choice) {
  return accepts([&] { rewrite_and_check(text, choice); });
}

}  // namespace volcal::testing
