#include "volcal/identify/cli/commands/studies/studies.h"

#include <array>

namespace volcal::cli {

// One line per study, in the order of the help.
#define VOLCAL_STUDIES(STUDY)       \
  STUDY(agreement_study)            \
  STUDY(closed_loop_study)          \
  STUDY(compensation_study_command) \
  STUDY(criticism_study)            \
  STUDY(effect_tables_command)      \
  STUDY(five_axis_study_command)    \
  STUDY(hidden_study)               \
  STUDY(mill_study_command)         \
  STUDY(planning_study_command)     \
  STUDY(previews_study)             \
  STUDY(rules_study)

#define VOLCAL_DECLARE_STUDY(name) const Command& name();
#define VOLCAL_ADDRESS_OF_STUDY(name) &(name)(),
VOLCAL_STUDIES(VOLCAL_DECLARE_STUDY)

std::span<const Command* const> study_commands() {
  static const auto kStudies = std::to_array<const Command*>({VOLCAL_STUDIES(VOLCAL_ADDRESS_OF_STUDY)});
  return kStudies;
}

}  // namespace volcal::cli
