// An angle encoder of a tracker whose circle is mounted off centre: its angle is wrong by one wave per turn.
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

bool is_tracker_at(const Setup& setup, const std::string& station) {
  return setup.instrument == "laser-tracker" && station_of(setup) == station;
}

std::unique_ptr<FormulaEffect> make_encoder_eccentricity(const EffectTable& table) {
  const std::string station = table.text("station", "add station = \"NAME\"");
  const std::string encoder = table.text("encoder", "add encoder = \"azimuth\"");
  if (encoder != "azimuth" && encoder != "elevation")
    table.fail("\"" + encoder + "\" is no encoder", "write azimuth or elevation");
  const std::size_t channel = encoder == "azimuth" ? 1 : 2;
  const std::string label = encoder + " encoder at " + station;
  return std::make_unique<FormulaEffect>(
      EffectName{"encoder-eccentricity", "station " + station, encoder, "periodic"},
      std::vector{reading_amplitude(table, label + " cos", "cos_urad", static_cast<int>(channel)),
                  reading_amplitude(table, label + " sin", "sin_urad", static_cast<int>(channel))},
      [station, channel](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const auto rows = static_cast<Eigen::Index>(view.rows());
        if (!is_tracker_at(view.setup, station)) return Eigen::MatrixXd::Zero(rows, 2);
        const Eigen::Map<const Eigen::ArrayXd> angle(view.setup.readings.value[channel].data(), rows);
        Eigen::MatrixXd drivers(rows, 2);
        drivers << angle.cos(), angle.sin();
        return drivers;
      },
      [station, label](const Campaign& campaign, const SourcePlace& place) {
        check_station(campaign, station, place);
        for (const Setup& setup : campaign.setups) {
          if (is_tracker_at(setup, station)) return;
        }
        throw InputError(place, label + ": no laser tracker stands there",
                         "name the station of a setup with instrument = \"laser-tracker\" or remove the "
                         "effect");
      });
}

std::vector<EffectSpec> encoder_eccentricities(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const std::string& station : station_names(campaign)) {
    for (const Setup& setup : campaign.setups) {
      if (!is_tracker_at(setup, station)) continue;
      for (const char* encoder : {"azimuth", "elevation"}) {
        specs.push_back(
            effect_spec("encoder-eccentricity", {{"station", station}, {"encoder", std::string(encoder)}}));
      }
      break;
    }
  }
  return specs;
}

}  // namespace

const EffectKind& encoder_eccentricity_effect() {
  static const FormulaKind kind(
      {.kind = "encoder-eccentricity",
       .summary = "an angle encoder of a laser tracker sits off centre: its angle is wrong by one wave per "
                  "turn",
       .source =
           "Muralikrishnan et al., J. Res. NIST 114 (2009) 21: geometric misalignments in laser trackers",
       .keys = {text_key("station", "name of the tracker's station"),
                {.key = "encoder",
                 .type = KeyType::Text,
                 .required = true,
                 .help = "which of the two",
                 .choices = {"azimuth", "elevation"}},
                amplitude_key("cos_urad", "amplitude of the cosine of the angle read"),
                amplitude_key("sin_urad", "amplitude of the sine of the angle read")}},
      make_encoder_eccentricity, encoder_eccentricities);
  return kind;
}

}  // namespace volcal
