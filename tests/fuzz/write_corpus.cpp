/// Writes the seed corpus of the fuzzers, made from the schemas: write_corpus FOLDER.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "tests/support/program_harness.h"
#include "tests/support/reader_harness.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/solve/result.h"

namespace {

void write(const std::filesystem::path& folder, const std::string& fuzzer, const std::string& name,
           const std::string& content) {
  std::filesystem::create_directories(folder / fuzzer);
  std::ofstream(folder / fuzzer / name, std::ios::binary) << content;
}

}  // namespace

int main(int count, char** arguments) {
  using namespace volcal::testing;
  if (count != 2) {
    std::cerr << "usage: write_corpus FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  write(folder, "machine", "sample", sample_machine());
  write(folder, "model", "sample", sample_model());
  write(folder, "campaign", "sample", sample_campaign());
  volcal::FitResult result;
  result.machine = harness_machine();
  result.identified = volcal::parse_model(sample_model(), "model.toml", result.machine);
  write(folder, "result", "sample", volcal::result_json(result));
  const auto all = volcal::instruments();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const auto& columns : all[i]->schema().column_sets) {
      const std::string choice = {static_cast<char>(i), '\0'};
      write(folder, "csv", all[i]->schema().name + "-" + columns.front().column,
            choice + sample_csv(columns));
    }
  }
  write(folder, "program", "modal", "\2" + sample_program());
  write(folder, "program", "offsets", std::string(1, '\0') + sample_local_program());
  const auto formats = volcal::table_formats();
  for (std::size_t i = 0; i < formats.size(); ++i)
    write(folder, "tables", std::string(formats[i]->name),
          static_cast<char>(i) + packed_files(sample_tables(*formats[i])));
  return 0;
}
