#include "volcal/identify/session/session_command.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/output_file.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/result/left_out_findings.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/workbench/exports.h"
#include "volcal/identify/workbench/session_json.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct SessionArguments {
  std::string campaign;
  std::string model;
  std::vector<std::string> lines;
  std::string output;
  std::string result;
  std::string diagnosis;
  int threads = 0;
  bool json = false;
};

std::string interval_text(const LadderStep& figures) {
  if (std::isnan(figures.systematic)) return "-";
  return fixed_number(figures.systematic * kPerMicro, 2) + " (" +
         fixed_number(figures.systematic_low * kPerMicro, 2) + " to " +
         fixed_number(figures.systematic_high * kPerMicro, 2) + ")";
}

std::string standing_of(const SessionModel& model) {
  if (model.standing == ModelStanding::Preview) return "linear preview";
  if (model.standing == ModelStanding::Refitted) return "refit";
  return model.standing == ModelStanding::Contradicted ? "full fit, off the preview" : "full fit";
}

std::string models_text(const Session& session) {
  TextTable table({{"", Align::Left},
                   {"model", Align::Right},
                   {"from", Align::Right},
                   {"change", Align::Left},
                   {"systematic error [um]", Align::Left},
                   {"chi2/dof", Align::Right},
                   {"by", Align::Left}});
  for (const SessionModel& model : session.models()) {
    table.add_row({model.number == session.current().number ? ">" : "", std::to_string(model.number),
                   model.parent ? std::to_string(*model.parent) : "",
                   model.change.empty() ? "as given" : model.change, interval_text(model.figures),
                   fixed_number(model.figures.reduced_chi2, 3), standing_of(model)});
  }
  return table.text();
}

void do_line(Session& session, const std::string& line) {
  ProgressBar bar(line);
  const auto progress = [&bar](const std::string& stage, double done) {
    bar.update(stage, done);
    return true;
  };
  try {
    if (const auto work = begin(session, session_command_from(line))) session.take(*work, progress);
  } catch (const InputError& error) {
    throw InputError(error.place(), "--do \"" + line + "\": " + error.problem(), error.remedy());
  }
}

std::vector<std::string> files_read(const SessionArguments& arguments, const Campaign& campaign) {
  std::vector<std::string> files = {arguments.campaign, arguments.model, campaign.machine.file};
  for (const Setup& setup : campaign.setups) files.push_back(setup.data);
  return files;
}

void require_free_targets(const SessionArguments& arguments, const Campaign& campaign) {
  const std::vector<std::string> read = files_read(arguments, campaign);
  require_no_input(arguments.output, read, "name another file with -o");
  for (const std::string& folder : {arguments.result, arguments.diagnosis}) {
    if (!folder.empty()) require_output_folder(folder, read);
  }
  if (!arguments.result.empty() && arguments.result == arguments.diagnosis)
    throw InputError({}, "--result and --diagnosis name the same folder", "name two");
}

/// The model file, the result and the diagnosis that were asked for; their paths.
std::vector<std::string> write_exports(const Session& session, const SessionArguments& arguments) {
  std::vector<std::string> written;
  if (!arguments.output.empty()) {
    write_text_file(arguments.output, workbench::session_model_toml(session, arguments.output));
    written.push_back(arguments.output);
  }
  const workbench::ExportPlace place{
      .folder = {}, .campaign = arguments.campaign, .model = arguments.model, .provenance = provenance()};
  const auto make = [&](const std::string& what, const workbench::ExportWork& work) {
    ProgressBar bar(what);
    work([&bar](const std::string& stage, double done) {
      bar.update(stage, done);
      return true;
    });
    bar.finish();
  };
  if (!arguments.result.empty()) {
    make("result", workbench::result_export(session, place, arguments.result, arguments.threads));
    written.push_back(arguments.result);
  }
  if (!arguments.diagnosis.empty()) {
    make("diagnosis", workbench::diagnosis_export(session, place, arguments.diagnosis));
    written.push_back(arguments.diagnosis);
  }
  return written;
}

/// A model file holds no readings: what the session left out, `volcal fit` of it takes back.
std::string left_out_text(const Session& session, const SessionArguments& arguments) {
  const std::vector<Finding> left_out = left_out_findings(session.campaign());
  if (left_out.empty()) return "";
  std::string text = findings_text(left_out);
  if (!arguments.output.empty() && arguments.result.empty())
    text += "! volcal fit with " + arguments.output +
            " takes these readings back, where the campaign does not leave them out; --result DIR writes the "
            "result without them\n";
  return text;
}

int run_session(const SessionArguments& arguments) {
  Campaign campaign = read_campaign(arguments.campaign);
  const ModelSpec model = read_starting_model(arguments.model, campaign.machine);
  for (const std::string& line : arguments.lines) session_command_from(line);
  require_free_targets(arguments, campaign);
  ProgressBar bar("session");
  const auto progress = [&bar](const std::string& stage, double done) {
    bar.update(stage, done);
    return true;
  };
  Session session(std::move(campaign), model, {.threads = arguments.threads, .progress = progress});
  bar.finish();
  for (const std::string& line : arguments.lines) do_line(session, line);
  const std::vector<std::string> written = write_exports(session, arguments);
  if (arguments.json) {
    fmt::print("{}\n", json_text(workbench::models_json(session), 2));
    return kDone;
  }
  fmt::print("{}{}", models_text(session), left_out_text(session, arguments));
  for (const std::string& path : written) fmt::print("written: {}\n", path);
  return kDone;
}

std::function<int()> define_session(CLI::App& app) {
  auto arguments = std::make_shared<SessionArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml")->required();
  app.add_option("-m,--model", arguments->model,
                 "model.toml, or result of volcal fit, to begin with; default: all 21 errors");
  app.add_option("--do", arguments->lines,
                 "what to do, one after another: \"add KIND:TARGET:DRIVER:SHAPE\", \"remove ...\", \"formula "
                 "TARGET += EXPRESSION\", or \"formula TARGET += EXPRESSION with p=250+-50\" where it has p "
                 "or q to be "
                 "estimated, \"with p=250\" where they are held; \"refit\", \"confirm\", \"climb\", \"draw "
                 "N\", \"leave-out OBSERVATIONS "
                 "REASON\", \"undo\", \"redo\", \"go N\"; may be given several times")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("-o,--output", arguments->output,
                 "model file to write at the end; volcal fit with it takes back readings that were left out");
  app.add_option("--result", arguments->result,
                 "result folder to write at the end, as volcal fit does: of the last model, without the "
                 "readings that were left out");
  app.add_option("--diagnosis", arguments->diagnosis,
                 "folder of a diagnosis of the last model to write at the end, as volcal diagnose does");
  app.add_option("--threads", arguments->threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_flag("--json", arguments->json, "print the models as one JSON document and nothing else");
  return [arguments] { return run_session(*arguments); };
}

}  // namespace

const Command& session_command() {
  static const Command command = {
      "session", "do what the workbench does by a list of commands: the same numbers, without the page",
      "  volcal session campaign.toml --do \"add reversal:EXX:dir_x:step\" --do confirm\n"
      "  volcal session campaign.toml --model model.toml --do climb -o found.toml\n"
      "  volcal session campaign.toml --do \"leave-out 12-23 cable moved\" --do climb --result result\n"
      "  volcal session campaign.toml --do \"formula EXX += dir_x * (T_air - 20)\" --json\n",
      define_session};
  return command;
}

}  // namespace volcal::cli
