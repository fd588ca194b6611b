#include "volcal/identify/compensation/product_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "volcal/identify/errors/correction_positions.h"
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
        angular_(sampled_compensation(format, result, angular_part(options))) {
    tables_.lines = lines_;
    const Compensation ideal = sampled_compensation(format, result, options);
    const std::vector<AxisName> axes = machine_.main_linear_axes();
    for (const AxisName input : axes) {
      const Axis& axis = machine_.axis(input);
      const auto positions = correction_positions(axis, options.step, format.limits.equidistant);
      require_points(format, axis, positions.size());
      for (const AxisName output : axes) add_table(ideal, input, output, positions);
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
      for (std::size_t k = i + 1; k < axes.size(); ++k) add_pair(axes[i], axes[k]);
    }
  }

  ProductTables take() { return std::move(tables_); }

 private:
  static TableFormatOptions angular_part(TableFormatOptions options) {
    options.type = CompensationPart::Angular;
    return options;
  }

  /// Along the specific line of the input, less what the lines' crossing has, which the table of an axis on
  /// itself holds: zero is at home.
  void add_table(const Compensation& ideal, AxisName input, AxisName output,
                 const std::vector<double>& positions) {
    const int k = direction_of(output);
    const double at_crossing = ideal.correction(lines_, {})[k];
    const auto value = [&](double q, int direction) {
      AxisPosition position = lines_;
      position[index_of(input)] = q;
      ApproachDirection approach{};
      approach[index_of(input)] = static_cast<std::int8_t>(both_ ? direction : 0);
      return ideal.correction(position, approach)[k] - (input == output ? 0.0 : at_crossing);
    };
    AxisTable table{.input = input, .position = positions, .forward = {}, .backward = {}};
    for (const double q : positions) {
      table.forward.push_back(value(q, 1));
      table.backward.push_back(value(q, -1));
    }
    tables_.tables.push_back({output, std::move(table)});
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
                         " do together is not a product of a table and a distance",
                     "write a format with a grid, or do not superimpose");
  }

  void add_products(const AngularPair& pair, AxisName turning, AxisName lever) {
    for (const AxisName output : machine_.main_linear_axes()) {
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
