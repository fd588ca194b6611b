#include "volcal/identify/report/values/shown_variable.h"

#include <cctype>

#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

using Kind = Variable::Kind;

std::string title_of(const Variable& variable) {
  const std::string axis(1, letter_of(variable.axis));
  switch (variable.kind) {
    case Kind::Position:
      return "Position " + axis;
    case Kind::Direction:
      return "Direction of approach, " + axis;
    case Kind::Speed:
      return "Share of the feed along " + axis;
    case Kind::Time:
      return "Time";
    case Kind::Temperature:
      return "Temperature " + variable.subject;
    case Kind::Length:
      return "Measured length";
    case Kind::Elevation:
      return "Elevation of the beam";
    case Kind::Run:
      return "Run";
    case Kind::Feed:
      return "Feed";
    case Kind::Instrument:
      return "Instrument " + variable.subject;
    case Kind::Tool:
      return "Tool " + variable.subject;
    case Kind::Station:
      return "Station " + variable.subject;
    case Kind::TravelSinceTurning:
      return "Travel of " + axis + " since it turned";
    case Kind::ToolLength:
      return "Length of the tool";
    case Kind::ToolOffset:
      return "Offset of the tool, " + std::string(1, static_cast<char>('x' + variable.component));
  }
  return variable.name();
}

}  // namespace

ShownVariable shown_variable(const Variable& variable) {
  if (variable.kind == Kind::Time) return {title_of(variable), "min", 1.0 / kSecondsPerMinute};
  return {title_of(variable), shown_unit_of(variable), 1.0 / variable.unit().si_per_unit};
}

std::string shown_unit_of(const Variable& variable) {
  return variable.kind == Kind::Temperature ? "°C" : unit_text(variable.unit().suffix);
}

ShownVariable shown_variable(const std::string& name) {
  if (const auto variable = Variable::parse(name)) return shown_variable(*variable);
  std::string title = name;
  if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return {title, "", 1.0};
}

}  // namespace volcal::report
