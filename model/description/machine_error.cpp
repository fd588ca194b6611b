#include "volcal/model/description/machine_error.h"

namespace volcal {

std::string MachineError::name() const {
  if (const auto own = motion()) return own->name();
  if (const auto own = location()) return own->name();
  return std::get<std::string>(identity_);
}

MachineError MachineError::parse(const std::string& name) {
  if (const auto motion = ErrorSymbol::parse(name)) return *motion;
  if (const auto location = LocationSymbol::parse(name)) return *location;
  return MachineError(name);
}

std::optional<ErrorSymbol> MachineError::motion() const {
  const auto* own = std::get_if<ErrorSymbol>(&identity_);
  return own != nullptr ? std::optional(*own) : std::nullopt;
}

std::optional<LocationSymbol> MachineError::location() const {
  const auto* own = std::get_if<LocationSymbol>(&identity_);
  return own != nullptr ? std::optional(*own) : std::nullopt;
}

std::optional<AxisName> MachineError::axis() const {
  if (const auto own = motion()) return own->axis;
  if (const auto own = location()) return own->axis;
  return std::nullopt;
}

std::optional<Component> MachineError::component() const {
  if (const auto own = motion()) return own->component;
  if (const auto own = location()) return own->component;
  return std::nullopt;
}

bool MachineError::is_angle() const {
  const auto own = component();
  return own && is_rotation(*own);
}

std::vector<std::string> names_of(const std::vector<MachineError>& errors) {
  std::vector<std::string> names;
  names.reserve(errors.size());
  for (const MachineError& error : errors) names.push_back(error.name());
  return names;
}

}  // namespace volcal
