#include "volcal/model/effects/written_target.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

const std::string kTargets =
    "write an error motion (EAY), \"tool x\", \"tool NAME x\", \"station NAME x\", or a column of readings "
    "(\"length_mm\", \"azimuth_deg of SETUP\")";

/// Channel of a column in an instrument's set of columns.
std::optional<int> channel_of(const std::vector<ColumnSchema>& columns, const std::string& column) {
  const auto found = std::ranges::find(columns, column, &ColumnSchema::column);
  if (found == columns.end()) return std::nullopt;
  return static_cast<int>(found - columns.begin());
}

std::optional<int> channel_of(const Setup& setup, const std::string& column) {
  const Instrument* instrument = find_instrument(setup.instrument);
  if (instrument == nullptr) return std::nullopt;
  return channel_of(instrument->schema().column_sets[setup.readings.column_set], column);
}

std::optional<int> channel_of(const std::string& column) {
  for (const Instrument* instrument : instruments()) {
    for (const auto& columns : instrument->schema().column_sets) {
      if (const auto channel = channel_of(columns, column)) return channel;
    }
  }
  return std::nullopt;
}

/// "tool NAME x" after its first word; nothing when it does not end in a direction.
std::optional<WrittenTarget> vector_target(TargetKind kind, const std::string& rest) {
  const std::size_t space = rest.rfind(' ');
  const std::string direction = space == std::string::npos ? rest : rest.substr(space + 1);
  if (direction.size() != 1 || direction[0] < 'x' || direction[0] > 'z') return std::nullopt;
  WrittenTarget target;
  target.kind = kind;
  target.component = direction[0] - 'x';
  if (space != std::string::npos) target.owner = rest.substr(0, space);
  return target;
}

std::optional<WrittenTarget> reading_target(const std::string& text) {
  const std::size_t of = text.find(" of ");
  WrittenTarget target;
  target.kind = TargetKind::Reading;
  target.column = text.substr(0, of);
  if (of != std::string::npos) target.owner = text.substr(of + 4);
  const auto channel = channel_of(target.column);
  if (!channel) return std::nullopt;
  target.component = *channel;
  const std::string_view unit = unit_of_key(target.column).suffix;
  target.angle = unit.ends_with("rad") || unit == "deg";
  return target;
}

}  // namespace

WrittenTarget written_target(const EffectTable& table) {
  const std::string text = table.text("target", kTargets);
  std::optional<WrittenTarget> target;
  if (const auto symbol = ErrorSymbol::parse(text)) {
    target.emplace().symbol = *symbol;
    target->angle = is_rotation(symbol->component);
  } else if (text.starts_with("tool ")) {
    target = vector_target(TargetKind::ToolOffset, text.substr(5));
  } else if (text.starts_with("station ")) {
    target = vector_target(TargetKind::Station, text.substr(8));
    if (target && target->owner.empty()) target.reset();
  } else {
    target = reading_target(text);
  }
  if (!target) table.fail("\"" + text + "\" is not a target", kTargets);
  target->text = text;
  return *target;
}

TargetName WrittenTarget::name() const {
  switch (kind) {
    case TargetKind::Motion:
      return symbol;
    case TargetKind::ToolOffset:
      return TargetName::of_tool(owner, component);
    case TargetKind::Station:
      return TargetName::of_station(owner, component);
    default:
      return TargetName::called(text);
  }
}

bool WrittenTarget::acts_on(const Campaign& campaign, const Setup& setup) const {
  switch (kind) {
    case TargetKind::ToolOffset:
      return owner.empty() || campaign.machine.tools[setup.tool].name == owner;
    case TargetKind::Station:
      return station_of(setup) == owner;
    case TargetKind::Reading:
      return (owner.empty() || setup.name == owner) && channel_of(setup, column) == component;
    default:
      return true;
  }
}

void WrittenTarget::check(const Campaign& campaign, const std::string& what, const SourcePlace& place) const {
  switch (kind) {
    case TargetKind::Motion:
      return check_axis(campaign, symbol.axis, what, place);
    case TargetKind::ToolOffset:
      return owner.empty() ? void() : check_tool(campaign, owner, place);
    case TargetKind::Station:
      return check_station(campaign, owner, place);
    default:
      break;
  }
  if (!owner.empty()) check_setup(campaign, owner, place);
  for (const Setup& setup : campaign.setups) {
    if (acts_on(campaign, setup)) return;
  }
  throw InputError(place, what + ": no reading has the column " + column,
                   "name a column of the campaign's readings or remove the effect");
}

KeySchema written_target_key() {
  return text_key("target",
                  "error motion (EAY), \"tool x\", \"tool NAME x\", \"station NAME x\", or a "
                  "column of readings (\"length_mm\", \"azimuth_deg of SETUP\")");
}

}  // namespace volcal
