#include "volcal/identify/report/report.h"

#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/template_data.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::string_view kDataSlot = "@VOLCAL_REPORT_DATA@";
constexpr std::string_view kTitleSlot = "@VOLCAL_REPORT_TITLE@";
constexpr int kGridPerAxis = 5;

/// No text inside a script element may look like markup: every `<` is written as its JSON escape.
std::string without_markup(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string html_text(const std::string& plain) {
  std::string text;
  for (const char c : plain) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      default:
        text += c;
    }
  }
  return text;
}

std::string fill(std::string_view page, std::string_view slot, const std::string& content) {
  const std::size_t place = page.find(slot);
  if (place == std::string_view::npos) throw std::logic_error("report template lacks " + std::string(slot));
  std::string filled;
  filled.reserve(page.size() + content.size());
  filled.append(page.substr(0, place)).append(content).append(page.substr(place + slot.size()));
  return filled;
}

template <class Input>
std::string document(const std::string& title, const std::string& subtitle, const ReportOptions& options,
                     std::span<const report::PageOf<Input>> pages, const Input& input,
                     bool has_readings = true, bool upright = false) {
  report::Json document;
  document["format"] = "volcal-report-1";
  document["title"] = title;
  document["subtitle"] = subtitle;
  document["date"] = options.date;
  document["version"] = options.provenance.version;
  document["command"] = options.provenance.command;
  if (upright) document["paper"] = "upright";
  document["pages"] = report::Json::array();
  for (const report::PageOf<Input>& page : pages) {
    if (page.of_readings && !has_readings) continue;
    report::Json data = page.build(input);
    if (data.is_null()) continue;
    document["pages"].push_back({{"kind", page.kind}, {"title", page.title}, {"data", std::move(data)}});
  }
  return json_text(document, -1);
}

std::string filled_page(const std::string& title, const std::string& json) {
  if (!report_available()) throw std::runtime_error(std::string(how_to_get_report()));
  // The title stands first on the page: filled last, its slot is found before any text of the user's.
  return fill(fill(report::page_template(), kDataSlot, without_markup(json)), kTitleSlot, html_text(title));
}

}  // namespace

namespace report {

PageInput::PageInput(const FitResult& fit, const Campaign& readings, const ReportOptions& report_options)
    : result(fit), campaign(readings), options(report_options), volume(tool_volumes(fit, kGridPerAxis)) {}

}  // namespace report

bool report_available() { return !report::page_template().empty(); }

std::string_view how_to_get_report() {
  return "the program was built without Node.js; install nodejs and npm and run scripts/build again";
}

std::string report_json(const FitResult& result, const Campaign& campaign, const ReportOptions& options) {
  const bool is_aligned = !result.alignment.empty();
  const std::string subtitle = "Geometric errors identified from measurements" +
                               (is_aligned ? ", aligned: " + result.alignment : std::string());
  return document(result.machine.name, subtitle, options, report::pages(),
                  report::PageInput(result, campaign, options), !is_aligned);
}

std::string report_json(const Diagnosis& diagnosis, const Campaign& campaign, const ReportOptions& options,
                        const VolumeCauses* causes) {
  return document(campaign.machine.name, "Where the model fails, and which effect is missing", options,
                  report::diagnosis_pages(), report::DiagnosisInput{diagnosis, campaign, causes});
}

std::string report_html(const FitResult& result, const Campaign& campaign, const ReportOptions& options) {
  return filled_page(result.machine.name + " \u2013 volcal report", report_json(result, campaign, options));
}

std::string report_html(const Diagnosis& diagnosis, const Campaign& campaign, const ReportOptions& options,
                        const VolumeCauses* causes) {
  return filled_page(campaign.machine.name + " \u2013 volcal diagnosis",
                     report_json(diagnosis, campaign, options, causes));
}

ReportPicture diagnosis_picture(const Diagnosis& diagnosis, const Campaign& campaign,
                                const ReportOptions& options) {
  constexpr int kWidth = 1240;
  constexpr int kHeightOfMap = 860, kHeightOfCurve = 640, kHeightOfPlot = 760;
  const std::string json =
      document(campaign.machine.name, "What was found first", {.date = options.date, .provenance = {}},
               report::picture_pages(), report::DiagnosisInput{diagnosis, campaign});
  const int height = diagnosis.surfaces.empty()                       ? kHeightOfPlot
                     : diagnosis.surfaces.front().drivers.size() == 1 ? kHeightOfCurve
                                                                      : kHeightOfMap;
  return {filled_page(campaign.machine.name, json), kWidth, height};
}

ReportPicture tables_picture(const FitResult& result, const MadeTables& made, const ReportOptions& options) {
  if (!made.rotary_check)
    throw InputError(
        {}, made.options.type.name() + " has no tables of rotary axes, and the picture shows those",
        "name a type of rotary axes such as R-VOL; the report of volcal fit pictures linear axes");
  constexpr int kTablesWidth = 1240, kHeightOfAxis = 300, kHeightOfMaps = 900, kHeightOfWords = 210;
  const std::string json =
      document(result.machine.name, "Tables of rotary axes", {.date = options.date, .provenance = {}},
               report::tables_picture_pages(), report::TablesInput{result, made});
  const auto axes = static_cast<int>(identified_rotary_axes(result).size());
  return {filled_page(result.machine.name, json), kTablesWidth,
          kHeightOfWords + axes * kHeightOfAxis + kHeightOfMaps};
}

std::string report_json(const ComparisonView& comparison, const Campaign& campaign,
                        const ReportOptions& options) {
  return document(campaign.machine.name, "Where a model fails to explain the readings", options,
                  report::comparison_pages(),
                  report::ComparisonInput{comparison.models, comparison.heldout, nullptr, campaign});
}

std::string report_html(const ComparisonView& comparison, const Campaign& campaign,
                        const ReportOptions& options) {
  return filled_page(campaign.machine.name + " \u2013 volcal comparison",
                     report_json(comparison, campaign, options));
}

std::string report_json(const ValidationView& validation, const Campaign& campaign,
                        const ReportOptions& options) {
  return document(campaign.machine.name, "An identified model on readings", options,
                  report::validation_pages(),
                  report::ComparisonInput{validation.models, {}, &validation, campaign});
}

std::string report_html(const ValidationView& validation, const Campaign& campaign,
                        const ReportOptions& options) {
  return filled_page(campaign.machine.name + " \u2013 volcal validation",
                     report_json(validation, campaign, options));
}

std::string report_json(const MonteCarloResult& study, const Machine& machine, const ReportOptions& options) {
  return document(machine.name, "How sure the identified errors are", options, report::montecarlo_pages(),
                  report::MonteCarloPageInput{study});
}

std::string report_html(const MonteCarloResult& study, const Machine& machine, const ReportOptions& options) {
  return filled_page(machine.name + " \u2013 volcal Monte Carlo", report_json(study, machine, options));
}

std::string report_json(const CampaignPlan& plan, const ReportOptions& options) {
  return document(plan.settings.machine.name, "Which campaign to measure, and what it would tell", options,
                  report::plan_pages(), report::PlanPageInput{plan});
}

std::string report_html(const CampaignPlan& plan, const ReportOptions& options) {
  return filled_page(plan.settings.machine.name + " \u2013 volcal plan", report_json(plan, options));
}

std::string report_json(const CertificateView& certificate, const ReportOptions& options) {
  return document(certificate.result.machine.name, "Certificate of compensation", options,
                  report::certificate_pages(), report::CertificateInput{certificate, options}, true, true);
}

std::string report_html(const CertificateView& certificate, const ReportOptions& options) {
  return filled_page(certificate.result.machine.name + " \u2013 certificate",
                     report_json(certificate, options));
}

}  // namespace volcal
