#include "volcal/identify/io/table_writer.h"

#include <fmt/format.h>

#include <cctype>
#include <cstdio>
#include <iterator>
#include <memory>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr double kMicro = 1e-6;  // um or urad to SI

std::string_view position_unit(AxisName axis) { return is_rotary(axis) ? "deg" : "mm"; }

double position_factor(AxisName axis) { return is_rotary(axis) ? kRadianPerDegree : kMetrePerMillimetre; }

/// A name as a CSV cell.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string component_column(Component component) {
  const char letter =
      static_cast<char>(std::tolower(static_cast<unsigned char>(letter_of(kAllAxes[index_of(component)]))));
  return fmt::format("e{}_{}", letter, edge_unit(component));
}

/// A text file written in pieces.
class TextSink {
 public:
  explicit TextSink(std::string path)
      : path_(std::move(path)), file_(std::fopen(path_.c_str(), "wb"), &std::fclose) {
    if (!file_) fail("creating");
  }
  fmt::memory_buffer& buffer() { return buffer_; }
  void flush_if_large() {
    if (buffer_.size() > (std::size_t{1} << 20)) flush();
  }
  void close() {
    flush();
    if (std::fclose(file_.release()) != 0) fail("writing");
  }

 private:
  void flush() {
    if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_.get()) != buffer_.size()) fail("writing");
    buffer_.clear();
  }
  [[noreturn]] void fail(const char* doing) const {
    throw InputError({path_, 0}, std::string(doing) + " the file failed",
                     "check the folder and the free space");
  }

  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  fmt::memory_buffer buffer_;
};

}  // namespace

std::string error_tables_csv(const std::vector<ErrorTableRow>& rows) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "symbol,axis,position,position_unit,direction,value,unit,u,U95,extrapolated\n");
  for (const ErrorTableRow& row : rows) {
    fmt::format_to(out, "{},", row.symbol);
    if (row.axis) {
      fmt::format_to(out, "{},{:.10g},{},", letter_of(*row.axis), row.position / position_factor(*row.axis),
                     position_unit(*row.axis));
    } else {
      fmt::format_to(out, ",,,");
    }
    fmt::format_to(out, "{},{:.9g},{},{:.6g},{:.6g},{}\n", row.direction, row.value / kMicro,
                   row.rotation ? "urad" : "um", row.u / kMicro, row.U95 / kMicro, row.extrapolated ? 1 : 0);
  }
  return fmt::to_string(text);
}

std::string volumetric_grid_csv(const std::vector<VolumetricError>& grid, const Machine& machine) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  for (const AxisName axis : kAllAxes) {
    if (!machine.has_axis(axis)) continue;
    const char letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter_of(axis))));
    fmt::format_to(out, "{}_{},", letter, position_unit(axis));
  }
  fmt::format_to(out, "tool");
  for (const Component component : kAllComponents) fmt::format_to(out, ",{}", component_column(component));
  for (const Component component : kAllComponents) fmt::format_to(out, ",u_{}", component_column(component));
  fmt::format_to(out, ",extrapolated\n");
  for (const VolumetricError& point : grid) {
    for (const AxisName axis : kAllAxes) {
      if (!machine.has_axis(axis)) continue;
      fmt::format_to(out, "{:.10g},", point.position[index_of(axis)] / position_factor(axis));
    }
    fmt::format_to(out, "{}", cell(point.tool));
    for (const double value : point.value) fmt::format_to(out, ",{:.9g}", value / kMicro);
    for (const double u : point.u) fmt::format_to(out, ",{:.6g}", u / kMicro);
    fmt::format_to(out, ",{}\n", point.extrapolated ? 1 : 0);
  }
  return fmt::to_string(text);
}

std::string residuals_csv_header() {
  return "setup,row,reading,predicted,residual_um,sigma_um,standardized,redundancy,w,flagged,column,"
         "removed\n";
}

void write_residuals_csv(const std::string& path, const FitResult& result, const Campaign& campaign) {
  write_residuals_csv(path, result.residuals, campaign);
}

void write_residuals_csv(const std::string& path, const std::vector<ResidualRecord>& residuals,
                         const Campaign& campaign) {
  TextSink sink(path);
  auto out = std::back_inserter(sink.buffer());
  fmt::format_to(out, "{}", residuals_csv_header());
  std::size_t setup_index = campaign.setups.size();
  std::string name;
  const std::vector<ColumnSchema>* columns = nullptr;
  for (const ResidualRecord& record : residuals) {
    if (record.setup != setup_index) {
      setup_index = record.setup;
      const Setup& setup = campaign.setups.at(setup_index);
      name = cell(setup.name);
      columns = &find_instrument(setup.instrument)->schema().column_sets.at(setup.readings.column_set);
    }
    const std::string& column = columns->at(static_cast<std::size_t>(record.channel)).column;
    const double factor = unit_of_key(column).si_per_unit;
    const double residual = record.residual();
    fmt::format_to(out, "{},{},{:.12g},{:.12g},{:.7g},{:.7g},{:.6g},{:.6g},{:.6g},{},{},{}\n", name,
                   record.source_line, record.reading / factor, record.predicted / factor, residual / kMicro,
                   record.sigma / kMicro, residual / record.sigma, record.redundancy, record.w,
                   record.flagged ? 1 : 0, column, record.removed ? 1 : 0);
    sink.flush_if_large();
  }
  sink.close();
}

}  // namespace volcal
