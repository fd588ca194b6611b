#pragma once
/// Options of `volcal tables` for the certificate of a compensation.

#include <CLI/App.hpp>
#include <optional>
#include <string>

#include "volcal/identify/report/report.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal::cli {

struct CertificateArguments {
  std::string campaign;
  std::string verified;
  bool pdf = false;
};

void add_certificate_options(CLI::App& app, CertificateArguments& arguments);

/// What a certificate states beside the result and its tables.
struct CertificateSources {
  MeasurementRecord record;
  MeasuredError before;
  std::optional<MeasuredError> after;
};

/// Nothing where no certificate is asked for. Throws InputError for options that do not go together, a
/// campaign that the result is not of, one that was verified and is not of this machine or was identified
/// from, and where the program lacks the report or, for --pdf, there is no Chromium. `written`: tables are
/// written into a folder.
std::optional<CertificateSources> certificate_sources(const CertificateArguments& arguments,
                                                      const FitResult& result, bool written);

/// certificate.html and, where it is asked for, certificate.pdf.
void write_certificate(const CertificateArguments& arguments, const CertificateView& certificate,
                       const ReportOptions& options, const AtomicFolder& folder);

}  // namespace volcal::cli
