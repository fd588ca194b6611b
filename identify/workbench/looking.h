#pragma once
/// What the page of the workbench asks of a session without changing its models (docs/workbench-protocol.md).
/// Throws InputError.

#include <string>
#include <vector>

#include "volcal/identify/session/session.h"
#include "volcal/identify/workbench/frame.h"

namespace volcal::workbench {

/// Suspects at the current model.
Json rank_json(Session& session);
/// What has no name there, and surfaces that were drawn; "ready": whether the scans were made.
Json unknown_json(Session& session);
/// Framed: residuals with the effect in the model.
std::string preview_frame(Session& session, const std::string& effect);
/// Framed: residuals and driver of a formula, which is one more test.
std::string formula_frame(Session& session, const std::string& text,
                          const std::vector<std::string>& parameters);
/// Words that may stand at a place of a formula.
Json completion_json(const Session& session, const std::string& text, std::size_t at);
/// Lomb-Scargle periodogram of the current residuals against a column, weighed by the noise.
Json periodogram_json(const Session& session, const std::string& variable);
/// Circles of the ball-bar: measured, and predicted by the current and by the first model.
Json polar_json(const Session& session);
/// Pictures of the rotary axes by the last full fit; "rotary" is null where none was identified.
Json rotary_axes_json(const Session& session);
/// What the current model means in the volume.
Json meaning_json(Session& session);

}  // namespace volcal::workbench
