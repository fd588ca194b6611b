#include "volcal/identify/tables/product_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr double kSameProduct = 2e-9;   // m
constexpr double kNoProduct = 0.05e-9;  // m, at the end of the lever

/// L-ANG of two axes, the others on their lines.
class AngularPair {
 public:
  AngularPair(const Compensation& angular, const Machine& machine, const AxisPosition& lines,
              AxisName turning, AxisName lever)
      : angular_(angular),
        lines_(lines),
        turning_(turning),
        lever_(lever),
        ends_{machine.axis(lever).travel_min, machine.axis(lever).travel_max},
        on_lines_(angular.correction(lines, {})) {}

  /// Per unit of the lever.
  Eigen::Vector3d angle(double q, int direction) const {
    const double end = far_end();
    return at(q, end, direction) / (end - lines_[index_of(lever_)]);
  }

  bool is_product(const std::vector<double>& positions) const {
    return std::ranges::all_of(positions, [this](double q) {
      return std::ranges::all_of(std::array{-1, 1}, [&](int direction) {
        return std::ranges::all_of(ends_, [&](double end) {
          const double distance = end - lines_[index_of(lever_)];
          return (at(q, end, direction) - distance * angle(q, direction)).cwiseAbs().maxCoeff() <
                 kSameProduct;
        });
      });
    });
  }

  double reach() const { return std::abs(far_end() - lines_[index_of(lever_)]); }

 private:
  double far_end() const {
    const double line = lines_[index_of(lever_)];
    return std::abs(ends_[0] - line) > std::abs(ends_[1] - line) ? ends_[0] : ends_[1];
  }

  Eigen::Vector3d at(double q, double lever, int direction) const {
    AxisPosition position = lines_;
    position[index_of(turning_)] = q;
    position[index_of(lever_)] = lever;
    ApproachDirection approach{};
    approach[index_of(turning_)] = static_cast<std::int8_t>(direction);
    return angular_.correction(position, approach) - on_lines_;
  }

  const Compensation& angular_;
  const AxisPosition& lines_;
  AxisName turning_, lever_;
  std::array<double, 2> ends_;
  Eigen::Vector3d on_lines_;
};

class ProductSampler {
 public:
  ProductSampler(const TableFormat& format, const FitResult& result, const TableFormatOptions& options)
      : machine_(result.machine),
        both_(format.limits.both_directions),
        lines_(lines_of(result.machine, options)),
        angular_(ideal_compensation(result, with_type(options, CompensationPart::Angular))) {
    tables_.lines = lines_;
    if (options.type.is_volumetric()) {
      add_lines(format, result, options);
    } else {
      add_tables(format, result, options);
      add_constant(angular_.correction(lines_, {}));
    }
    const std::vector<AxisName> axes = linear_axes_of(machine_);
    for (std::size_t i = 0; i < axes.size(); ++i) {
      for (std::size_t k = i + 1; k < axes.size(); ++k) add_pair(axes[i], axes[k]);
    }
  }

  ProductTables take() { return std::move(tables_); }

 private:
  static TableFormatOptions with_type(TableFormatOptions options, CompensationType type) {
    options.type = type;
    return options;
  }

  /// Positions of all tables come from a type that has all of them.
  void add_tables(const TableFormat& format, const FitResult& result, const TableFormatOptions& options) {
    tables_.tables = sample_axis_tables(format, result, with_type(options, CompensationType::volumetric()));
    const auto wanted = sample_axis_tables(format, result, options);
    for (SampledTable& table : tables_.tables) {
      const auto same = std::ranges::find_if(wanted, [&](const SampledTable& other) {
        return other.output == table.output && other.table.input == table.table.input;
      });
      if (same != wanted.end()) {
        table = *same;
      } else {
        std::ranges::fill(table.table.forward, 0.0);
        std::ranges::fill(table.table.backward, 0.0);
      }
    }
  }

  /// What the whole compensation does along the specific lines: L-VOL turns the frame as well, which no other
  /// type does.
  void add_lines(const TableFormat& format, const FitResult& result, const TableFormatOptions& options) {
    tables_.tables = sample_axis_tables(format, result, options);
    const Compensation ideal = ideal_compensation(result, options);
    const Eigen::Vector3d on_lines = ideal.correction(lines_, {});
    for (SampledTable& sampled : tables_.tables) {
      AxisTable& table = sampled.table;
      for (std::size_t i = 0; i < table.position.size(); ++i) {
        const auto value = [&, axis = index_of(table.input),
                            k = direction_of(sampled.output)](int direction) {
          AxisPosition position = lines_;
          position[axis] = table.position[i];
          ApproachDirection approach{};
          approach[axis] = static_cast<std::int8_t>(both_ ? direction : 0);
          return ideal.correction(position, approach)[k] - on_lines[k];
        };
        table.forward[i] = value(1);
        table.backward[i] = value(-1);
      }
    }
    add_constant(on_lines);
  }

  const std::vector<double>& positions(AxisName axis) const {
    return std::ranges::find_if(tables_.tables,
                                [axis](const SampledTable& table) { return table.table.input == axis; })
        ->table.position;
  }

  void add_pair(AxisName one, AxisName other) {
    for (const auto& [turning, lever] : {std::pair{one, other}, std::pair{other, one}}) {
      const AngularPair pair(angular_, machine_, lines_, turning, lever);
      if (!pair.is_product(positions(turning))) continue;
      add_products(pair, turning, lever);
      return;
    }
    throw InputError({},
                     std::string("what axes ") + letter_of(one) + " and " + letter_of(other) +
                         " do together is no product of a table and a distance",
                     "write a format with a grid, or do not superimpose");
  }

  void add_products(const AngularPair& pair, AxisName turning, AxisName lever) {
    for (const AxisName output : linear_axes_of(machine_)) {
      AxisTable angle{.input = turning, .position = positions(turning), .forward = {}, .backward = {}};
      double largest = 0.0;
      for (const double q : angle.position) {
        angle.forward.push_back(pair.angle(q, both_ ? 1 : 0)[direction_of(output)]);
        angle.backward.push_back(pair.angle(q, both_ ? -1 : 0)[direction_of(output)]);
        largest = std::max({largest, std::abs(angle.forward.back()), std::abs(angle.backward.back())});
      }
      if (largest * pair.reach() > kNoProduct) tables_.products.push_back({output, lever, std::move(angle)});
    }
  }

  /// A compensation is zero at home, products are on the lines.
  void add_constant(const Eigen::Vector3d& constant) {
    for (SampledTable& table : tables_.tables) {
      if (table.output != table.table.input) continue;
      for (double& value : table.table.forward) value += constant[direction_of(table.output)];
      for (double& value : table.table.backward) value += constant[direction_of(table.output)];
    }
  }

  const Machine& machine_;
  bool both_;
  AxisPosition lines_;
  Compensation angular_;
  ProductTables tables_;
};

}  // namespace

ProductTables sample_product_tables(const TableFormat& format, const FitResult& result,
                                    const TableFormatOptions& options) {
  return ProductSampler(format, result, options).take();
}

}  // namespace volcal
