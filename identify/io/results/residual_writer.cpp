#include "volcal/identify/io/results/residual_writer.h"

#include <fmt/format.h>

#include <cstdio>
#include <iterator>
#include <memory>

#include "volcal/identify/text/csv_cell.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

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
      name = csv_cell(setup.name);
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
