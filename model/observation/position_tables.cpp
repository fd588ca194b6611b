#include "volcal/model/observation/position_tables.h"

#include <algorithm>
#include <unordered_map>

#include "volcal/model/description/measured_ends.h"

namespace volcal {
namespace {

/// Numbers the distinct positions of one axis; neighbouring readings often share one, or walk through them in
/// their order again and again.
class PositionNumbers {
 public:
  std::uint32_t number_of(double position) {
    if (!positions_.empty()) {
      if (position == positions_[last_]) return last_;
      const std::size_t next = last_ + 1 < positions_.size() ? last_ + 1 : 0;
      if (position == positions_[next]) return last_ = static_cast<std::uint32_t>(next);
    }
    const auto [place, is_new] =
        numbers_.try_emplace(position, static_cast<std::uint32_t>(positions_.size()));
    if (is_new) positions_.push_back(position);
    return last_ = place->second;
  }
  const std::vector<double>& positions() const { return positions_; }

 private:
  std::unordered_map<double, std::uint32_t> numbers_;
  std::vector<double> positions_;
  std::uint32_t last_ = 0;
};

/// sum[slot] = sum over j of basis[j] * coefficients[j][slot]
template <int kSupport, int kCount>
void weighted_sum(const double* basis, const double* coefficients, double* sum) {
  for (int s = 0; s < kCount; ++s) {
    double value = 0.0;
    for (int j = 0; j < kSupport; ++j) value += basis[j] * coefficients[j * kCount + s];
    sum[s] = value;
  }
}

}  // namespace

void function_values(const FunctionGroup& group, int start, const double* basis,
                     const Eigen::VectorXd& parameters, double* values) {
  const double* coefficients = parameters.data() + group.index(start, 0);
  const int support = group.basis->support();
  const int count = group.count();
  if (support == 4 && count == 6) return weighted_sum<4, 6>(basis, coefficients, values);
  for (int s = 0; s < count; ++s) values[s] = 0.0;
  for (int j = 0; j < support; ++j) {
    for (int s = 0; s < count; ++s) values[s] += basis[j] * *coefficients++;
  }
}

PositionTables::PositionTables(const Campaign& campaign, const ParameterLayout& layout,
                               const ModelSpec& model)
    : tables_(layout.groups.size()), entry_(campaign.setups.size()) {
  for (const AxisName axis : kAllAxes) {
    const auto on_axis = [axis](const FunctionGroup& group) { return group.axis == axis; };
    if (std::ranges::none_of(layout.groups, on_axis)) continue;
    const MeasuredEnds ends = measured_ends(campaign.machine.axis(axis), model);
    PositionNumbers numbers;
    for (std::size_t setup = 0; setup < campaign.setups.size(); ++setup) {
      const std::vector<double>& positions = campaign.setups[setup].readings.position[index_of(axis)];
      std::vector<std::uint32_t>& entries = entry_[setup][index_of(axis)];
      entries.reserve(positions.size());
      for (const double position : positions) entries.push_back(numbers.number_of(position));
    }
    for (std::size_t g = 0; g < tables_.size(); ++g) {
      const FunctionGroup& group = layout.groups[g];
      if (group.axis != axis) continue;
      const auto support = static_cast<std::size_t>(group.basis->support());
      tables_[g].values.resize(support * numbers.positions().size());
      for (std::size_t i = 0; i < numbers.positions().size(); ++i) {
        tables_[g].start.push_back(group.basis->evaluate(ends.nearest(numbers.positions()[i]),
                                                         tables_[g].values.data() + support * i));
      }
    }
  }
}

TabulatedFunctions PositionTables::tabulate(const ParameterLayout& layout,
                                            const Eigen::VectorXd& parameters) const {
  TabulatedFunctions functions(tables_.size());
  for (std::size_t g = 0; g < tables_.size(); ++g) {
    const FunctionGroup& group = layout.groups[g];
    const auto count = static_cast<std::size_t>(group.count());
    const double* basis = tables_[g].values.data();
    functions[g].resize(count * tables_[g].start.size());
    for (std::size_t i = 0; i < tables_[g].start.size(); ++i, basis += group.basis->support()) {
      function_values(group, tables_[g].start[i], basis, parameters, functions[g].data() + count * i);
    }
  }
  return functions;
}

}  // namespace volcal
