// A tool, or the reflector in its place, that is clamped anew for a setup and does not sit as it did before.
#include <algorithm>
#include <map>
#include <string>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

std::unique_ptr<FormulaEffect> make_tool_clamping(const EffectTable& table) {
  const std::string setup = table.text("setup", "add setup = \"NAME\"");
  const std::string label = "clamping in " + setup;
  return std::make_unique<FormulaEffect>(
      EffectName{"tool-clamping", TargetName::called(label), EffectDriver::called("setup", {}), "step"},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um"),
      [setup](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(view.rows()), 3,
                                         view.setup.name == setup ? 1.0 : 0.0);
      },
      [setup](const Campaign& campaign, const SourcePlace& place) { check_setup(campaign, setup, place); });
}

/// Another setup reads from the same station. Elsewhere what the setup has for itself, a station, a centre, a
/// zero, moves with the tool.
bool shares_its_station(const Campaign& campaign, const Setup& setup) {
  const std::string station = station_of(setup);
  return !station.empty() && std::ranges::any_of(campaign.setups, [&](const Setup& other) {
    return &other != &setup && station_of(other) == station;
  });
}

/// Of tools that several setups carry: what is wrong with a tool in its only setup is its offset.
std::vector<EffectSpec> tool_clampings(const Campaign& campaign) {
  std::map<std::size_t, int> setups_of_tool;
  for (const Setup& setup : campaign.setups) ++setups_of_tool[setup.tool];
  std::vector<EffectSpec> specs;
  for (const Setup& setup : campaign.setups) {
    if (setups_of_tool[setup.tool] > 1 && shares_its_station(campaign, setup))
      specs.push_back(effect_spec("tool-clamping", {{"setup", setup.name}}));
  }
  return specs;
}

}  // namespace

const EffectKind& tool_clamping_effect() {
  static const FormulaKind kind(
      {.kind = "tool-clamping",
       .summary = "the tool, or its reflector, was clamped anew for a setup and sits otherwise than in the "
                  "other setups that carry it",
       .plain = "The tool sat otherwise in one set-up than in the others.",
       .usual_causes =
           "chips or dirt in the taper; a worn pull stud or too little clamping force; a reflector that was "
           "put back turned; a tool that was not clamped in the same orientation",
       .source = "ISO/TR 16907:2015, 3.2 and 7.1 (functional point)",
       .polynomial = true,
       .keys = joined({{text_key("setup", "name of the setup")},
                       vector_amplitude_keys("um",
                                             "offset in this setup less that in the others, tool "
                                             "coordinates")})},
      make_tool_clamping, tool_clampings);
  return kind;
}

}  // namespace volcal
