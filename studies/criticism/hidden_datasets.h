#pragma once
/// Campaigns with something hidden, kept as study files: how much of their systematic error the model that a
/// diagnosis offers removes at positions that were not measured.
///
/// In: a folder of study files (datasets/hidden/sealed). Out: one row a file. The share is
/// (MS_given - MS_offered) / (MS_given - MS_clean), mean squares of the prediction error at unseen positions
/// without noise: of the given model, of the offered one, and of the given model on the same campaign, same
/// noise, with nothing hidden, which is what an oracle would reach.

#include <functional>
#include <string>
#include <vector>

namespace volcal::studies {

struct HiddenDatasetRow {
  std::string name;                  ///< of the file, "04"
  std::vector<std::string> hidden;   ///< kinds
  double signal = 0.0;               ///< |g~ a| of all that is hidden, in units of the noise
  std::string verdict;               ///< "NAMED"
  std::vector<std::string> offered;  ///< labels of what the offered model adds
  double given_um = 0.0;             ///< root mean squares of the prediction error
  double offered_um = 0.0;
  double clean_um = 0.0;
  double share = 0.0;                ///< that is removed; NaN where nothing is hidden
  std::vector<std::string> decided;  ///< rules of the search that decided something (search_rules.h)
};

struct HiddenDatasetOptions {
  std::string folder;              ///< of study files
  std::vector<std::string> names;  ///< of them; empty = all
  int threads = 0;                 ///< 0 = all; results do not depend on it
  std::function<void(int done, int all)> progress;
};

/// In the order of names. Throws InputError for a folder without study files and a name that none has.
std::vector<HiddenDatasetRow> hidden_datasets(const HiddenDatasetOptions& options);

}  // namespace volcal::studies
