#pragma once
/// What `compare` says: where a model fails, first in a sentence, then in tables, then as the standards' own
/// figures of the readings and of the model. Edge units (um, urad, mm, deg).

#include <span>
#include <string>
#include <vector>

#include "volcal/identify/report/values/compared_model.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

struct ComparisonTextOptions {
  bool all_cells = false;  ///< every cell; else the worst few of each breakdown
  std::size_t worst = 10;  ///< readings listed
};

/// What a model of a file is called: where it holds no coefficients it is the nominal machine, and effects
/// without an amplitude count as nothing.
std::string compared_name(const std::string& name, const ModelSpec& model);

/// Adds to the notes of the campaign which of its rotary axes the models have no errors of, where it goes
/// beyond the readings of their errors, each axis, curve and surface once, and what tables hold that they
/// were read from (findings_of_tables()).
void note_compared(std::span<const ModelSpec> models, const std::vector<Finding>& of_tables,
                   Campaign& campaign);

/// "where does the model fail", one to three sentences.
std::string failure_sentence(const ComparedModel& model);
/// Whether a diagnosis pays.
bool fails(const ComparedModel& model);

/// One model, or two side by side with difference B - A and ratio B / A; the models are of the same campaign.
std::string comparison_text(const Campaign& campaign, std::span<const ComparedModel> models,
                            const ComparisonTextOptions& options = {});

/// Both models on the held-out lines, in the same form; `observations`: of the whole campaign.
std::string heldout_text(const Campaign& campaign, std::span<const HeldOutModel> models,
                         std::size_t observations);
/// What to do for figures of lines that no fit has seen, when two models are shown without them.
std::string heldout_hint();

/// Everything of the text and more as one JSON document, ending in a newline; "held_out" when there are any.
std::string comparison_json(const Campaign& campaign, std::span<const ComparedModel> models,
                            std::span<const HeldOutModel> heldout = {});

}  // namespace volcal
