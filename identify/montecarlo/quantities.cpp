#include "volcal/identify/montecarlo/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/result/surface_values.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kExact = 1e-9;  // of the largest uncertainty of the same unit: known by the datum

constexpr double kVaries = 1e-24;  // m^2: above 1 pm

constexpr const char* kVectorNames[] = {"ex", "ey", "ez"};

/// Collects quantities with their rows.
class QuantityList {
 public:
  explicit QuantityList(int parameters) : parameters_(parameters) {}

  void add(Quantity quantity, const Eigen::VectorXd& row) {
    items.push_back(std::move(quantity));
    rows_.push_back(row);
  }
  Eigen::MatrixXd rows() const {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(rows_.size()), parameters_);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      all.row(static_cast<Eigen::Index>(i)) = rows_[i].transpose();
    return all;
  }

  std::vector<Quantity> items;

 private:
  int parameters_;
  std::vector<Eigen::VectorXd> rows_;
};

void add_tables(const FitResult& result, const Conditions& conditions, QuantityList& list) {
  ErrorTableOptions options;
  options.conditions = conditions;
  const std::vector<ErrorTableRow> table = error_table(result, options);
  const Eigen::MatrixXd rows = error_table_derivatives(result, options);
  double largest[2] = {0.0, 0.0};
  for (const ErrorTableRow& row : table) largest[row.rotation] = std::max(largest[row.rotation], row.u);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].u <= kExact * largest[table[i].rotation]) continue;
    list.add({.kind = QuantityKind::TableValue,
              .name = table[i].symbol.name(),
              .axis = table[i].axis,
              .position = table[i].position,
              .direction = table[i].direction,
              .tool = {},
              .at = {},
              .unit = table[i].rotation ? "urad" : "um",
              .si_per_unit = kMicro,
              .estimate = table[i].value},
             rows.row(static_cast<Eigen::Index>(i)));
  }
}

void add_parameters(const FitResult& result, QuantityList& list) {
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location || is_surface(block)) continue;
    for (int k = 0; k < block.size(); ++k) {
      const auto index = static_cast<std::size_t>(k);
      if (!(result.covariance(block.offset + k, block.offset + k) > 0.0)) continue;
      list.add({.kind = QuantityKind::Parameter,
                .name = block.name + (block.labels[index].empty() ? "" : " " + block.labels[index]),
                .axis = {},
                .tool = {},
                .at = {},
                .unit = block.units[index],
                .si_per_unit = block.si_per_unit[index],
                .estimate = result.parameters[block.offset + k]},
               Eigen::VectorXd::Unit(result.layout.size, block.offset + k));
    }
  }
}

/// Their largest values; a coefficient alone means nothing.
void add_surfaces(const FitResult& result, QuantityList& list) {
  for (const SurfaceValues& surface : surface_values(result)) {
    if (!(surface.largest_u > 0.0)) continue;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(result.layout.size);
    row.segment(surface.offset, surface.largest_row.size()) = surface.largest_row;
    list.add({.kind = QuantityKind::Parameter,
              .name = surface.label + " at " + surface.place_words(),
              .axis = {},
              .tool = {},
              .at = {},
              .unit = surface.unit,
              .si_per_unit = surface.si_per_unit,
              .estimate = surface.largest},
             row);
  }
}

Quantity of_volume(QuantityKind kind, const std::string& name, const std::string& tool, double estimate) {
  return {.kind = kind,
          .name = name,
          .axis = {},
          .tool = tool,
          .at = {},
          .unit = "um",
          .si_per_unit = kMicro,
          .estimate = estimate};
}

/// Whether anything varies on the grid.
bool add_grid(const FitResult& result, const Tool& tool, const Conditions& conditions, int per_axis,
              QuantityList& list) {
  const ErrorField field(result, tool, conditions);
  const std::size_t before = list.items.size();
  for (const AxisPosition& position : grid_positions(result.machine, per_axis)) {
    const PoseErrorRows rows = field.unheld_rows(position);
    const PoseErrorVector error = field.at(position);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Eigen::VectorXd derivatives = rows.row(k);
      const double variance = derivatives.dot(result.covariance * derivatives);
      if (!(variance > kVaries)) continue;
      Quantity quantity = of_volume(QuantityKind::VolumetricError, kVectorNames[k], tool.name, error[k]);
      quantity.at = position;
      list.add(std::move(quantity), derivatives);
    }
  }
  return list.items.size() > before;
}

QuantitySet::Volume added_size(const FitResult& result, const Tool& tool, const Conditions& conditions,
                               QuantityList& list) {
  QuantitySet::Volume volume{.tool = tool.name, .size = {result, tool, conditions, kVolumeCells}};
  volume.rms = list.items.size();
  list.add(of_volume(QuantityKind::VolumetricRms, "rms", tool.name, volume.size.rms()),
           volume.size.rms_row());
  volume.largest = list.items.size();
  list.add(of_volume(QuantityKind::VolumetricMax, "max", tool.name, volume.size.largest()),
           volume.size.largest_row());
  return volume;
}

}  // namespace

std::string_view to_string(QuantityKind kind) {
  switch (kind) {
    case QuantityKind::TableValue:
      return "table";
    case QuantityKind::Parameter:
      return "parameter";
    case QuantityKind::VolumetricError:
      return "volumetric";
    case QuantityKind::VolumetricRms:
      return "volumetric-rms";
    case QuantityKind::VolumetricMax:
      return "volumetric-max";
  }
  return "";
}

std::string Quantity::functional_point() const { return tool.empty() ? "spindle reference" : "tool " + tool; }

std::string Quantity::words() const {
  if (axis) {
    return fmt::format("{} at {:.6g} {}{}", name, position / position_unit(*axis).si_per_unit,
                       position_unit(*axis).suffix,
                       direction > 0   ? " +"
                       : direction < 0 ? " -"
                                       : "");
  }
  if (!is_of_volume()) return name;
  const std::string point = functional_point();
  if (!at) return fmt::format("volumetric error, {}, {}", name, point);
  return fmt::format("{} of {} at {:.6g}, {:.6g}, {:.6g} mm", name, point, (*at)[0] / kMetrePerMillimetre,
                     (*at)[1] / kMetrePerMillimetre, (*at)[2] / kMetrePerMillimetre);
}

QuantitySet quantities_of(const FitResult& result, int grid_per_axis,
                          const std::optional<Conditions>& given) {
  const Conditions conditions = given ? *given : default_conditions(result);
  QuantityList list(result.layout.size);
  add_tables(result, conditions, list);
  add_parameters(result, list);
  add_surfaces(result, list);
  QuantitySet set;
  for (const Tool& tool : result.machine.functional_tools()) {
    if (grid_per_axis <= 0) break;
    if (add_grid(result, tool, conditions, grid_per_axis, list))
      set.volumes.push_back(added_size(result, tool, conditions, list));
  }
  set.items = std::move(list.items);
  set.rows = list.rows();
  return set;
}

}  // namespace volcal
