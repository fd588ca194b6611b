#pragma once
/// Effects that no rigid body has, in tables: simulated machines with such an effect are measured, identified
/// with the rigid model and with the effect, and compensated with the files of every format; the exact
/// machine that applies them (sim/machine/control.h) is judged where `volcal tables` prints what is left: at
/// the points of volume_points() inside the volume, for the same tool and conditions.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace volcal::studies {

struct EffectTablesOptions {
  int structures = 4;  ///< of sim::reference_machines()
  std::uint64_t seed = 1;
  double noise = 1.0;                ///< of the readings, times the usual
  std::vector<std::string> cases;    ///< names of effect_table_cases(); empty = all
  std::vector<std::string> formats;  ///< empty = all
  int threads = 0;                   ///< 0 = all; results do not depend on it
  std::function<void(int done, int all)> progress;
};

/// "coupled", "product", "reversal", "expansion", "tool", "pair".
std::vector<std::string> effect_table_cases();

/// sqrt(mean |e|^2) of the functional point after the best rigid motion, m.
struct EffectTablesRow {
  std::string structure;
  std::string effect;  ///< name of the case
  std::string format;
  std::string type;
  bool volumetric = false;  ///< holds errors of any kind, L-VOL
  double before = 0.0;
  double rigid = 0.0;        ///< machine with the tables of the rigid model
  double extended = 0.0;     ///< of the model with the effect
  double ideal = 0.0;        ///< ideal compensation of the true errors as far as the format can hold it
  double uncertainty = 0.0;  ///< of the identified errors, RMS over the volume, which tables cannot take away
  double printed = 0.0;      ///< expected error left, as `volcal tables` prints it of the extended model
};

/// In the order of structures, cases and formats. Repeatable to the bit.
std::vector<EffectTablesRow> effect_tables_study(const EffectTablesOptions& options);

}  // namespace volcal::studies
