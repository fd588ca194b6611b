#include "volcal/model/observation/parameters.h"

#include <algorithm>

#include "volcal/model/description/units.h"

namespace volcal {

std::optional<ParameterLayout::FunctionPlace> ParameterLayout::find(ErrorSymbol symbol) const {
  for (std::size_t group = 0; group < groups.size(); ++group) {
    const auto& members = groups[group].symbols;
    const auto found = std::ranges::find(members, symbol);
    if (found == members.end()) continue;
    return FunctionPlace{static_cast<int>(group), static_cast<int>(found - members.begin())};
  }
  return std::nullopt;
}

const ParameterBlock* ParameterLayout::find_block(const std::string& name) const {
  const auto found = std::ranges::find(blocks, name, &ParameterBlock::name);
  return found == blocks.end() ? nullptr : &*found;
}

std::optional<int> ParameterLayout::find_parameter(const std::string& name) const {
  for (const ParameterBlock& block : blocks) {
    if (!name.starts_with(block.name)) continue;
    const bool is_whole = name.size() == block.name.size();
    if (!is_whole && name[block.name.size()] != ' ') continue;  // of "T10" no block "T1"
    if (is_whole && block.size() == 1) return block.offset;
    const std::string label = is_whole ? "" : name.substr(block.name.size() + 1);
    const auto found = std::ranges::find(block.labels, label);
    if (found != block.labels.end()) return block.offset + static_cast<int>(found - block.labels.begin());
  }
  return std::nullopt;
}

const ParameterBlock* ParameterLayout::find_location(LocationSymbol symbol) const {
  const auto found = std::ranges::find(blocks, std::optional(symbol), &ParameterBlock::location);
  return found == blocks.end() ? nullptr : &*found;
}

Eigen::VectorXd ParameterLayout::coefficients(ErrorSymbol symbol, const Eigen::VectorXd& parameters) const {
  const auto place = find(symbol);
  if (!place) return {};
  const FunctionGroup& group = groups[static_cast<std::size_t>(place->group)];
  Eigen::VectorXd result(group.basis->size());
  for (int j = 0; j < group.basis->size(); ++j) result[j] = parameters[group.index(j, place->slot)];
  return result;
}

std::vector<ErrorSymbol> ParameterLayout::symbols() const {
  std::vector<ErrorSymbol> all;
  for (const FunctionGroup& group : groups) {
    all.insert(all.end(), group.symbols.begin(), group.symbols.end());
  }
  return all;
}

std::vector<NamedParameter> named_parameters(const ParameterLayout& layout) {
  std::vector<NamedParameter> all(static_cast<std::size_t>(layout.size));
  for (const FunctionGroup& group : layout.groups) {
    for (int j = 0; j < group.basis->size(); ++j) {
      for (int slot = 0; slot < group.count(); ++slot) {
        const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
        all[static_cast<std::size_t>(group.index(j, slot))] = {
            symbol.name() + " " + std::to_string(j), is_rotation(symbol.component) ? "urad" : "um", kMicro};
      }
    }
  }
  for (const ParameterBlock& block : layout.blocks) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(block.size()); ++k) {
      const std::string& label = block.labels[k];
      all[static_cast<std::size_t>(block.offset) + k] = {
          label.empty() ? block.name : block.name + " " + label, block.units[k], block.si_per_unit[k]};
    }
  }
  return all;
}

}  // namespace volcal
