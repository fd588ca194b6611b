#pragma once
/// The reports of a result, of a diagnosis, of a comparison, of a validation, of a Monte Carlo study and of a
/// plan, and the certificate of a compensation: each one self-contained HTML page with interactive plots,
/// readable without a network.
///
/// The page is a template (identify/report/web, bundled from npm packages when the program is built and kept
/// inside the library) that is filled with one JSON document. A page section is one C++ function that makes
/// its data and one JavaScript renderer; page.h and web/src/pages.js are the two registration tables.

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/compensation/measurement_record.h"
#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/report/values/compared_model.h"
#include "volcal/identify/report/values/measured_error.h"
#include "volcal/identify/report/values/volume_causes.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

struct ReportOptions {
  std::string date = {};       ///< as printed in the header; empty = none
  Provenance provenance = {};  ///< of this page; empty = not known
};

/// False when the library was built without Node.js; results are complete without the report.
bool report_available();
/// What to do when the report is not available, one sentence for the user.
std::string_view how_to_get_report();

/// The JSON document that fills the template. Values in um, urad, mm, deg, degC; lengths of arrays are
/// bounded, so that its size does not grow with the number of readings. An aligned result is shown without
/// the sections on readings; of its campaign the machine is used.
std::string report_json(const FitResult& result, const Campaign& campaign, const ReportOptions& options = {});
/// The whole page. Throws std::runtime_error with how_to_get_report() when it is not available.
std::string report_html(const FitResult& result, const Campaign& campaign, const ReportOptions& options = {});
/// The same for a diagnosis that diagnose() made of the campaign (not one read back: files hold no figures).
/// `causes`: what the error in the volume comes from; null = not shown.
std::string report_json(const Diagnosis& diagnosis, const Campaign& campaign,
                        const ReportOptions& options = {}, const VolumeCauses* causes = nullptr);
std::string report_html(const Diagnosis& diagnosis, const Campaign& campaign,
                        const ReportOptions& options = {}, const VolumeCauses* causes = nullptr);

/// A page that is made to be pictured: no list of sections, no controls.
struct ReportPicture {
  std::string html;
  int width = 0;  ///< px that it fills
  int height = 0;
};
/// What a diagnosis found first: its surface or curve, else the added-variable plot of the leading effect.
ReportPicture diagnosis_picture(const Diagnosis& diagnosis, const Campaign& campaign,
                                const ReportOptions& options = {});

/// What tables add to the commands for the errors of rotary axes, and the error over the positions of two
/// axes with and without them. Throws InputError for tables without a type of rotary axes.
ReportPicture tables_picture(const FitResult& result, const MadeTables& made,
                             const ReportOptions& options = {});

/// One or two models on the readings of a campaign.
struct ComparisonView {
  std::span<const ComparedModel> models;
  std::span<const HeldOutModel> heldout = {};
};
/// The same for a comparison.
std::string report_json(const ComparisonView& comparison, const Campaign& campaign,
                        const ReportOptions& options = {});
std::string report_html(const ComparisonView& comparison, const Campaign& campaign,
                        const ReportOptions& options = {});

/// An identified model on readings that it may not have been made from; `models`: before and after.
struct ValidationView {
  const ValidationFigures& figures;
  const FittedReadings& fitted;
  std::span<const ComparedModel> models;
};
/// The same for a validation.
std::string report_json(const ValidationView& validation, const Campaign& campaign,
                        const ReportOptions& options = {});
std::string report_html(const ValidationView& validation, const Campaign& campaign,
                        const ReportOptions& options = {});

/// The same for a Monte Carlo study of the machine.
std::string report_json(const MonteCarloResult& study, const Machine& machine,
                        const ReportOptions& options = {});
std::string report_html(const MonteCarloResult& study, const Machine& machine,
                        const ReportOptions& options = {});

/// The same for a campaign plan.
std::string report_json(const CampaignPlan& plan, const ReportOptions& options = {});
std::string report_html(const CampaignPlan& plan, const ReportOptions& options = {});

/// Tables for a controller as somebody signs them.
struct CertificateView {
  const FitResult& result;
  const MadeTables& tables;
  const MeasurementRecord& record;
  MeasuredError before;                ///< by the campaign that was identified
  std::optional<MeasuredError> after;  ///< by one that was measured with the tables active
};
/// The certificate: machine, operator, instruments, conditions and what else ISO/TR 16907:2015, 9.1, asks to
/// be documented, the figures before and after, the files with their POSIX checksums, and fields to sign.
/// Made for A4 upright.
std::string report_json(const CertificateView& certificate, const ReportOptions& options = {});
std::string report_html(const CertificateView& certificate, const ReportOptions& options = {});

}  // namespace volcal
