// Readings of one run of a setup that are shifted against its other runs: a reset counter, a reflector put
// back, a bar length zeroed anew. A shift of the whole setup needs no effect: its dead path, offset or length
// takes it.
#include <algorithm>
#include <cmath>
#include <set>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

std::set<std::int32_t> runs_of(const Setup& setup) {
  return {setup.readings.run.begin(), setup.readings.run.end()};
}

bool reads_length(const Setup& setup) { return traits_of(setup).length_from_zero; }

std::unique_ptr<FormulaEffect> make_run_offset(const EffectTable& table) {
  const std::string setup = table.text("setup", "add setup = \"NAME\"");
  const auto number = table.spec.options.number("run");
  if (!number) table.fail("it names no run", "add run = 2");
  if (*number != std::round(*number)) table.fail("its run is not a whole number", "add run = 2");
  const auto run = static_cast<std::int32_t>(*number);
  const auto driver = EffectDriver::called("run " + std::to_string(run), {}, {{Variable::Kind::Run}});
  const std::string label = driver.name() + " of " + setup;
  return std::make_unique<FormulaEffect>(
      EffectName{"run-offset", TargetName::of_readings(setup), driver, "step"},
      std::vector{reading_amplitude(table, label, "amplitude_um")},
      [setup, run](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        Eigen::VectorXd shifted = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.rows()));
        const auto& runs = view.setup.readings.run;
        for (std::size_t row = 0; view.setup.name == setup && row < runs.size(); ++row) {
          shifted[static_cast<Eigen::Index>(row)] = runs[row] == run ? 1.0 : 0.0;
        }
        return shifted;
      },
      [setup, run, label](const Campaign& campaign, const SourcePlace& place) {
        check_setup(campaign, setup, place);
        for (const Setup& each : campaign.setups) {
          if (each.name != setup) continue;
          if (!reads_length(each)) {
            throw InputError(place, label + ": the setup does not read lengths",
                             "name a setup that reads lengths or remove the effect");
          }
          if (runs_of(each).contains(run)) continue;
          throw InputError(place, label + ": the setup has no such run",
                           "name a number of its column run or remove the effect");
        }
      });
}

/// Every run but the first of its setup.
std::vector<EffectSpec> run_offsets(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const Setup& setup : campaign.setups) {
    const std::set<std::int32_t> runs = runs_of(setup);
    if (runs.size() < 2 || !reads_length(setup)) continue;
    for (const std::int32_t run : runs) {
      if (run == *runs.begin()) continue;
      specs.push_back(effect_spec("run-offset", {{"setup", setup.name}, {"run", static_cast<double>(run)}}));
    }
  }
  return specs;
}

}  // namespace

const EffectKind& run_offset_effect() {
  static const FormulaKind kind(
      {.kind = "run-offset",
       .summary =
           "the readings of one run are shifted against the other runs of their setup: a counter reset, "
           "a reflector put back",
       .plain = "One run differs from all others by a constant.",
       .usual_causes = "a zero that was set anew or lost; a reflector or probe that was touched between "
                       "runs; a warm-up between runs; a run read with another offset in the control",
       .source = "ISO 230-2 and ISO 230-4 (repeated runs; zero of the reading)",
       .keys = {text_key("setup", "name of the setup"),
                {.key = "run", .required = true, .help = "number in its column run", .plausible_max = 1e9},
                {.key = "amplitude_um",
                 .help = "shift of the readings (of a tracker: the lengths)",
                 .plausible_min = 1e-6,
                 .plausible_max = 1e5}}},
      make_run_offset, run_offsets);
  return kind;
}

}  // namespace volcal
