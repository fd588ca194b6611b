#include "volcal/identify/cli/commands/studies/rule_names.h"

#include <fmt/format.h>

#include "volcal/identify/criticism/data/search_rules.h"

namespace volcal::cli {

std::vector<std::string> names_of_rules() {
  std::vector<std::string> names;
  for (const SearchRule rule : search_rules()) names.emplace_back(name_of(rule));
  return names;
}

std::string described_rules() {
  std::vector<std::string> described;
  for (const SearchRule rule : search_rules())
    described.push_back(fmt::format("{} ({})", name_of(rule), description_of(rule)));
  return fmt::format("rules of the search: {}", fmt::join(described, ", "));
}

}  // namespace volcal::cli
