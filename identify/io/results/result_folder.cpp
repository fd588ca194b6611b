#include "volcal/identify/io/results/result_folder.h"

#include <filesystem>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/residual_writer.h"
#include "volcal/identify/io/results/result_json.h"
#include "volcal/identify/result/left_out_findings.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;

std::string json_path(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error) ? (fs::path(path) / "result.json").string() : path;
}

/// A result without setups is stated and not identified (stated_errors.h).
std::string origin_of(const FitResult& result, const Campaign& campaign) {
  if (result.setups.empty()) return "Stated in " + campaign.file;
  std::string text = "Identified from " + campaign.file + ", status " + std::string(to_string(result.status));
  for (const std::string& words : sentences(left_out_among(result.findings))) text += ";\n" + words;
  return text;
}

}  // namespace

void write_result_folder(const FitResult& result, const Campaign& campaign, const std::string& target,
                         const std::map<std::string, std::string>& more) {
  AtomicFolder folder(target);
  folder.write("result.json", result_json(result));
  TableFormatOptions options;
  options.grid_per_axis = kGridPointsPerAxis;
  for (const TableFile& file : result_tables(result, options)) folder.write(file);
  write_residuals_csv(folder.path("residuals.csv"), result, campaign);
  folder.write("machine.toml", machine_toml(result.machine));
  folder.write("identified.toml",
               model_toml(model_of_result(result), "machine.toml",
                          origin_of(result, campaign) +
                              ".\nErrors are actual minus nominal, tool relative to workpiece."));
  for (const auto& [name, content] : more) folder.write(name, content);
  folder.commit();
}

FitResult read_result(const std::string& path, const SourcePlace& named_at) {
  const std::string file = json_path(path);
  std::error_code error;
  if (!fs::exists(path, error)) {
    throw InputError(named_at.file.empty() ? SourcePlace{path, 0} : named_at,
                     named_at.file.empty() ? "there is no such result" : "there is no result " + path,
                     missing_remedy(path, "give the folder that volcal fit wrote with -o"));
  }
  if (fs::is_directory(path, error) && !fs::exists(file, error)) {
    throw InputError({path, 0}, "the folder holds no result.json", "give a folder that volcal fit wrote");
  }
  return result_from_json(read_text_file(file), file);
}

bool is_result(const std::string& path) {
  std::error_code error;
  const fs::path file = json_path(path);
  return file.extension() == ".json" && fs::is_regular_file(file, error);
}

}  // namespace volcal
