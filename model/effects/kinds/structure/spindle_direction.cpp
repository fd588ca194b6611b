// The spindle does not point where the machine's frame says: the offsets of all tools are turned together.
// Tools of different length or side offset are displaced against each other by what the turn makes of their
// difference.
#include <algorithm>
#include <array>
#include <string>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kSameOffset = 1e-4;     // m
constexpr std::size_t kFewestTools = 3;  // with two of them it is the offset of either

/// A turn t displaces the offset o by t x o: each of its components in two directions.
constexpr std::array<std::array<int, 2>, 3> kMoved = {{{1, 2}, {0, 2}, {0, 1}}};

Eigen::RowVectorXd moved_by_turns(const Eigen::Vector3d& offset_t) {
  Eigen::RowVectorXd drivers(6);
  for (int about = 0; about < 3; ++about) {
    const Eigen::Vector3d moved = Eigen::Vector3d::Unit(about).cross(offset_t);
    for (int k = 0; k < 2; ++k)
      drivers[2 * about + k] = moved[kMoved[static_cast<std::size_t>(about)][static_cast<std::size_t>(k)]];
  }
  return drivers;
}

std::vector<EffectTerm> terms_of_turns() {
  std::vector<EffectTerm> terms;
  for (std::size_t about = 0; about < 3; ++about) {
    for (const int component : kMoved[about])
      terms.push_back({about, {.kind = TargetKind::ToolOffset, .symbol = {}, .component = component}});
  }
  return terms;
}

std::vector<EffectAmplitude> turns(const EffectTable& table, const std::string& label) {
  const std::vector<EffectTerm> terms = terms_of_turns();
  std::vector<EffectAmplitude> amplitudes;
  for (std::size_t about = 0; about < 3; ++about) {
    const std::string part(1, "abc"[about]);
    amplitudes.push_back({.label = part_label(label, part),
                          .target = terms[2 * about].target,
                          .key = part + "_urad",
                          .guess = table.number(part, 0.0),
                          .of = label,
                          .part = part});
  }
  return amplitudes;
}

std::unique_ptr<FormulaEffect> make_spindle_direction(const EffectTable& table) {
  const std::string label = "direction of the spindle";
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"spindle-direction", TargetName::called("spindle"), EffectDriver::called("tool_offset", {}),
                 "linear"},
      turns(table, label),
      [](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const Eigen::RowVectorXd moved = moved_by_turns(view.campaign.machine.tools[view.setup.tool].offset);
        return moved.replicate(static_cast<Eigen::Index>(view.rows()), 1);
      },
      [](const Campaign& /*campaign*/, const SourcePlace& /*place*/) {});
  effect->act_on(terms_of_turns());
  return effect;
}

std::size_t different_tools(const Campaign& campaign) {
  std::vector<Eigen::Vector3d> known;
  for (const Setup& setup : campaign.setups) {
    const Eigen::Vector3d& offset = campaign.machine.tools[setup.tool].offset;
    const bool is_new = std::ranges::none_of(
        known, [&](const Eigen::Vector3d& other) { return (offset - other).norm() < kSameOffset; });
    if (is_new) known.push_back(offset);
  }
  return known.size();
}

std::vector<EffectSpec> example_of_direction(const Campaign& /*campaign*/) {
  return {effect_spec("spindle-direction", {})};
}

std::vector<EffectSpec> spindle_directions(const Campaign& campaign) {
  return different_tools(campaign) < kFewestTools ? std::vector<EffectSpec>{}
                                                  : example_of_direction(campaign);
}

std::vector<KeySchema> turn_keys() {
  std::vector<KeySchema> keys;
  for (const char* about : {"a", "b", "c"})
    keys.push_back({.key = std::string(about) + "_urad",
                    .help = std::string("turn about ") + "xyz"[about[0] - 'a'] + " of the tool's coordinates",
                    .plausible_min = 1e-6,
                    .plausible_max = 1e5});
  return keys;
}

}  // namespace

const EffectKind& spindle_direction_effect() {
  static const FormulaKind kind(
      {.kind = "spindle-direction",
       .summary = "the spindle, and with it every tool, points elsewhere than the frame of the machine file "
                  "says: offsets o are displaced by t x o",
       .plain = "The spindle does not point where the machine's axes say: long tools are displaced more than "
                "short ones.",
       .usual_causes = "a head that is out of tram; the spindle not parallel to the axis that the datum is "
                       "taken from; tool offsets measured in another frame than that of the axes",
       .source = "ISO 230-1:2012, 10.3 (squareness of a spindle to axes); ISO/TR 16907:2015, 7.3",
       .polynomial = true,
       .keys = turn_keys(),
       .words = {{NamePart::Target, "spindle", "offsets of all tools, turned together"},
                 {NamePart::Driver, "tool_offset", "offset of the tool that is carried"}}},
      make_spindle_direction, spindle_directions, example_of_direction);
  return kind;
}

}  // namespace volcal
