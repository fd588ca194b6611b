#pragma once
/// Sections of the reports, of a result, a diagnosis, a comparison, a validation, a Monte Carlo study and a
/// plan, and of the certificate. A new section is one file in pages/ with a builder, one line in pages.cpp,
/// and a renderer of the same kind with one line in web/src/pages.js.

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/values/volume_error.h"

namespace volcal::report {

using Json = nlohmann::ordered_json;

/// What a section is made from; quantities that several sections show are computed once.
struct PageInput {
  const FitResult& result;
  const Campaign& campaign;
  const ReportOptions& options;
  std::vector<ToolVolume> volume;  ///< volumetric error on a grid, per tool

  PageInput(const FitResult& fit, const Campaign& readings, const ReportOptions& report_options);
};

template <class Input>
struct PageOf {
  std::string_view kind;              ///< name of the renderer
  std::string_view title;             ///< heading and entry of the section list
  Json (*build)(const Input& input);  ///< null: there is nothing to show, the section is left out
  bool of_readings = false;           ///< left out of an aligned result, which has none
};

using Page = PageOf<PageInput>;
std::span<const Page> pages();

Json summary_page(const PageInput& input);
Json functions_page(const PageInput& input);
Json locations_page(const PageInput& input);
Json rotary_axes_page(const PageInput& input);
Json surfaces_page(const PageInput& input);
Json volume_page(const PageInput& input);
Json residuals_page(const PageInput& input);
Json outliers_page(const PageInput& input);
Json setups_page(const PageInput& input);
Json observability_page(const PageInput& input);
Json resolution_page(const PageInput& input);
Json nuisance_page(const PageInput& input);
Json computation_page(const PageInput& input);

/// What a section of a diagnosis' report is made from.
struct DiagnosisInput {
  const Diagnosis& diagnosis;
  const Campaign& campaign;
  const VolumeCauses* causes = nullptr;
};

/// What a section of a Monte Carlo study's report is made from.
struct MonteCarloPageInput {
  const MonteCarloResult& study;
};

using MonteCarloPage = PageOf<MonteCarloPageInput>;
std::span<const MonteCarloPage> montecarlo_pages();

Json uncertainties_page(const MonteCarloPageInput& input);
Json budget_page(const MonteCarloPageInput& input);

/// What a section of a plan's report is made from.
struct PlanPageInput {
  const CampaignPlan& plan;
};

using PlanPage = PageOf<PlanPageInput>;
std::span<const PlanPage> plan_pages();

Json plan_layout_page(const PlanPageInput& input);
Json plan_errors_page(const PlanPageInput& input);
Json plan_detectable_page(const PlanPageInput& input);

/// What a section on tables is made from.
struct TablesInput {
  const FitResult& result;
  const MadeTables& made;
};

using TablesPage = PageOf<TablesInput>;
/// The one section of a picture.
std::span<const TablesPage> tables_picture_pages();

Json rotary_tables_page(const TablesInput& input);

/// What a section of a certificate is made from.
struct CertificateInput {
  const CertificateView& certificate;
  const ReportOptions& options;
};

using CertificatePage = PageOf<CertificateInput>;
std::span<const CertificatePage> certificate_pages();

Json certified_page(const CertificateInput& input);
Json certificate_record_page(const CertificateInput& input);
Json certificate_figures_page(const CertificateInput& input);
Json certificate_files_page(const CertificateInput& input);
Json signature_page(const CertificateInput& input);
Json certified_rotary_tables_page(const CertificateInput& input);

/// What a section of a comparison's or a validation's report is made from.
struct ComparisonInput {
  std::span<const ComparedModel> models;
  std::span<const HeldOutModel> heldout;
  const ValidationView* validation = nullptr;  ///< of a validation
  const Campaign& campaign;
};

using ComparisonPage = PageOf<ComparisonInput>;
std::span<const ComparisonPage> comparison_pages();
std::span<const ComparisonPage> validation_pages();

Json comparison_page(const ComparisonInput& input);
Json validation_page(const ComparisonInput& input);
Json circles_page(const ComparisonInput& input);
Json positioning_page(const ComparisonInput& input);
Json diagonals_page(const ComparisonInput& input);
Json setup_residuals_page(const ComparisonInput& input);
Json direct_tests_page(const ComparisonInput& input);
Json compared_rotary_axes_page(const ComparisonInput& input);

using DiagnosisPage = PageOf<DiagnosisInput>;
std::span<const DiagnosisPage> diagnosis_pages();
/// The one section of a picture.
std::span<const DiagnosisPage> picture_pages();

Json picture_page(const DiagnosisInput& input);
Json story_page(const DiagnosisInput& input);
Json volume_causes_page(const DiagnosisInput& input);
Json evidence_page(const DiagnosisInput& input);
Json added_variable_page(const DiagnosisInput& input);
Json residual_variables_page(const DiagnosisInput& input);
Json residual_vectors_page(const DiagnosisInput& input);
Json generic_map_page(const DiagnosisInput& input);
Json confounding_page(const DiagnosisInput& input);
Json autocorrelation_page(const DiagnosisInput& input);
Json detectable_page(const DiagnosisInput& input);
Json noise_model_page(const DiagnosisInput& input);

}  // namespace volcal::report
