#pragma once
/// Draws a diagnosis (figure_data.h) from the model that was criticised and the one that it reached.

#include "volcal/identify/criticism/data/figure_data.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

/// Both states are tested. Of the model reached, residuals of every observation; of both, the scans.
DiagnosisFigures diagnosis_figures(const ModelState& given, const ModelState& reached);

}  // namespace volcal
