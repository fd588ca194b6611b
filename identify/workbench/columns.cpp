#include "volcal/identify/workbench/columns.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "volcal/identify/criticism/scans/scan_variables.h"
#include "volcal/identify/report/values/shown_variable.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::workbench {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::string kind_of(const Variable& variable) {
  using Kind = Variable::Kind;
  switch (variable.kind) {
    case Kind::Position:
      return "position";
    case Kind::Direction:
      return "direction";
    case Kind::Speed:
      return "speed";
    case Kind::Time:
      return "time";
    case Kind::Temperature:
      return "temperature";
    case Kind::Length:
      return "length";
    case Kind::Elevation:
      return "elevation";
    case Kind::Run:
      return "run";
    case Kind::Feed:
      return "feed";
    case Kind::Instrument:
    case Kind::Tool:
    case Kind::Station:
      return "membership";
    case Kind::TravelSinceTurning:
      return "travel";
    case Kind::ToolLength:
    case Kind::ToolOffset:
      break;
  }
  return "tool";
}

template <class Value>
Eigen::VectorXd of_observations(const Session& session, Value value) {
  const auto& places = session.linear().observations();
  Eigen::VectorXd out(static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) out[static_cast<Eigen::Index>(i)] = value(places[i]);
  return out;
}

/// M of "residual@M".
std::optional<std::size_t> model_behind(const std::string& name, const std::string& what) {
  if (!name.starts_with(what + "@")) return std::nullopt;
  std::size_t number = 0;
  const char* begin = name.data() + what.size() + 1;
  const auto [end, error] = std::from_chars(begin, name.data() + name.size(), number);
  const bool whole = error == std::errc() && end == name.data() + name.size();
  return whole ? std::optional(number) : std::nullopt;
}

void require_known(const Session& session, std::size_t model) {
  if (model >= session.models().size())
    throw InputError({}, "there is no model " + std::to_string(model), "look at the list of models again");
}

std::optional<Eigen::VectorXd> of_model(const Session& session, const std::string& name) {
  if (const auto model = model_behind(name, "residual")) {
    require_known(session, *model);
    return session.residual(*model) * kPerMicro;
  }
  if (const auto model = model_behind(name, "sigma")) {
    require_known(session, *model);
    return session.sigma(*model) * kPerMicro;
  }
  return std::nullopt;
}

std::optional<Eigen::VectorXd> of_place(const Session& session, const std::string& name) {
  using Place = LinearModel::Observation;
  const std::vector<Setup>& setups = session.campaign().setups;
  if (name == "setup")
    return of_observations(session, [](const Place& at) { return static_cast<double>(at.setup); });
  if (name == "row")
    return of_observations(session, [](const Place& at) { return static_cast<double>(at.row); });
  if (name == "channel")
    return of_observations(session, [](const Place& at) { return static_cast<double>(at.channel); });
  if (name == "line")
    return of_observations(session, [&](const Place& at) {
      const auto& line = setups[at.setup].readings.line;
      return line.empty() ? kMissing : static_cast<double>(line[at.row]);
    });
  return std::nullopt;
}

std::optional<Eigen::VectorXd> of_point(const Session& session, const std::string& name) {
  const bool is_point = name.starts_with("point_"), is_along = name.starts_with("along_");
  const std::size_t axis = std::string("xyz").find(name.empty() ? ' ' : name.back());
  if ((!is_point && !is_along) || name.size() != 7 || axis == std::string::npos) return std::nullopt;
  if (is_along) return session.linear().direction(kScanDirections[axis]);
  return of_observations(session, [&](const LinearModel::Observation& at) {
    const Eigen::Vector3d& point = session.linear().views()[at.setup].nominal_point_w[at.row];
    return point[static_cast<Eigen::Index>(axis)] * kPerMilli;
  });
}

std::optional<Eigen::VectorXd> of_session(const Session& session, const std::string& name) {
  const auto count = static_cast<Eigen::Index>(session.linear().size());
  if (name == "stated_sigma") {
    const std::vector<double>& sigma = session.linear().stated_sigma();
    return Eigen::Map<const Eigen::VectorXd>(sigma.data(), count) * kPerMicro;
  }
  Eigen::VectorXd out(count);
  if (name == "heldout") {
    for (Eigen::Index i = 0; i < count; ++i)
      out[i] = session.heldout()[static_cast<std::size_t>(i)] ? 1.0 : 0.0;
    return out;
  }
  if (name == "left_out") {
    const std::vector<double>& sigma = session.linear().problem().data.sigma;
    for (Eigen::Index i = 0; i < count; ++i)
      out[i] = std::isfinite(sigma[static_cast<std::size_t>(i)]) ? 0.0 : 1.0;
    return out;
  }
  return std::nullopt;
}

std::optional<Eigen::VectorXd> of_variable(const Session& session, const std::string& name) {
  for (const ScanVariable& variable : scan_variables(session.linear())) {
    if (variable.name() != name) continue;
    const double factor = report::shown_variable(variable.variable).factor;
    return Eigen::VectorXd((variable.value.array() * variable.scale + variable.centre) * factor);
  }
  return std::nullopt;
}

}  // namespace

std::vector<ColumnInfo> recorded_columns(const Session& session) {
  std::vector<ColumnInfo> columns;
  for (const ScanVariable& variable : scan_variables(session.linear())) {
    const report::ShownVariable shown = report::shown_variable(variable.variable);
    columns.push_back({variable.name(), shown.title, shown.unit, kind_of(variable.variable)});
  }
  return columns;
}

Eigen::VectorXd column(const Session& session, const std::string& name) {
  for (const auto& find : {of_model, of_session, of_place, of_point, of_variable}) {
    if (auto found = find(session, name)) return *std::move(found);
  }
  throw InputError({}, "there is no column \"" + name + "\"", "the state lists the columns of this campaign");
}

}  // namespace volcal::workbench
