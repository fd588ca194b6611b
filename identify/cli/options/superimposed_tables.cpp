#include "volcal/identify/cli/options/superimposed_tables.h"

#include <filesystem>
#include <map>

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

bool stand_beside(const fs::path& file, const std::string& active_compensations) {
  if (!is_file(file)) return false;
  const std::map<std::string, std::string> entries =
      read_table_metadata({file.string(), read_text_file(file.string())}).entries;
  const auto says = [&](const std::string& key, const std::string& value) {
    const auto found = entries.find(key);
    return found != entries.end() && found->second == value;
  };
  return says(std::string(kSuperimposedOn), std::string(kSuperimposedOnNone)) &&
         says(kActiveCompensations, active_compensations);
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

Correction ActiveTables::correction(const AxisPosition& position, const ApproachDirection& direction) const {
  Correction sum = tables.correction(position, direction);
  if (!former) return sum;
  const Correction before = former->correction(position, direction);
  sum.linear -= before.linear;
  sum.rotary -= before.rotary;
  return sum;
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
    active.is_doubtful = !stand_beside(fs::path(folder) / kMetadata, active_compensations);
  }
  return active;
}

}  // namespace volcal::cli
