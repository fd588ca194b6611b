#include "volcal/studies/files/simulation_writer.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/studies/files/hidden_answer_writer.h"

namespace volcal {
namespace {

constexpr int kTruthPositions = 41;

std::string location_row(LocationSymbol symbol, double value) {
  return fmt::format("{},,,,{:.6f},{}\n", symbol.name(), kPerMicro * value, edge_unit(symbol.component));
}

std::string truth_csv(const sim::TruthMachine& truth) {
  const sim::TruthInDatum tables(truth);
  std::string text = "symbol,axis,position,position_unit,value,unit\n";
  for (const Axis& axis : truth.machine().axes) {
    const Unit unit = position_unit(axis.name);
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      for (int i = 0; i < kTruthPositions; ++i) {
        const double q = axis.travel_min + axis.travel() * i / (kTruthPositions - 1);
        text += fmt::format("{},{},{},{},{:.6f},{}\n", symbol.name(), letter_of(axis.name),
                            edge_number(q, unit.si_per_unit), unit.suffix,
                            kPerMicro * tables.value(symbol, q), edge_unit(component));
      }
    }
  }
  const auto symbols = tables.datum().squareness();
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    if (!truth.machine().has_axis(symbols[i].axis)) continue;
    text += location_row(symbols[i], tables.squareness()[i]);
  }
  for (const Axis& axis : truth.machine().axes) {
    if (is_parallel(axis.name)) {
      for (const LocationSymbol& symbol : sim::linear_locations(truth.machine(), axis.name))
        text += location_row(symbol, tables.location(symbol));
    }
    if (!is_rotary(axis.name)) continue;
    for (const Component component : kAllComponents) {
      const LocationSymbol symbol{component, axis.name};
      text += location_row(symbol, tables.location(symbol));
    }
  }
  return text;
}

}  // namespace

void write_simulation(const sim::SimulatedCampaign& simulated, const AtomicFolder& folder) {
  folder.write("machine.toml", machine_toml(simulated.campaign.machine));
  folder.write("model.toml", model_toml(ModelSpec{}, "machine.toml"));
  write_campaign(simulated.campaign, folder.path(), "machine.toml");
  const std::string truth = folder.path("truth");
  std::filesystem::create_directories(truth);
  write_campaign(simulated.validation, truth, "../machine.toml");
  write_text_file(truth + "/error_functions.csv", truth_csv(simulated.truth));
  if (simulated.unseen.setups.empty()) return;
  write_text_file(truth + "/hidden.json", hidden_answer_json(simulated));
  for (const auto& [name, campaign] :
       {std::pair("/unseen", &simulated.unseen),
        std::pair("/unseen_without_hidden", &simulated.unseen_without_hidden)}) {
    std::filesystem::create_directories(truth + name);
    write_campaign(*campaign, truth + name, "../../machine.toml");
  }
}

}  // namespace volcal
