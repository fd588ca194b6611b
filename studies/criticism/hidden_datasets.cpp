#include "volcal/studies/criticism/hidden_datasets.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>
#include <set>

#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/model/description/errors.h"
#include "volcal/studies/criticism/yardstick.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal::studies {
namespace {

std::vector<std::filesystem::path> study_files(const HiddenDatasetOptions& options) {
  std::vector<std::filesystem::path> files;
  std::error_code unreadable;
  for (const auto& entry : std::filesystem::directory_iterator(options.folder, unreadable)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  if (files.empty()) {
    throw InputError({options.folder, 0}, "it holds no study files",
                     "give a folder of them, as datasets/hidden/sealed");
  }
  std::ranges::sort(files);
  if (options.names.empty()) return files;
  std::vector<std::filesystem::path> chosen;
  for (const std::string& name : options.names) {
    const auto found =
        std::ranges::find_if(files, [&](const auto& file) { return file.stem().string() == name; });
    if (found == files.end())
      throw InputError({options.folder, 0}, "it holds no " + name + ".toml", "give a name without .toml");
    chosen.push_back(*found);
  }
  return chosen;
}

double total_signal(const sim::Study& study, const Yardstick& yardstick) {
  Eigen::VectorXd change;
  for (const sim::HiddenEffect& effect : study.hidden) {
    double amplitude = 0.0;
    const Eigen::VectorXd own = yardstick.change(study, effect, &amplitude);
    change = change.size() == 0 ? own : Eigen::VectorXd(change + own);
  }
  return change.size() == 0 ? 0.0 : yardstick.visible(change).signal;
}

HiddenDatasetRow row_of(const std::filesystem::path& file) {
  sim::Study study = read_study(file.string());
  study.unseen = true;
  HiddenDatasetRow row;
  row.name = file.stem().string();
  for (const sim::HiddenEffect& effect : study.hidden) row.hidden.push_back(effect.kind);
  const Yardstick yardstick(hiding(study, {}));
  row.signal = total_signal(study, yardstick);

  const sim::SimulatedCampaign simulated = sim::simulate(study);
  const FitResult given = fitted(simulated.campaign, {});
  DiagnoseOptions options;
  options.compare = false;
  options.figures = false;
  options.climb = true;
  std::set<SearchRule> decided;
  options.rules.decided = [&decided](SearchRule rule) { decided.insert(rule); };
  const Diagnosis diagnosis = diagnose(simulated.campaign, given, options);
  row.verdict = to_string(diagnosis.verdict);
  for (const SearchRule rule : decided) row.decided.emplace_back(name_of(rule));
  const std::vector<EffectFinding> accepted = accepted_effects(diagnosis);
  for (const EffectFinding& effect : accepted) row.offered.push_back(effect.label);

  const double before = unseen_square(simulated, given);
  const double after =
      accepted.empty() ? before
                       : unseen_square(simulated, fitted(simulated.campaign,
                                                         extended_model({}, simulated.campaign, accepted)));
  const double clean = yardstick.unseen_square();
  row.given_um = std::sqrt(before);
  row.offered_um = std::sqrt(after);
  row.clean_um = std::sqrt(clean);
  row.share =
      study.hidden.empty() ? std::numeric_limits<double>::quiet_NaN() : (before - after) / (before - clean);
  return row;
}

}  // namespace

std::vector<HiddenDatasetRow> hidden_datasets(const HiddenDatasetOptions& options) {
  const std::vector<std::filesystem::path> files = study_files(options);
  std::vector<HiddenDatasetRow> rows(files.size());
  std::mutex reporting;
  int done = 0;
  run_parallel(files.size(), thread_count(options.threads), [&](std::size_t i) {
    rows[i] = row_of(files[i]);
    const std::lock_guard lock(reporting);
    if (options.progress) options.progress(++done, static_cast<int>(files.size()));
  });
  return rows;
}

}  // namespace volcal::studies
