#include "volcal/identify/compensation/formats/isg_ssfk_lists.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

std::vector<TableFile> write_ssfk(const FitResult& result, const TableFormatOptions& options) {
  std::vector<TableFile> files;
  for (const SampledTable& sampled : sample_axis_tables(isg_ssfk_format(), result, options))
    files.push_back(ssfk_file(sampled.output, sampled.table));
  return files;
}

CompensationTables read_ssfk(std::span<const TableFile> files) {
  CompensationTables result;
  result.terms = ssfk_terms(files);
  if (result.terms.empty()) file_named(files, "achskw1.lis");  // says that it is missing
  return result;
}

}  // namespace

const TableFormat& isg_ssfk_format() {
  static const TableFormat format = {
      .name = "isg-ssfk",
      .summary =
          "ISG kernel and TwinCAT CNC leadscrew error compensation: one list per axis, achskw1.lis to "
          "achskw3.lis, with values towards + and towards -",
      .source =
          "Beckhoff, TF5200 TwinCAT 3 CNC, Axis compensation, Leadscrew error compensation: values are "
          "actual "
          "minus set position, in 0.1 um, linear between entries, end values held; P-COMP-00017 to 00025",
      .verified = "the manual's worked example; read back by volcal; not tried on a controller",
      .supported = CompensationPart::Positioning,
      .refusal =
          "leadscrew error compensation acts on its own axis only; isg-csv has tables of the whole volume",
      .limits = {.points_per_table = kMostSsfkEntries, .resolution = kSsfkUnit, .both_directions = true},
      .settings = {},
      .write = write_ssfk,
      .read = read_ssfk};
  return format;
}

}  // namespace volcal
