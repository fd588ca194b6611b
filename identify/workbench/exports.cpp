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
#include "volcal/identify/result/left_out_findings.h"
#include "volcal/identify/session/session_work.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/sentences.h"

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

/// The words of the shell that begin a session and do its commands, `between` them.
std::string session_line(const std::string& campaign, const std::string& model,
                         const std::vector<std::string>& commands, const std::string& between) {
  std::string line = "volcal session " + quoted(campaign);
  if (!model.empty()) line += " --model " + quoted(model);
  for (const std::string& command : commands) line += between + "--do " + quoted(command);
  return line;
}

/// A page's own command makes nothing again, its session's commands do; `option`: that writes `target`.
Provenance provenance_of(const ExportPlace& place, const std::string& option, const std::string& target) {
  Provenance provenance = place.provenance;
  if (!place.from_page) return provenance;
  provenance.command =
      session_line(place.campaign, place.model, place.commands, " ") + " " + option + " " + quoted(target);
  return provenance;
}

/// As `volcal fit` does.
FitResult full_fit(const Campaign& campaign, const ModelSpec& model, int threads,
                   const SessionProgress& progress) {
  FitOptions options;
  options.threads = threads;
  options.progress = [&](const std::string& stage, double done) {
    report_stage(progress, stage, 0.9 * done);
  };
  return fit(campaign, model, options);
}

ReportOptions options_of_report(const Provenance& provenance) {
  return {.date = provenance.date.substr(0, 10), .provenance = provenance};
}

ExportWork report_export(const Session& session, const ExportPlace& place, int threads) {
  const Provenance provenance =
      provenance_of(place, "--result", (fs::path(place.folder) / "result").string());
  return [=, campaign = session.campaign(), model = session.model()](const SessionProgress& progress) {
    if (!report_available())
      throw InputError({}, "no report can be written", std::string(how_to_get_report()));
    FitResult result = full_fit(campaign, model, threads, progress);
    result.provenance = provenance;
    const std::string path = (fs::path(place.folder) / "report.html").string();
    write_text_file(path, report_html(result, campaign, options_of_report(provenance)));
    return std::vector{path};
  };
}

}  // namespace

std::string export_model(const Session& session, const ExportPlace& place) {
  make_folder(place.folder);
  const std::string path =
      free_path(place.folder, fmt::format("model-{}", session.current().number), ".toml");
  write_text_file(path, session_model_toml(session, path));
  return path;
}

std::string session_model_toml(const Session& session, const std::string& file) {
  const Campaign& campaign = session.campaign();
  const std::string folder = fs::path(file).parent_path().string();
  std::string head;
  for (const std::string& words : sentences(left_out_findings(campaign)))
    head += (head.empty() ? "" : "\n") + words;
  if (!head.empty()) head = "Found in a session; readings that it left out volcal fit takes back:\n" + head;
  return model_toml(session.model(), path_from_folder(folder.empty() ? "." : folder, campaign.machine.file),
                    head);
}

std::string export_commands(const std::vector<std::string>& commands, const ExportPlace& place) {
  make_folder(place.folder);
  std::string script =
      "#!/bin/sh\n"
      "# The models of a session, made again by the commands that made them.\n"
      "set -e\n"
      "cd \"$(dirname \"$0\")\"\n";
  const std::string model = place.model.empty() ? "" : path_from_folder(place.folder, place.model);
  script += session_line(path_from_folder(place.folder, place.campaign), model, commands, " \\\n  ");
  const std::string path = free_path(place.folder, "session", ".sh");
  write_text_file(path, script + " \"$@\"\n");
  fs::permissions(path, fs::perms::owner_exec, fs::perm_options::add);
  return path;
}

ExportWork result_export(const Session& session, const ExportPlace& place, const std::string& target,
                         int threads) {
  const Provenance provenance = provenance_of(place, "--result", target);
  return [=, campaign = session.campaign(), model = session.model()](const SessionProgress& progress) {
    FitResult result = full_fit(campaign, model, threads, progress);
    result.provenance = provenance;
    std::map<std::string, std::string> more;
    if (report_available())
      more["report.html"] = report_html(result, campaign, options_of_report(provenance));
    write_result_folder(result, campaign, target, more);
    return std::vector{target};
  };
}

ExportWork diagnosis_export(const Session& session, const ExportPlace& place, const std::string& target) {
  const Provenance provenance = provenance_of(place, "--diagnosis", target);
  return [=, campaign = session.campaign(), model = session.model(),
          diagnosis_of = session.diagnosis({})](const SessionProgress& progress) {
    const DiagnosedModel diagnosed = diagnosis_of(progress);
    const Diagnosis& diagnosis = diagnosed.diagnosis;
    std::map<std::string, std::string> more = {{"diagnosis.txt", diagnosis_text(diagnosis)}};
    if (report_available()) {
      const VolumeCauses causes = volume_causes(diagnosed.fit, accepted_effects(diagnosis));
      more["report.html"] = report_html(diagnosis, campaign, options_of_report(provenance), &causes);
    }
    write_diagnosis_folder(diagnosis, campaign.machine, offered_models(model, campaign, diagnosis), target,
                           more);
    return std::vector{target};
  };
}

ExportWork export_work(const std::string& what, const Session& session, const ExportPlace& place,
                       int threads) {
  make_folder(place.folder);
  const auto in_folder = [&](const char* name) { return (fs::path(place.folder) / name).string(); };
  if (what == "result") return result_export(session, place, in_folder("result"), threads);
  if (what == "report") return report_export(session, place, threads);
  if (what == "diagnosis") return diagnosis_export(session, place, in_folder("diagnosis"));
  throw InputError({}, "\"" + what + "\" cannot be exported", "model, result, diagnosis, report or commands");
}

}  // namespace volcal::workbench
