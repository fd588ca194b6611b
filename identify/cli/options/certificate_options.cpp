#include "volcal/identify/cli/options/certificate_options.h"

#include <CLI/CLI.hpp>

#include "volcal/identify/cli/options/picture.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/record_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

/// A campaign of the same machine, of whose readings nothing was identified.
Campaign verifying_campaign(const std::string& file, const FitResult& result) {
  const Campaign campaign = read_campaign(file);
  if (fitted_readings(campaign, result).readings > 0)
    throw InputError({file, 0}, "--verified: the result was identified from readings of this campaign",
                     "name a campaign that was measured with the tables active");
  return readings_for(campaign, result, {file, 0}).value_or(campaign);
}

void require_certificate_can_be_made(const CertificateArguments& arguments, bool written) {
  if (!written) throw InputError({}, "--certificate needs tables, and none are written", "give -o FOLDER");
  if (!report_available())
    throw InputError({}, "--certificate draws a page of the report, which this program lacks",
                     std::string(how_to_get_report()));
  if (arguments.pdf) require_browser("--pdf", "leave it out and print certificate.html from a browser");
}

}  // namespace

void add_certificate_options(CLI::App& app, CertificateArguments& arguments) {
  auto* certificate = app.add_option(
      "--certificate", arguments.campaign,
      "campaign.toml that the result was identified from: also write certificate.html, with its table "
      "[record], the figures before and after, and fields to sign");
  app.add_option("--verified", arguments.verified,
                 "campaign.toml that was measured with the tables active, for the figures after")
      ->needs(certificate);
  app.add_flag("--pdf", arguments.pdf, "also certificate.pdf, by a headless Chromium")->needs(certificate);
}

std::optional<CertificateSources> certificate_sources(const CertificateArguments& arguments,
                                                      const FitResult& result, bool written) {
  if (arguments.campaign.empty()) return std::nullopt;
  require_certificate_can_be_made(arguments, written);
  const Campaign campaign = read_campaign(arguments.campaign);
  require_campaign_of(result, campaign);
  CertificateSources sources{read_campaign_record(arguments.campaign), measured_error(campaign), {}};
  if (!arguments.verified.empty())
    sources.after = measured_error(verifying_campaign(arguments.verified, result));
  return sources;
}

void write_certificate(const CertificateArguments& arguments, const CertificateView& certificate,
                       const ReportOptions& options, const AtomicFolder& folder) {
  const std::string page = report_html(certificate, options);
  folder.write(std::string(kCertificatePage), page);
  if (arguments.pdf) print_page("--pdf", page, folder.path(std::string(kCertificatePdf)));
}

}  // namespace volcal::cli
