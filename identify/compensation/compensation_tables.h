#pragma once
/// Compensation tables as the controller that reads them evaluates them: what readers of table formats
/// return.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "volcal/identify/compensation/correction.h"
#include "volcal/identify/errors/error_field.h"

namespace volcal {

/// What happens beyond the first and last position of a table.
enum class BeyondEnds {
  Hold,      ///< the end value stays
  Continue,  ///< the end piece goes on as a straight line
  Repeat     ///< the table begins anew: of rotary axes, one turn
};

/// A function of one axis by its values, linear between them; direction 0 is the mean of both.
struct AxisTable {
  AxisName input = AxisName::X;
  std::vector<double> position;  ///< ascending, m or rad
  std::vector<double> forward;   ///< approached towards +
  std::vector<double> backward;  ///< approached towards -
  BeyondEnds beyond = BeyondEnds::Hold;

  double value(const AxisPosition& at, const ApproachDirection& direction) const;
};

/// Values on a rectangular grid of the linear axes, trilinear between its nodes, held beyond them. A table of
/// fewer axes has one node on the others.
struct CorrectionGrid {
  std::array<std::vector<double>, 3> nodes;  ///< X, Y, Z ascending, m
  std::vector<Eigen::Vector3d> mean;         ///< Z fastest, of both directions
  /// Per axis: half the difference of approach towards + and towards -; empty = none.
  std::array<std::vector<Eigen::Vector3d>, 3> half_reversal;

  std::size_t size() const { return nodes[0].size() * nodes[1].size() * nodes[2].size(); }
  Eigen::Vector3d value(const AxisPosition& at, const ApproachDirection& direction) const;
};

/// Calls visit(index, position) for every node, Z fastest, rotary axes at 0.
template <class Visit>
void for_each_node(const std::array<std::vector<double>, 3>& nodes, Visit&& visit) {
  std::size_t index = 0;
  for (const double x : nodes[0]) {
    for (const double y : nodes[1]) {
      for (const double z : nodes[2]) visit(index++, AxisPosition{x, y, z, 0.0, 0.0, 0.0});
    }
  }
}

/// Values of the table, m, of a rotary output rad, to the command of `output`.
CorrectionTerm axis_term(AxisName output, AxisTable table);
/// Product of two tables, for controllers that multiply them.
CorrectionTerm product_term(AxisName output, AxisTable table, AxisTable factor);
CorrectionTerm grid_term(CorrectionGrid grid);

struct CompensationTables {
  std::vector<CorrectionTerm> terms;  ///< their sum is the correction
  double least_increment = 0.0;       ///< m; the sum of each linear axis is rounded to it; 0 = not rounded

  Correction correction(const AxisPosition& position, const ApproachDirection& direction) const;
};

}  // namespace volcal
