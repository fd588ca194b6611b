#include "volcal/identify/report/values/compared_model.h"

#include <utility>

namespace volcal {

ComparedModel compared_model(std::string name, const Campaign& campaign, std::vector<ResidualRecord> records,
                             const ComparisonOptions& options) {
  ComparedModel model{std::move(name), std::move(records), {}, {}, {}};
  model.comparison = compare(campaign, model.records, options);
  model.figures = standard_figures(campaign, model.records);
  return model;
}

}  // namespace volcal
