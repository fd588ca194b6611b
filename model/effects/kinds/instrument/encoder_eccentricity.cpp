// An angle encoder of a tracker whose circle is mounted off centre: its angle is wrong by one wave per turn.
#include <algorithm>
#include <map>
#include <optional>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

std::optional<int> channel_of_encoder(const InstrumentTraits& traits, const std::string& encoder) {
  const auto found = std::ranges::find(traits.encoders, encoder, &AngleEncoder::name);
  return found == traits.encoders.end() ? std::nullopt : std::optional(found->channel);
}

/// The first of the registered instruments that has the encoder says which channel it reads.
int channel_of_encoder(const EffectTable& table, const std::string& encoder) {
  for (const Instrument* instrument : instruments()) {
    if (const auto channel = channel_of_encoder(instrument->schema().traits, encoder)) return *channel;
  }
  table.fail("\"" + encoder + "\" is not an encoder", "write azimuth or elevation");
}

/// An encoder of an instrument that stands at a station, or of one that is carried from station to station.
struct StationEncoder {
  std::string station;  ///< empty: all
  std::string encoder;
  int channel = 0;

  bool reads(const Setup& setup) const {
    return channel_of_encoder(traits_of(setup), encoder) == channel &&
           (station.empty() || station_of(setup) == station);
  }
};

std::unique_ptr<FormulaEffect> make_encoder_eccentricity(const EffectTable& table) {
  const std::string station = table.spec.options.text("station").value_or("");
  const std::string encoder = table.text("encoder", "add encoder = \"azimuth\"");
  const StationEncoder at{station, encoder, channel_of_encoder(table, encoder)};
  const std::string label = encoder + " encoder" + (station.empty() ? " of all trackers" : " at " + station);
  return std::make_unique<FormulaEffect>(
      EffectName{"encoder-eccentricity", TargetName::of_station(station), EffectDriver::parse(encoder),
                 "periodic"},
      std::vector{reading_amplitude(table, label, "cos_urad", at.channel, "cos"),
                  reading_amplitude(table, label, "sin_urad", at.channel, "sin")},
      [at](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const auto rows = static_cast<Eigen::Index>(view.rows());
        if (!at.reads(view.setup)) return Eigen::MatrixXd::Zero(rows, 2);
        const Eigen::Map<const Eigen::ArrayXd> angle(
            view.setup.readings.value[static_cast<std::size_t>(at.channel)].data(), rows);
        Eigen::MatrixXd drivers(rows, 2);
        drivers << angle.cos(), angle.sin();
        return drivers;
      },
      [at, label](const Campaign& campaign, const SourcePlace& place) {
        if (!at.station.empty()) check_station(campaign, at.station, place);
        if (std::ranges::any_of(campaign.setups, [&](const Setup& setup) { return at.reads(setup); })) return;
        throw InputError(place, label + ": no laser tracker stands there",
                         "name the station of a setup that reads azimuth and elevation or remove the effect");
      });
}

/// At every station, and of all as one tracker that was carried.
std::vector<EffectSpec> encoder_eccentricities(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  std::map<std::string, int> stations_of;
  for (const std::string& station : station_names(campaign)) {
    for (const Setup& setup : campaign.setups) {
      const auto& encoders = traits_of(setup).encoders;
      if (encoders.empty() || station_of(setup) != station) continue;
      for (const AngleEncoder& encoder : encoders) {
        specs.push_back(
            effect_spec("encoder-eccentricity", {{"station", station}, {"encoder", encoder.name}}));
        ++stations_of[encoder.name];
      }
      break;
    }
  }
  for (const auto& [encoder, stations] : stations_of) {
    if (stations > 1) specs.push_back(effect_spec("encoder-eccentricity", {{"encoder", encoder}}));
  }
  return specs;
}

}  // namespace

const EffectKind& encoder_eccentricity_effect() {
  static const FormulaKind kind(
      {.kind = "encoder-eccentricity",
       .summary = "an angle encoder of a laser tracker sits off centre: its angle is wrong by one wave per "
                  "turn",
       .plain = "An angle of the laser tracker is wrong by one wave per turn.",
       .usual_causes = "a scale that sits off centre in the tracker's head; a tracker that was dropped or is "
                       "due for service; a compensation file of another tracker",
       .source =
           "Muralikrishnan et al., J. Res. NIST 114 (2009) 21: geometric misalignments in laser trackers",
       .keys = {text_key("station", "name of the tracker's station; absent = all, one tracker", false),
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
