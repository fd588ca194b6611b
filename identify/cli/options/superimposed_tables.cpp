#include "volcal/identify/cli/options/superimposed_tables.h"

#include <filesystem>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/text/csv_cell.h"
#include "volcal/identify/text/table_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/campaign.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormer = "superimposed_on";
constexpr const char* kMetadata = "metadata.csv";
constexpr const char* kActiveCompensations = "active_compensations";

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// Words of the errors that superimposed tables were made from.
std::string words_of_former(const fs::path& file) {
  const TableFile text{file.string(), read_text_file(file.string())};
  for (const CsvRow& row : csv_rows(text, "key,value")) {
    if (row.cells[0] == kActiveCompensations) return row.cells[1];
  }
  throw InputError({file.string(), 0}, std::string("key ") + kActiveCompensations + " is missing",
                   "write the tables again");
}

}  // namespace

CompensationTables active_tables(const std::string& folder) {
  const TablesFolder active = read_tables_folder(folder);
  return active.format->read(active.files);
}

void keep_former_tables(const std::string& former, const std::string& active_compensations,
                        const AtomicFolder& folder) {
  const std::string tables = std::string(kFormer) + "/tables/";
  fs::create_directories(folder.path(tables));
  for (const TableFile& file : read_tables_folder(former).files)
    folder.write(tables + file.name, file.content);
  folder.write(std::string(kFormer) + "/" + kMetadata, std::string("key,value\n") + kActiveCompensations +
                                                           "," + csv_cell(active_compensations) + "\n");
}

ActiveTables active_tables_for(const std::string& folder, const std::string& active_compensations) {
  ActiveTables active{active_tables(folder), {}, false};
  if (!names_compensations(active_compensations)) return active;
  const fs::path former = fs::path(folder) / kFormer;
  if (is_file(former / kMetadata)) {
    if (words_of_former(former / kMetadata) == active_compensations) {
      active.former = active_tables((former / "tables").string());
    } else {
      active.is_doubtful = true;
    }
  } else {
    const fs::path metadata = fs::path(folder) / kMetadata;
    active.is_doubtful =
        !is_file(metadata) ||
        !stand_beside({metadata.string(), read_text_file(metadata.string())}, active_compensations);
  }
  return active;
}

}  // namespace volcal::cli
