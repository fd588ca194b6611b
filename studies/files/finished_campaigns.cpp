#include "volcal/studies/files/finished_campaigns.h"

#include <nlohmann/json.hpp>

#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/nesting.h"

namespace volcal::studies {

bool take_campaign(const std::string& line, const SourcePlace& place, const TakeCampaign& take) {
  require_shallow(line, NestedText::Json, place.file);
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (json.is_discarded()) return false;
  try {
    take(json, place);
  } catch (const nlohmann::json::exception&) {
    throw InputError(place, "the line is not a campaign of this study",
                     "choose another folder, or delete the file to begin anew");
  }
  return true;
}

FinishedCampaigns::FinishedCampaigns(const std::string& folder, const std::string& name, bool resume,
                                     const TakeCampaign& take) {
  if (folder.empty()) return;
  path_ = std::filesystem::path(folder) / name;
  std::filesystem::create_directories(folder);
  if (std::filesystem::exists(path_)) {
    if (!resume) {
      throw InputError({path_.string(), 0}, "it holds the campaigns of an earlier run",
                       "add --resume to go on with it, or choose another folder");
    }
    read(take);
  }
  file_.open(path_, std::ios::app);
  if (!file_) throw InputError({path_.string(), 0}, "it cannot be written", "choose another folder");
}

void FinishedCampaigns::append(const nlohmann::json& campaign) {
  if (path_.empty()) return;
  file_ << json_text(campaign, -1) << '\n' << std::flush;
  if (!file_) throw InputError({path_.string(), 0}, "it cannot be written", "make room on the disk");
}

/// Leaves whole lines in the file.
void FinishedCampaigns::read(const TakeCampaign& take) {
  std::ifstream file(path_);
  std::string line, complete;
  for (int number = 1; std::getline(file, line) && !file.eof(); ++number) {
    if (take_campaign(line, {path_.string(), number}, take)) complete += line + '\n';
  }
  file.close();
  std::ofstream(path_, std::ios::trunc) << complete;
}

}  // namespace volcal::studies
