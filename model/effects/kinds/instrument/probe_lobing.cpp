// A touch probe that triggers sooner in some directions than in others: lobes over the direction of contact.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/reading_frame.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr int kFewestLobes = 2, kMostLobes = 12;
constexpr int kUsualLobes[] = {2, 3};  // an oval ball or stylus; a probe that rests on three supports

/// Where the outward normals of single contacts stand among the given columns.
std::optional<std::array<std::size_t, 3>> normal_columns(const Setup& setup) {
  const Instrument* instrument = find_instrument(setup.instrument);
  if (instrument == nullptr) return std::nullopt;
  const auto& given = instrument->schema().given_of(setup.readings.column_set);
  std::array<std::size_t, 3> columns{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto found = std::ranges::find(given, std::string("n_") + "xyz"[k], &ColumnSchema::column);
    if (found == given.end() || setup.readings.given.size() != given.size()) return std::nullopt;
    columns[k] = static_cast<std::size_t>(found - given.begin());
  }
  return columns;
}

bool has_contacts(const Campaign& campaign) {
  return std::ranges::any_of(campaign.setups,
                             [](const Setup& setup) { return normal_columns(setup).has_value(); });
}

/// Cosine and sine of `lobes` times the direction of the normal about the tool's axis, less the more the
/// contact lies on that axis.
Eigen::MatrixXd lobes_of(const SetupView& view, int lobes) {
  Eigen::MatrixXd drivers = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(view.rows()), 2);
  const auto columns = normal_columns(view.setup);
  if (!columns) return drivers;
  const std::vector<Eigen::Matrix3d> to_tool =
      rotations_to_tool({view.setup, view.campaign.machine, view.campaign.file, view.nominal_point_w});
  for (std::size_t row = 0; row < view.rows(); ++row) {
    const auto& given = view.setup.readings.given;
    const Eigen::Vector3d normal(given[(*columns)[0]][row], given[(*columns)[1]][row],
                                 given[(*columns)[2]][row]);
    const Eigen::Vector3d normal_t = to_tool[row] * normal;
    const double across = normal_t.head<2>().norm();
    const double turned = lobes * std::atan2(normal_t.y(), normal_t.x());
    drivers.row(static_cast<Eigen::Index>(row)) << across * std::cos(turned), across * std::sin(turned);
  }
  return drivers;
}

int lobes_in(const EffectTable& table) {
  const double number = table.number("lobes", kUsualLobes[1]);
  const int lobes = static_cast<int>(std::lround(number));
  if (number != lobes || lobes < kFewestLobes || lobes > kMostLobes)
    table.fail("\"lobes\" is not a whole number from 2 to 12",
               "write lobes = 3 for a probe on three supports");
  return lobes;
}

std::unique_ptr<FormulaEffect> make_probe_lobing(const EffectTable& table) {
  const int lobes = lobes_in(table);
  const std::string label = "probe lobing, " + std::to_string(lobes) + " lobes";
  return std::make_unique<FormulaEffect>(
      EffectName{"probe-lobing", TargetName::of_readings(), EffectDriver::called("normal", {}),
                 std::to_string(lobes) + " lobes"},
      std::vector{reading_amplitude(table, label, "cos_um", 0, "cos"),
                  reading_amplitude(table, label, "sin_um", 0, "sin")},
      [lobes](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return lobes_of(view, lobes);
      },
      [label](const Campaign& campaign, const SourcePlace& place) {
        if (has_contacts(campaign)) return;
        throw InputError(place, label + ": no setup has single contacts with their normals",
                         "record tip_x_mm ... n_z of a probed-sphere setup, or remove the effect");
      });
}

std::vector<EffectSpec> probe_lobings(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_contacts(campaign)) return specs;
  for (const int lobes : kUsualLobes)
    specs.push_back(effect_spec("probe-lobing", {{"lobes", static_cast<double>(lobes)}}));
  return specs;
}

}  // namespace

const EffectKind& probe_lobing_effect() {
  static const FormulaKind kind(
      {.kind = "probe-lobing",
       .summary = "a touch probe triggers after a way that depends on the direction of the contact about the "
                  "tool's axis: two, three or more lobes",
       .plain = "The touch probe triggers sooner in some directions of contact than in others.",
       .usual_causes = "a probe that rests on three supports; a long or heavy stylus; a trigger force that "
                       "is set too high; a stylus ball that is out of round or off centre",
       .source = "ISO 230-10; Estler et al., Precision Engineering 19 (1996) 85 (touch trigger probes)",
       .keys = {{.key = "lobes",
                 .help = "lobes over a turn of the direction; default 3",
                 .plausible_max = 12.0},
                amplitude_key("cos_um", "amplitude of the cosine, outward at the contact"),
                amplitude_key("sin_um", "amplitude of the sine, outward at the contact")}},
      make_probe_lobing, probe_lobings);
  return kind;
}

}  // namespace volcal
