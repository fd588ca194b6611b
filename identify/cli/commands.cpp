#include "volcal/identify/cli/commands.h"

#include <array>

namespace volcal::cli {

std::span<const Command* const> commands() {
  static const auto kCommands = std::to_array<const Command*>({
      &init_command(),
      &simulate_command(),
      &fit_command(),
      &compare_command(),
      &validate_command(),
      &tables_command(),
  });
  return kCommands;
}

}  // namespace volcal::cli
