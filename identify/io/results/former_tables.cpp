#include "volcal/identify/io/results/former_tables.h"

#include <filesystem>

#include "volcal/identify/text/csv_cell.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr const char* kHeaderOfFormer = "key,value";
constexpr const char* kActiveBefore = "active_compensations";

}  // namespace

void keep_former_tables(std::span<const TableFile> former, const std::string& active_compensations,
                        const AtomicFolder& folder) {
  std::filesystem::create_directories(folder.path(kFormerTables));
  for (const TableFile& file : former)
    folder.write(TableFile{std::string(kFormerTables) + "/" + file.name, file.content, file.further});
  folder.write(kFormerMetadata, std::string(kHeaderOfFormer) + "\n" + kActiveBefore + "," +
                                    csv_cell(active_compensations) + "\n");
}

std::string active_before_former_tables(const TableFile& metadata) {
  for (const CsvRow& row : csv_rows(metadata, kHeaderOfFormer)) {
    if (row.cells[0] == kActiveBefore) return row.cells[1];
  }
  throw InputError({metadata.name, 0}, std::string("key ") + kActiveBefore + " is missing",
                   "write the tables again");
}

}  // namespace volcal
