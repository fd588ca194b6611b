#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/conditions_options.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/program_setup.h"
#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/io/program_file.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/program/nc_check.h"
#include "volcal/identify/program/program_header.h"
#include "volcal/identify/program/tcp/tcp_check.h"
#include "volcal/identify/program/tcp/tcp_rewriter.h"
#include "volcal/identify/program/tcp/tcp_words.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/program_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct CompensateArguments {
  std::string result;
  std::string program;
  std::string output;
  ProgramSetupArguments setup;
  std::string tool;
  std::string lengths_from;
  double tolerance_um = 0.5;
  double arc_tolerance_um = 0.5;
  int decimals = 4;
  int rotary_decimals = 5;
  ConditionsArguments conditions;
  bool orientation = false;
  bool check = false;
  bool json = false;
};

/// What happened to the program.
struct RewrittenProgram {
  NcRewriteSummary summary;
  std::optional<ProgramCheck> check;
};

void require_output(const CompensateArguments& arguments) {
  if (arguments.output.empty() && !arguments.check)
    throw InputError({}, "neither a file nor a check is asked for", "give -o OUT.ngc, --check, or both");
  if (!arguments.output.empty() && same_file(arguments.program, arguments.output))
    throw InputError({arguments.output, 0}, "the output is the program itself",
                     "name another file; a program that is compensated twice is wrong twice");
}

/// What the rewritten program is valid for.
std::vector<std::string> header(const FitResult& result, const CompensateArguments& arguments,
                                const Conditions& conditions, CommentStyle style) {
  std::string made_of = "result " + arguments.result;
  for (const std::string& offset : arguments.setup.work_offsets) made_of += " " + offset;
  for (const std::string& length : arguments.setup.tool_lengths) made_of += " " + length;
  return program_header(made_of, acting_conditions(result, conditions), style);
}

NcRewriteOptions rewrite_options(const FitResult& result, const CompensateArguments& arguments,
                                 const Conditions& conditions) {
  NcRewriteOptions options;
  options.tolerance = arguments.tolerance_um * kMetrePerMicrometre;
  options.arc_tolerance = arguments.arc_tolerance_um * kMetrePerMicrometre;
  options.decimals_mm = arguments.decimals;
  options.within_readings = arguments.conditions.no_extrapolation;
  options.header = header(result, arguments, conditions, CommentStyle::Brackets);
  return options;
}

RewrittenProgram rewrite(const FitResult& result, const CompensateArguments& arguments,
                         const Conditions& conditions) {
  const NcSetup setup = program_setup(arguments.setup, result.machine);
  const FunctionalPoint point = functional_point(result.machine, arguments.tool, arguments.lengths_from);
  const ProgramErrors errors = program_errors(result, arguments.tool, conditions);
  NcRewriter rewriter(errors, setup, point, rewrite_options(result, arguments, conditions),
                      arguments.program);
  std::optional<NcCheck> check;
  if (arguments.check) check.emplace(errors, setup, point);
  LineFile program(arguments.program);
  std::optional<AtomicFile> output;
  if (!arguments.output.empty()) output.emplace(arguments.output);
  const NcRewriter::Sink sink = [&](std::string_view line, std::span<const NcWrittenLine> written) {
    if (output) {
      for (const NcWrittenLine& text : written) output->write(text.text);
    }
    if (check) check->add(line, written);
  };
  for (std::string_view line; program.next(line);) rewriter.rewrite(line, sink);
  if (output) output->commit();
  RewrittenProgram done{rewriter.summary(), std::nullopt};
  if (check) done.check = ProgramCheck{check->before(), check->after(), check->length()};
  return done;
}

void print_text(const RewrittenProgram& done, const FitResult& result, const CompensateArguments& arguments,
                const Conditions& conditions) {
  fmt::print("{}", program_summary_text(done.summary));
  if (done.check) fmt::print("{}", program_check_text(*done.check));
  fmt::print("{}", conditions_text(result, conditions));
  fmt::print("{}", findings_text(program_findings(result, arguments.tool, false).all()));
  if (!arguments.output.empty()) fmt::print("{}\n", arguments.output);
}

/// How the first line that begins tool centre point motion does.
std::optional<TcpBegin> first_tcp(const std::string& program) {
  LineFile lines(program);
  for (std::string_view line; lines.next(line);) {
    if (const auto begin = tcp_begin(line)) return begin;
  }
  return std::nullopt;
}

TcpRewriteOptions tcp_options(const FitResult& result, const CompensateArguments& arguments,
                              const Conditions& conditions, TcpBegin begin) {
  TcpRewriteOptions options = tcp_options_of(result);
  options.tolerance = arguments.tolerance_um * kMetrePerMicrometre;
  options.decimals_mm = arguments.decimals;
  options.decimals_deg = arguments.rotary_decimals;
  options.orientation = arguments.orientation;
  options.within_readings = arguments.conditions.no_extrapolation;
  options.header = header(result, arguments, conditions,
                          begin == TcpBegin::ByName ? CommentStyle::Semicolon : CommentStyle::Brackets);
  return options;
}

/// What happened to a program with tool centre point motion.
struct RewrittenTcp {
  TcpSummary summary;
  std::optional<TcpProgramCheck> check;
};

RewrittenTcp rewrite_tcp(const FitResult& result, const CompensateArguments& arguments,
                         const Conditions& conditions, TcpBegin begin) {
  const ErrorsOfOffset errors = tcp_errors_of(result, arguments.tool, conditions);
  const NcSetup setup = program_setup(arguments.setup, result.machine);
  const FunctionalPoint point = functional_point(result.machine, arguments.tool, arguments.lengths_from);
  TcpRewriter rewriter(result.machine, errors, setup, point,
                       tcp_options(result, arguments, conditions, begin), arguments.program);
  std::optional<TcpCheck> check;
  if (arguments.check) check.emplace(result.machine, errors, setup, point);
  LineFile program(arguments.program);
  std::optional<AtomicFile> output;
  if (!arguments.output.empty()) output.emplace(arguments.output);
  const TcpRewriter::Sink sink = [&](std::string_view line, std::span<const NcWrittenLine> written) {
    if (output) {
      for (const NcWrittenLine& text : written) output->write(text.text);
    }
    if (check) check->add(line, written);
  };
  for (std::string_view line; program.next(line);) rewriter.rewrite(line, sink);
  if (output) output->commit();
  RewrittenTcp done{rewriter.summary(), std::nullopt};
  if (check) done.check = TcpProgramCheck{check->before(), check->after(), check->length()};
  return done;
}

int run_tcp(const FitResult& result, const CompensateArguments& arguments, const Conditions& conditions,
            TcpBegin begin) {
  const RewrittenTcp done = rewrite_tcp(result, arguments, conditions, begin);
  const ProgramFindings findings = program_findings(result, arguments.tool, true);
  if (arguments.json) {
    nlohmann::ordered_json json = tcp_summary_json(done.summary, done.check);
    add_program_findings(findings, result, conditions, json);
    if (!arguments.output.empty()) json["file"] = arguments.output;
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{}{}{}", tcp_summary_text(done.summary, done.check), conditions_text(result, conditions),
               findings_text(findings.all()));
    if (!arguments.output.empty()) fmt::print("{}\n", arguments.output);
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

int run_compensate(const CompensateArguments& arguments) {
  require_output(arguments);
  const FitResult result = read_known_errors(arguments.result);
  const Conditions conditions = conditions_of(result, arguments.conditions);
  if (arguments.conditions.no_extrapolation) require_conditions_of_readings(result, conditions);
  if (const auto begin = first_tcp(arguments.program)) return run_tcp(result, arguments, conditions, *begin);
  if (arguments.orientation)
    throw InputError({arguments.program, 0},
                     "--orientation turns rotary axes, and the program has no tool centre point motion",
                     "leave the option out, or write G43.4 H or TRAORI in the program");
  const RewrittenProgram done = rewrite(result, arguments, conditions);
  if (arguments.json) {
    nlohmann::ordered_json json = program_json(done.summary, done.check);
    add_program_findings(program_findings(result, arguments.tool, false), result, conditions, json);
    if (!arguments.output.empty()) json["file"] = arguments.output;
    fmt::print("{}\n", json_text(json, 2));
  } else {
    print_text(done, result, arguments, conditions);
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

void add_setup_options(CLI::App& app, ProgramSetupArguments& setup) {
  app.add_option(
      "--work-offset", setup.work_offsets,
      "G54=X10,Y20,Z-300, origin of a work coordinate system in machine coordinates, mm; may be given "
      "several times, for every one that the program uses");
  app.add_option(
      "--tool-length", setup.tool_lengths,
      "H1=150.2, length that G43 H1 calls, mm, positive along the tool; may be given several times");
  app.add_option(
      "--start", setup.start,
      "X0,Y0,Z0, where the axes are before the program, machine coordinates in mm; default: not known, "
      "so that the program must begin with G0 to a position of every axis");
  app.add_option("--units", setup.units, "unit of length before G20 or G21: mm or inch; default: not known")
      ->check(CLI::IsMember({"mm", "inch"}));
  app.add_option("--block-delete", setup.block_delete,
                 "how the control's switch stands for blocks that begin with /: on (skip) or off (run)")
      ->check(CLI::IsMember({"on", "off"}));
}

std::function<int()> define_compensate(CLI::App& app) {
  auto arguments = std::make_shared<CompensateArguments>();
  app.add_option("RESULT", arguments->result,
                 "result folder of volcal fit, model.toml with values, or folder of tables --format csv")
      ->required();
  app.add_option(
         "PROGRAM", arguments->program,
         "NC program (RS-274, ISO 6983) of X, Y and Z, or with rotary axes and tool centre point motion "
         "(G43.4 H, TRAORI)")
      ->required();
  app.add_option("-o,--output", arguments->output, "rewritten program");
  add_setup_options(app, arguments->setup);
  app.add_option(
      "--tool", arguments->tool,
      "tool of the machine whose functional point is corrected while no tool length is active (G49); "
      "default the first");
  app.add_option(
      "--lengths-from", arguments->lengths_from,
      "tool of the machine that tool lengths are differences to; default: they count from the spindle "
      "reference, as the machine's tool offsets do");
  app.add_option("--tolerance-um", arguments->tolerance_um,
                 "largest distance from the corrected path between the ends of lines, um; default 0.5")
      ->check(positive());
  app.add_option("--arc-tolerance-um", arguments->arc_tolerance_um,
                 "largest distance of the chords that stand for arcs, um; default 0.5")
      ->check(positive());
  app.add_option("--decimals", arguments->decimals, "of coordinates in mm, inches have one more; default 4")
      ->check(CLI::Range(kFewestDecimals, kMostDecimals));
  app.add_option("--rotary-decimals", arguments->rotary_decimals,
                 "of positions of rotary axes in deg; default 5")
      ->check(CLI::Range(kFewestRotaryDecimals, kMostRotaryDecimals));
  app.add_flag("--orientation", arguments->orientation,
               "with tool centre point motion: turn the tool's axis to where it is meant, too (FOR, ISO/TR "
               "16907, 8.2.6)");
  add_conditions_options(app, arguments->conditions);
  app.add_flag(
      "--check", arguments->check,
      "interpret both programs and print the error of the tool point along the path, before and after");
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_compensate(*arguments); };
}

}  // namespace

const Command& compensate_command() {
  static const Command command = {
      "compensate", "rewrite an NC program so that the identified errors cancel",
      "  volcal compensate result part.ngc -o part-compensated.ngc --work-offset G54=X10,Y20,Z-300 \\\n"
      "      --tool-length H1=150\n"
      "  volcal compensate result part.ngc --check --work-offset G54=X10,Y20,Z-300 \\\n"
      "      --tool short --tool-length H1=150\n",
      define_compensate};
  return command;
}

}  // namespace volcal::cli
