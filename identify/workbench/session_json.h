#pragma once
/// A session as JSON (docs/workbench-protocol.md): what the page of the workbench and `volcal session --json`
/// print. Numbers are in edge units, to the bit.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/session/session.h"

namespace volcal::workbench {

using Json = nlohmann::ordered_json;

/// Null where it is not finite.
Json number(double value);
Json effect_json(const EffectFinding& effect);
Json figures_json(const LadderStep& figures);
/// "models": all of the tree, with "current".
Json models_json(const Session& session);
Json unknown_json(const UnknownFinding& finding, std::size_t number);
Json surface_json(const SurfaceFinding& surface);
/// "campaign": machine, setups, recorded columns.
Json campaign_json(const Session& session);
/// Readings that are left out of the current model, by reason.
Json left_out_json(const Campaign& campaign);

}  // namespace volcal::workbench
