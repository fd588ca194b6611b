/// Writes the seed corpus of the fuzzers, made from the schemas: write_corpus FOLDER.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/hand_made_diagnosis.h"
#include "tests/support/import_files.h"
#include "tests/support/program_harness.h"
#include "tests/support/reader_harness.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/result/result.h"
#include "volcal/studies/criticism/criticism_record.h"

namespace {

void write(const std::filesystem::path& folder, const std::string& fuzzer, const std::string& name,
           const std::string& content) {
  std::filesystem::create_directories(folder / fuzzer);
  std::ofstream(folder / fuzzer / name, std::ios::binary) << content;
}

/// What a checkpoint of a study of two quantities holds after three draws.
std::string sample_state() {
  volcal::StudySums sums(2);
  Eigen::ArrayXXd t(3, 2);
  t << 0.5, -1.0, 0.0, 2.0, -0.25, 9.0;
  volcal::Histograms counts(2);
  counts.add(t);
  sums.add(volcal::Moments::of(t), counts);
  volcal::StateWriter writer;
  sums.visit_state(writer);
  return writer.take();
}

volcal::studies::CampaignRecord sample_record() {
  volcal::studies::HiddenRecord hidden;
  hidden.text = "reversal";
  hidden.drivers = {"dir_x"};
  volcal::studies::AnswerRecord answer;
  answer.name = "reversal:EXX:dir_x:step";
  answer.amplitudes = {{1.0, 0.1, 0.2, 1.1}};
  volcal::studies::CampaignRecord record;
  record.row = "listed";
  record.hidden = {hidden};
  record.named = {answer};
  record.sets = {{answer}};
  record.unknown = {{{"x", "time"}, "Z", -6.5}};
  record.noise_terms = {"white"};
  return record;
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
  write(folder, "study", "sample", sample_study());
  write(folder, "diagnosis", "sample", volcal::diagnosis_json(hand_made_diagnosis()));
  write(folder, "points", "sample", sample_points());
  write(folder, "workbench", "add", "add\n{\"effect\": \"reversal:EXX:dir_x:step\"}");
  write(folder, "workbench", "leave-out",
        "leave-out\n{\"observations\": [1, 2], \"reason\": \"cable moved\"}");
  write(folder, "workbench", "formula", "formula\n{\"text\": \"EXX += x\", \"parameters\": [\"p=1\"]}");
  write(folder, "workbench", "columns", "columns\n{\"names\": [\"x\", \"residual@0\"]}");
  write(folder, "workbench", "line", "leave-out 3,7-9 cable moved");
  write(folder, "workbench", "line-formula", "formula EXX += sin(x / p) with p=10+-1");
  const std::string state = sample_state();
  write(folder, "checkpoint", "state", state);
  write(folder, "checkpoint", "file", volcal::checkpoint_bytes(7, state));
  write(folder, "archive", "sample", nlohmann::json(sample_record()).dump());
  const auto tables = volcal::result_tables(small_result(), {});
  write(folder, "errors", "functions", std::string(1, '\0') + tables[0].content);
  write(folder, "errors", "metadata", "\1" + volcal::table_metadata_csv(small_result(), {}));
  const auto all = volcal::instruments();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t set = 0; set < all[i]->schema().column_sets.size(); ++set) {
      const auto columns = all[i]->schema().file_columns(set);
      const std::string choice = {static_cast<char>(i), '\0'};
      write(folder, "csv", all[i]->schema().name + "-" + columns.front().column,
            choice + sample_csv(columns));
    }
  }
  for (const SampleImport& sample : sample_imports()) {
    const char format = sample.format == "rtl" ? '\0' : sample.format == "tracker" ? '\1' : '\2';
    const char said =
        static_cast<char>(4 | (sample.format == "csv" ? 64 : 0) | (sample.answers.encoding ? 1 : 0) |
                          (sample.answers.measures ? 0 : 8));
    write(folder, "import", sample.name, std::string{format, said} + sample.bytes);
  }
  write(folder, "program", "modal", "\2" + sample_program());
  write(folder, "program", "offsets", std::string(1, '\0') + sample_local_program());
  const auto formats = volcal::table_formats();
  for (std::size_t i = 0; i < formats.size(); ++i)
    write(folder, "tables", std::string(formats[i]->name),
          static_cast<char>(i) + packed_files(sample_tables(*formats[i])));
  return 0;
}
