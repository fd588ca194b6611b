#include "volcal/identify/workbench/exports.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <system_error>

#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/diagnosis_folder.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"
#include "volcal/identify/session/session_work.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/text/text_file.h"

namespace volcal::workbench {
namespace {

namespace fs = std::filesystem;

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw InputError({folder, 0}, "the folder cannot be made: " + error.message(), "name another with -o");
}

/// The first of NAME.EXT, NAME-1.EXT, NAME-2.EXT ... that does not exist.
std::string free_path(const std::string& folder, const std::string& name, const std::string& extension) {
  fs::path path = fs::path(folder) / (name + extension);
  for (int number = 1; fs::exists(path); ++number)
    path = fs::path(folder) / fmt::format("{}-{}{}", name, number, extension);
  return path.string();
}

std::string path_from_folder(const std::string& folder, const std::string& file) {
  return fs::proximate(fs::absolute(file), fs::absolute(folder)).generic_string();
}

/// In single quotes of the shell.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// As `volcal fit` does.
FitResult full_fit(const Campaign& campaign, const ModelSpec& model, const ExportPlace& place, int threads,
                   const SessionProgress& progress) {
  FitOptions options;
  options.threads = threads;
  options.progress = [&](const std::string& stage, double done) {
    report_stage(progress, stage, 0.9 * done);
  };
  FitResult result = fit(campaign, model, options);
  result.provenance = place.provenance;
  return result;
}

ReportOptions options_of_report(const ExportPlace& place) {
  return {.date = place.provenance.date.substr(0, 10), .provenance = place.provenance};
}

ExportWork result_work(const Session& session, const ExportPlace& place, int threads) {
  return [=, campaign = session.campaign(), model = session.model()](const SessionProgress& progress) {
    const FitResult result = full_fit(campaign, model, place, threads, progress);
    std::map<std::string, std::string> more;
    if (report_available()) more["report.html"] = report_html(result, campaign, options_of_report(place));
    const std::string target = (fs::path(place.folder) / "result").string();
    write_result_folder(result, campaign, target, more);
    return std::vector{target};
  };
}

ExportWork report_work(const Session& session, const ExportPlace& place, int threads) {
  return [=, campaign = session.campaign(), model = session.model()](const SessionProgress& progress) {
    if (!report_available())
      throw InputError({}, "no report can be written", std::string(how_to_get_report()));
    const FitResult result = full_fit(campaign, model, place, threads, progress);
    const std::string path = (fs::path(place.folder) / "report.html").string();
    write_text_file(path, report_html(result, campaign, options_of_report(place)));
    return std::vector{path};
  };
}

ExportWork diagnosis_work(const Session& session, const ExportPlace& place) {
  return [=, campaign = session.campaign(), model = session.model(),
          diagnosis_of = session.diagnosis({})](const SessionProgress& progress) {
    const DiagnosedModel diagnosed = diagnosis_of(progress);
    const Diagnosis& diagnosis = diagnosed.diagnosis;
    std::map<std::string, std::string> more = {{"diagnosis.txt", diagnosis_text(diagnosis)}};
    if (report_available()) {
      const VolumeCauses causes = volume_causes(diagnosed.fit, accepted_effects(diagnosis));
      more["report.html"] = report_html(diagnosis, campaign, options_of_report(place), &causes);
    }
    const std::string target = (fs::path(place.folder) / "diagnosis").string();
    write_diagnosis_folder(diagnosis, campaign.machine, offered_models(model, campaign, diagnosis), target,
                           more);
    return std::vector{target};
  };
}

}  // namespace

std::string export_model(const Session& session, const ExportPlace& place) {
  make_folder(place.folder);
  const std::string path =
      free_path(place.folder, fmt::format("model-{}", session.current().number), ".toml");
  write_text_file(
      path, model_toml(session.model(), path_from_folder(place.folder, session.campaign().machine.file)));
  return path;
}

std::string export_commands(const std::vector<std::string>& commands, const ExportPlace& place) {
  make_folder(place.folder);
  std::string script =
      "#!/bin/sh\n"
      "# The models of a session, made again by the commands that made them.\n"
      "set -e\n"
      "cd \"$(dirname \"$0\")\"\n"
      "volcal session " +
      quoted(path_from_folder(place.folder, place.campaign));
  if (!place.model.empty()) script += " --model " + quoted(path_from_folder(place.folder, place.model));
  for (const std::string& command : commands) script += " \\\n  --do " + quoted(command);
  const std::string path = free_path(place.folder, "session", ".sh");
  write_text_file(path, script + " \"$@\"\n");
  fs::permissions(path, fs::perms::owner_exec, fs::perm_options::add);
  return path;
}

ExportWork export_work(const std::string& what, const Session& session, const ExportPlace& place,
                       int threads) {
  make_folder(place.folder);
  if (what == "result") return result_work(session, place, threads);
  if (what == "report") return report_work(session, place, threads);
  if (what == "diagnosis") return diagnosis_work(session, place);
  throw InputError({}, "\"" + what + "\" cannot be exported", "model, result, diagnosis, report or commands");
}

}  // namespace volcal::workbench
