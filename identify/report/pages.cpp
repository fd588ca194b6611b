#include <array>

#include "volcal/identify/report/page.h"

namespace volcal::report {
namespace {

constexpr std::array kPages = {
    Page{"summary", "Summary", summary_page},
    Page{"functions", "Error functions", functions_page},
    Page{"locations", "Squareness and location", locations_page},
    Page{"volume", "Work volume", volume_page},
    Page{"residuals", "Residuals", residuals_page},
    Page{"outliers", "Suspect readings", outliers_page},
    Page{"setups", "Setups and instruments", setups_page},
    Page{"observability", "Observability", observability_page},
    Page{"resolution", "Resolution of the functions", resolution_page},
    Page{"nuisance", "Nuisance parameters", nuisance_page},
    Page{"computation", "Computation and symbols", computation_page},
};

}  // namespace

std::span<const Page> pages() { return kPages; }

}  // namespace volcal::report
