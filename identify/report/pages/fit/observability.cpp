/// What the readings can see: visible fraction and uncertainty of every error, correlations, rank.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/text/fit_summary.h"
#include "volcal/identify/report/values/correlation.h"
#include "volcal/identify/result/error_unit.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

Json error_rows(const FitResult& result) {
  Json rows = Json::array();
  for (const Observability& error : result.rank.errors) {
    const Explanation words = explanation(error.cause);
    const ErrorUnit unit = unit_of(result, error.symbol);
    rows.push_back({{"symbol", error.symbol.name()},
                    {"axis", axis_letter_of(error.symbol)},
                    {"unit", shown_unit(unit.name)},
                    {"visible", error.visible},
                    {"visible_fraction", rounded(error.visible_fraction, 4)},
                    {"u_rms", rounded(error.u_rms / unit.si_per_unit, 3)},
                    {"effective_parameters", rounded(error.effective_parameters, 3)},
                    {"reason", words.reason},
                    {"remedy", words.remedy}});
  }
  return rows;
}

Json correlation_json(const FitResult& result) {
  const ErrorCorrelation correlation = error_correlation(result);
  Json rows = Json::array();
  for (Eigen::Index a = 0; a < correlation.value.rows(); ++a) {
    Json row = Json::array();
    for (Eigen::Index b = 0; b < correlation.value.cols(); ++b)
      row.push_back(rounded(correlation.value(a, b), 3));
    rows.push_back(std::move(row));
  }
  return {{"symbol", names_of(correlation.errors)}, {"value", std::move(rows)}};
}

}  // namespace

Json observability_page(const PageInput& input) {
  const FitResult& result = input.result;
  return {{"parameters", result.rank.parameters}, {"rank", result.rank.rank},
          {"rank_text", rank_text(result)},       {"invisible", sentences(result.rank.invisible)},
          {"errors", error_rows(result)},         {"correlation", correlation_json(result)}};
}

}  // namespace volcal::report
