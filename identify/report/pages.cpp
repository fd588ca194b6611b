#include <array>

#include "volcal/identify/report/page.h"

namespace volcal::report {
namespace {

constexpr bool kOfReadings = true;

constexpr std::array kPages = {
    Page{"summary", "Summary", summary_page, kOfReadings},
    Page{"functions", "Error functions", functions_page},
    Page{"locations", "Squareness and location", locations_page},
    Page{"rotary_axes", "Rotary axes", rotary_axes_page},
    Page{"surfaces", "Surfaces and curves without a name", surfaces_page},
    Page{"volume", "Work volume", volume_page},
    Page{"residuals", "Residuals", residuals_page, kOfReadings},
    Page{"outliers", "Suspect readings", outliers_page, kOfReadings},
    Page{"setups", "Setups and instruments", setups_page, kOfReadings},
    Page{"observability", "Observability", observability_page},
    Page{"resolution", "Resolution of the functions", resolution_page},
    Page{"nuisance", "Nuisance parameters", nuisance_page, kOfReadings},
    Page{"computation", "Computation and symbols", computation_page},
};

constexpr std::array kDiagnosisPages = {
    DiagnosisPage{"story", "What was missing", story_page},
    DiagnosisPage{"volume_causes", "What makes the error in the volume", volume_causes_page},
    DiagnosisPage{"evidence", "Ranked evidence", evidence_page},
    DiagnosisPage{"confounding", "What the readings separate, and what to measure", confounding_page},
    DiagnosisPage{"added_variable", "The leading effect", added_variable_page},
    DiagnosisPage{"residual_variables", "Residuals against what was recorded", residual_variables_page},
    DiagnosisPage{"residual_vectors", "Residuals in the work volume", residual_vectors_page},
    DiagnosisPage{"generic_map", "Scan without a catalogue", generic_map_page},
    DiagnosisPage{"autocorrelation", "Autocorrelation of the residuals", autocorrelation_page},
    DiagnosisPage{"detectable", "Smallest detectable effects", detectable_page},
    DiagnosisPage{"noise_model", "Noise model", noise_model_page},
};

constexpr std::array kPicturePages = {DiagnosisPage{"picture", "What was found first", picture_page}};

constexpr ComparisonPage kCircles{"circles", "Circles of the ball-bar, ISO 230-4", circles_page};
constexpr ComparisonPage kPositioning{"positioning", "Positioning of the axes, ISO 230-2", positioning_page};
constexpr ComparisonPage kDiagonals{"diagonals", "Diagonals, ISO 230-6", diagonals_page};
constexpr ComparisonPage kSetupResiduals{"setup_residuals", "Residuals by setup", setup_residuals_page};
constexpr ComparisonPage kDirectTests{"direct_tests", "Axes of rotation, ISO 230-7; drift, ISO 230-3",
                                      direct_tests_page};
constexpr ComparisonPage kRotaryAxes{"rotary_axes", "Rotary axes", compared_rotary_axes_page};
constexpr ComparisonPage kComparison{"comparison", "Where it fails", comparison_page};

constexpr std::array kComparisonPages = {kComparison,  kCircles,        kPositioning, kDiagonals,
                                         kDirectTests, kSetupResiduals, kRotaryAxes};
constexpr std::array kValidationPages = {
    ComparisonPage{"validation", "Before and after", validation_page},
    kComparison,
    kCircles,
    kPositioning,
    kDiagonals,
    kDirectTests,
    kSetupResiduals,
    kRotaryAxes,
};

constexpr std::array kMonteCarloPages = {
    MonteCarloPage{"uncertainties", "Linear propagation and Monte Carlo", uncertainties_page},
    MonteCarloPage{"budget", "Where the uncertainty comes from", budget_page},
};

constexpr std::array kPlanPages = {
    PlanPage{"plan_layout", "The plan", plan_layout_page},
    PlanPage{"plan_errors", "Every error", plan_errors_page},
    PlanPage{"detectable", "Smallest detectable effects", plan_detectable_page},
};

constexpr std::array kCertificatePages = {
    CertificatePage{"certified", "What is certified", certified_page},
    CertificatePage{"certificate_figures", "Before and after", certificate_figures_page},
    CertificatePage{"rotary_tables", "Tables of rotary axes", certified_rotary_tables_page},
    CertificatePage{"certificate_record", "Record, ISO/TR 16907 clause 9.1", certificate_record_page},
    CertificatePage{"certificate_files", "Files", certificate_files_page},
    CertificatePage{"signature", "Signature", signature_page},
};

constexpr std::array kTablesPicturePages = {
    TablesPage{"rotary_tables", "Tables of rotary axes", rotary_tables_page}};

}  // namespace

std::span<const Page> pages() { return kPages; }
std::span<const DiagnosisPage> diagnosis_pages() { return kDiagnosisPages; }
std::span<const DiagnosisPage> picture_pages() { return kPicturePages; }
std::span<const ComparisonPage> comparison_pages() { return kComparisonPages; }
std::span<const ComparisonPage> validation_pages() { return kValidationPages; }
std::span<const MonteCarloPage> montecarlo_pages() { return kMonteCarloPages; }
std::span<const PlanPage> plan_pages() { return kPlanPages; }
std::span<const TablesPage> tables_picture_pages() { return kTablesPicturePages; }
std::span<const CertificatePage> certificate_pages() { return kCertificatePages; }

}  // namespace volcal::report
