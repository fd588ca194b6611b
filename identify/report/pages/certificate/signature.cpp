/// The files that the certificate is of, and where it is signed.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/values/posix_checksum.h"
#include "volcal/identify/text/table_text.h"

namespace volcal::report {

Json certificate_files_page(const CertificateInput& input) {
  Json rows = Json::array();
  for (const TableFile& file : input.certificate.tables.files) {
    const std::string content = whole_content(file);
    rows.push_back({{"name", file.name}, {"bytes", content.size()}, {"checksum", posix_checksum(content)}});
  }
  return {{"files", std::move(rows)}};
}

Json signature_page(const CertificateInput& input) {
  const CertificateView& certificate = input.certificate;
  return {{"operator", certificate.record.entry("operator")},
          {"date", input.options.date},
          {"measured_after", certificate.after.has_value()}};
}

}  // namespace volcal::report
