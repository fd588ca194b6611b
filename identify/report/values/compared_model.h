#pragma once
/// A model on the readings of a campaign: its residuals broken down, and the standards' figures of readings
/// and predictions side by side. What texts, JSON and pages of a comparison are made from.

#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/report/values/circle_causes.h"
#include "volcal/identify/report/values/rotary_pictures.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/standards/comparison.h"
#include "volcal/identify/standards/standard_figures.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// `name` as the user knows it: "nominal machine", "result".
struct ComparedModel {
  std::string name;
  std::vector<ResidualRecord> records;
  Comparison comparison;
  StandardFigures figures;
  std::optional<Screening> screening;  ///< of an identified model: scans of its residuals
  std::vector<std::vector<CircleCause>> circle_causes = {};  ///< per circle of `figures`; or none at all
  std::optional<RotaryPictures> rotary = {};                 ///< of an identified model, for its pages
};

/// Breaks the residuals down and evaluates the standards' figures.
ComparedModel compared_model(std::string name, const Campaign& campaign, std::vector<ResidualRecord> records,
                             const ComparisonOptions& options = {});

/// A model on lines that its fit has not seen.
struct HeldOutModel {
  std::string name;
  bool fitted = true;  ///< anew, without these lines; false: nothing to fit, or its coefficients as they are
  Comparison comparison;
};

}  // namespace volcal
