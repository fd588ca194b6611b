#include <array>

#include "volcal/identify/cli/command.h"

namespace volcal::cli {

// One line per command, in the order of the help.
#define VOLCAL_COMMANDS(COMMAND) \
  COMMAND(init_command)          \
  COMMAND(import_command)        \
  COMMAND(simulate_command)      \
  COMMAND(fit_command)           \
  COMMAND(compare_command)       \
  COMMAND(validate_command)      \
  COMMAND(montecarlo_command)    \
  COMMAND(plan_command)          \
  COMMAND(diagnose_command)      \
  COMMAND(workbench_command)     \
  COMMAND(session_command)       \
  COMMAND(try_command)           \
  COMMAND(extend_command)        \
  COMMAND(align_command)         \
  COMMAND(budget_command)        \
  COMMAND(tables_command)        \
  COMMAND(compensate_command)    \
  COMMAND(export_command)        \
  COMMAND(study_command)         \
  COMMAND(help_command)

#define VOLCAL_DECLARE_COMMAND(name) const Command& name();
#define VOLCAL_ADDRESS_OF_COMMAND(name) &(name)(),
VOLCAL_COMMANDS(VOLCAL_DECLARE_COMMAND)

std::span<const Command* const> commands() {
  static const auto kCommands = std::to_array<const Command*>({VOLCAL_COMMANDS(VOLCAL_ADDRESS_OF_COMMAND)});
  return kCommands;
}

}  // namespace volcal::cli
