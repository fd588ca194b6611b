// Cosine error: an interferometer's beam that is not parallel to the path reads too short, to second order in
// the angle and in proportion to the displacement.
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

/// An interferometer whose beam keeps its direction.
bool is_interferometer(const Setup& setup) {
  return traits_of(setup).laser_length == LaserLength::Displacement;
}

std::unique_ptr<FormulaEffect> make_beam_misalignment(const EffectTable& table) {
  const std::string setup = table.text("setup", "add setup = \"NAME\"");
  return std::make_unique<FormulaEffect>(
      EffectName{"beam-misalignment", TargetName::of_readings(setup), Variable{Variable::Kind::Length},
                 "linear"},
      std::vector{reading_amplitude(table, "beam of " + setup, "amplitude_ppm")},
      [setup](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        if (view.setup.name != setup) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.rows()));
        return -beam_displacements(view);
      },
      [setup](const Campaign& campaign, const SourcePlace& place) {
        check_setup(campaign, setup, place);
        for (const Setup& each : campaign.setups) {
          if (each.name != setup || is_interferometer(each)) continue;
          throw InputError(place, "beam of " + setup + ": the setup is a " + each.instrument,
                           "name a setup of an interferometer along a line or remove the effect");
        }
      });
}

/// One setup alone: its cosine error is the length scale of all lasers.
std::vector<EffectSpec> beam_misalignments(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (campaign.setups.size() < 2) return specs;
  for (const Setup& setup : campaign.setups) {
    if (is_interferometer(setup)) specs.push_back(effect_spec("beam-misalignment", {{"setup", setup.name}}));
  }
  return specs;
}

}  // namespace

const EffectKind& beam_misalignment_effect() {
  static const FormulaKind kind(
      {.kind = "beam-misalignment",
       .summary = "cosine error: the beam of an interferometer is not parallel to the path and reads too "
                  "short by half the square of the angle, 0.5 ppm at 1 mrad; below zero it is something else",
       .plain = "The interferometer reads too little, by the more the longer the travel: its beam is not "
                "parallel to the motion (cosine error).",
       .usual_causes = "a beam that was not aligned over the whole travel; a reflector or splitter that was "
                       "knocked; a beam that was set by eye",
       .source = "ISO 230-1 and ISO 230-6 (alignment of laser interferometers)",
       .keys = {text_key("setup", "name of the displacement setup"),
                {.key = "amplitude_ppm",
                 .help = "displacements too short by this",
                 .plausible_min = 1e-6,
                 .plausible_max = 1e4}}},
      make_beam_misalignment, beam_misalignments);
  return kind;
}

}  // namespace volcal
