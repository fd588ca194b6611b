/// Throughput of `volcal compensate` on a finishing pass of short straight blocks, which need no splitting:
/// program_bench [--lines N] [--step MM]. Prints JSON: seconds of reading and interpreting alone, of
/// rewriting and of rewriting for a machine with an effect beside its error functions, and the peak memory,
/// which does not depend on the number of lines.

#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "measure.h"
#include "reference_problem.h"
#include "tests/support/identified_machines.h"
#include "volcal/identify/program/nc_rewriter.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal::bench {
namespace {

struct ProgramArguments {
  int lines = 1000000;
  double step = 0.3;  // mm
};

ProgramArguments parse_arguments(int count, char** values) {
  ProgramArguments arguments;
  read_options(count, values, 1, {{"--lines", into(arguments.lines)}, {"--step", into(arguments.step)}});
  return arguments;
}

/// A raster over a wavy face of 200 x 100 mm, line by line.
class FinishingPass {
 public:
  explicit FinishingPass(double step) : step_(step) {}

  std::string_view next() {
    if (line_++ == 0) return "G21 G90 G17\n";
    if (line_ == 2) return "F3000\n";
    if (line_ == 3) return "G0 X-100 Y-50 Z20\n";
    constexpr double kHalfWidth = 100.0, kHalfDepth = 50.0;
    x_ += along_ * step_;
    if (std::abs(x_) > kHalfWidth) {
      along_ = -along_;
      y_ = y_ + step_ > kHalfDepth ? -kHalfDepth : y_ + step_;
    }
    text_.clear();
    fmt::format_to(std::back_inserter(text_), "{}X{:.3f} Y{:.3f} Z{:.3f}\n", line_ == 4 ? "G1 " : "", x_, y_,
                   2.0 * std::sin(0.05 * x_) - 5.0);
    return text_;
  }

 private:
  double step_;
  std::int64_t line_ = 0;
  double x_ = -100.0, y_ = -50.0, along_ = 1.0;
  std::string text_;
};

NcSetup setup_of(const Machine& machine) {
  NcSetup setup;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Axis& axis : machine.axes) {
    middle[direction_of(axis.name)] = 0.5 * (axis.travel_min + axis.travel_max);
  }
  setup.work_offsets[0] = middle;
  return setup;
}

struct Timing {
  double seconds = 0.0;
  double bytes = 0.0;
};

/// Time of `work` on every line, without that of making the lines.
template <class Work>
Timing timed(const ProgramArguments& arguments, Work work) {
  constexpr int kBatch = 10000;
  Timing timing;
  FinishingPass pass(arguments.step);
  std::vector<std::string> batch;
  for (int done = 0; done < arguments.lines; done += kBatch) {
    batch.clear();
    for (int i = done; i < std::min(done + kBatch, arguments.lines); ++i) batch.emplace_back(pass.next());
    timing.seconds += seconds([&] {
      for (const std::string& line : batch) work(line);
    });
    for (const std::string& line : batch) timing.bytes += static_cast<double>(line.size());
  }
  return timing;
}

FitResult with_coupling(FitResult result) {
  constexpr double kPerSquareMetre = 1.8e-4;  // rad/m^2
  result.identified.effects.push_back(coupling());
  ParameterBlock block;
  block.kind = ParameterKind::Effect;
  block.name = "EAY by y z";
  block.offset = result.layout.size++;
  block.guess = Eigen::VectorXd::Zero(1);
  result.layout.blocks.push_back(block);
  result.parameters.conservativeResize(result.layout.size);
  result.parameters[block.offset] = kPerSquareMetre;
  result.covariance = Eigen::MatrixXd::Zero(result.layout.size, result.layout.size);
  return result;
}

struct Rewriting {
  Timing timing;
  double written = 0.0;  // bytes
  std::int64_t lines = 0;
};

Rewriting rewriting(const ProgramArguments& arguments, const FitResult& result) {
  FunctionalPoint point;
  point.without_length = result.machine.tools[0].offset;
  NcRewriter rewriter(program_errors(result, "", default_conditions(result)), setup_of(result.machine), point,
                      {}, "pass.ngc");
  Rewriting done;
  const NcRewriter::Sink sink = [&](std::string_view, std::span<const NcWrittenLine> lines) {
    for (const NcWrittenLine& line : lines) done.written += static_cast<double>(line.text.size());
  };
  done.timing = timed(arguments, [&](const std::string& line) { rewriter.rewrite(line, sink); });
  done.lines = rewriter.summary().lines_written;
  return done;
}

nlohmann::ordered_json run_program_bench(const ProgramArguments& arguments) {
  sim::RandomTruthOptions options;
  options.reversal_max = 4e-6;
  const sim::TruthMachine truth = sim::random_truth(sim::reference_machines()[1], 1, options);
  const FitResult result = testing::result_of(truth);
  NcInterpreter interpreter(setup_of(truth.machine()), "pass.ngc");
  const Timing read = timed(arguments, [&](const std::string& line) { interpreter.execute(line); });
  const Rewriting plain = rewriting(arguments, result);
  const Rewriting extended = rewriting(arguments, with_coupling(result));
  const auto once = [](const Timing& timing) { return std::vector<double>{timing.seconds}; };
  return {{"lines", arguments.lines},
          {"bytes", read.bytes},
          {"interpreted_s", once(read)},
          {"rewritten_s", once(plain.timing)},
          {"rewritten_effect_s", once(extended.timing)},
          {"bytes_written", plain.written},
          {"lines_written", plain.lines},
          {"peak_bytes", peak_memory()}};
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("program_bench", [&] {
    std::cout << volcal::bench::run_program_bench(volcal::bench::parse_arguments(count, values)).dump(1)
              << '\n';
  });
}
