#include "volcal/identify/cli/options/superimposed_tables.h"

#include <filesystem>

#include "volcal/identify/io/results/former_tables.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/campaign.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.csv";

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

TableFile text_file(const fs::path& path) { return {path.string(), read_text_file(path.string())}; }

}  // namespace

CompensationTables active_tables(const std::string& folder) {
  const TablesFolder active = read_tables_folder(folder);
  return active.format->read(active.files);
}

void keep_former_folder(const std::string& former, const std::string& active_compensations,
                        const AtomicFolder& folder) {
  keep_former_tables(read_tables_folder(former).files, active_compensations, folder);
}

ActiveTables active_tables_for(const std::string& folder, const std::string& active_compensations) {
  ActiveTables active{active_tables(folder), {}, false};
  if (!names_compensations(active_compensations)) return active;
  const fs::path of_former = fs::path(folder) / kFormerMetadata;
  if (is_file(of_former)) {
    active.is_doubtful = active_before_former_tables(text_file(of_former)) != active_compensations;
    if (!active.is_doubtful) active.former = active_tables((fs::path(folder) / kFormerTables).string());
  } else {
    const fs::path metadata = fs::path(folder) / kMetadata;
    active.is_doubtful = !is_file(metadata) || !stand_beside(text_file(metadata), active_compensations);
  }
  return active;
}

}  // namespace volcal::cli
