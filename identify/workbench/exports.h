#pragma once
/// What a session leaves in files.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/identify/session/session.h"

namespace volcal::workbench {

struct ExportPlace {
  std::string folder;    ///< made where it does not exist
  std::string campaign;  ///< as the user named it
  std::string model;     ///< the same; empty: none
  Provenance provenance = {};
  bool from_page = false;  ///< what was done is in `commands`, not in `provenance`
  std::vector<std::string> commands = {};
};

/// model-M.toml of the current model; the path. No file is overwritten.
std::string export_model(const Session& session, const ExportPlace& place);

/// The commands as a script of the shell that reproduces every number; the path.
std::string export_commands(const std::vector<std::string>& commands, const ExportPlace& place);

/// model.toml of the current model as a file beside `file` needs it; what was left out stands at its head.
std::string session_model_toml(const Session& session, const std::string& file);

/// Folders `result` and `diagnosis`, or report.html alone, of the current model: work that takes long, then
/// the paths. Throws InputError for something else.
using ExportWork = std::function<std::vector<std::string>(const SessionProgress&)>;
ExportWork export_work(const std::string& what, const Session& session, const ExportPlace& place,
                       int threads);
/// The folder that `volcal fit` writes, of the current model and its readings, in `target`.
ExportWork result_export(const Session& session, const ExportPlace& place, const std::string& target,
                         int threads);
/// The folder that `volcal diagnose` writes, in `target`.
ExportWork diagnosis_export(const Session& session, const ExportPlace& place, const std::string& target);

}  // namespace volcal::workbench
