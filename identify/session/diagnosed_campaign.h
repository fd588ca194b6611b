#pragma once
/// A diagnosis without a person: a session of one campaign and one model that is asked once.

#include "volcal/identify/criticism/diagnosis.h"

namespace volcal {

/// Session::diagnosis() of the given model. Throws InputError as fit() does.
DiagnosedModel diagnosed_campaign(const Campaign& campaign, const ModelSpec& model,
                                  const DiagnoseOptions& options);

}  // namespace volcal
