// A sample: one file, a line for each position of a table of an axis's own correction.
#include <fmt/format.h>

#include <iterator>

#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& sample_format();

namespace {

constexpr std::string_view kSampleFile = "sample.lines";

std::vector<TableFile> write_sample(const FitResult& result, const TableFormatOptions& options) {
#ifdef VOLCAL_WRONG_SAMPLE
  constexpr double kSign = -1.0;
#else
  constexpr double kSign = 1.0;
#endif
  fmt::memory_buffer text;
  for (const SampledTable& sampled : sample_axis_tables(sample_format(), result, options)) {
    const AxisTable& table = sampled.table;
    for (std::size_t i = 0; i < table.position.size(); ++i) {
      fmt::format_to(std::back_inserter(text), "{} {:.10g} {:.9g} {:.9g}\n", letter_of(table.input),
                     table.position[i] / kMetrePerMillimetre,
                     kSign * without_negative_zero(table.forward[i]) / kMetrePerMicrometre,
                     kSign * without_negative_zero(table.backward[i]) / kMetrePerMicrometre);
    }
  }
  return {{std::string(kSampleFile), fmt::to_string(text)}};
}

CompensationTables read_sample(std::span<const TableFile> files) {
  TableLines lines(file_named(files, kSampleFile));
  std::map<AxisName, AxisTable> tables;
  while (lines.advance_to_content()) {
    const std::vector<std::string_view> words = words_of(lines.current());
    const auto axis = words.front().size() == 1 ? axis_from_letter(words.front()[0]) : std::nullopt;
    if (words.size() != 4 || !axis || is_rotary(*axis))
      lines.fail("a line is an axis, a position and two corrections", "write X 10.0 -1.5 -1.5");
    AxisTable& table = tables[*axis];
    table.input = *axis;
    const double position = lines.number(words[1], "position") * kMetrePerMillimetre;
    require_ascending(table.position, position, lines.place());
    table.position.push_back(position);
    table.forward.push_back(lines.number(words[2], "correction") * kMetrePerMicrometre);
    table.backward.push_back(lines.number(words[3], "correction") * kMetrePerMicrometre);
  }
  if (tables.empty()) lines.fail("there is no table", "write lines such as X 10.0 -1.5 -1.5");
  CompensationTables result;
  for (auto& [axis, table] : tables) result.terms.push_back(axis_term(axis, std::move(table)));
  return result;
}

}  // namespace

const TableFormat& sample_format() {
  static const TableFormat format = {.name = "sample",
                                     .summary = "a line for each position of an axis; mm, um",
                                     .source = "a sample of a test",
                                     .verified = "read back by volcal",
                                     .supported = CompensationPart::Positioning,
                                     .refusal = "a line holds the correction of its own axis",
                                     .limits = {.both_directions = true},
                                     .settings = {},
                                     .write = write_sample,
                                     .read = read_sample};
  return format;
}

}  // namespace volcal
