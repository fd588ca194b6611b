#pragma once
/// The errors of the linear axes, rotary axes at 0, as polynomials between knots: what is known before a
/// position is asked for is summed once.
///
/// With the linear axes numbered from the workpiece to the tool and u their directions, the first-order error
/// (chain.h) is e = sum_i D_i(q_i) + sum_{i < k} q_k E_i(q_i) x u_k, D_i the displacement that axis i makes
/// with the axes behind it at 0, effects by its own position and direction included, and E_i its rotation.
/// D_i and E_i x u_k are polynomials between the knots of axis i.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "volcal/identify/errors/machine_effects.h"
#include "volcal/identify/errors/pose.h"
#include "volcal/identify/result/result.h"

namespace volcal {

/// Vector polynomials of one axis, all with the same pieces.
struct AxisPolynomials {
  std::size_t axis = 0;  ///< by AxisName
  double first = 0.0;    ///< of the travel, m
  double bins_per_m = 0.0;
  double last_bin = 0.0;
  std::vector<std::int32_t> piece_of_bin;  ///< piece in which a bin of the travel begins
  std::vector<double> end;                 ///< per piece, m; of the last one infinity
  std::vector<double> middle;              ///< per piece, m
  std::vector<double> per_half;            ///< per piece, 1/m: the local coordinate is -1 and 1 at the ends
  int powers = 1;
  int vectors = 1;  ///< D, then E x u of every axis behind
  /// [direction: towards -, mean, towards +][piece][power, highest first][vector][x y z and a zero]
  std::vector<double> coefficients;
};

class LinearAxisErrors {
 public:
  /// None where a function is no polynomial of low degree between knots. `effects`: on error motions of an
  /// axis, by its own position and direction; those that are polynomials between the knots are summed too.
  static std::optional<LinearAxisErrors> make(const FitResult& result, const Eigen::Vector3d& tool_offset,
                                              const MachineEffects& effects);
  /// Numbers of the effects that are not in the polynomials.
  const std::vector<std::size_t>& effects_left_out() const { return effects_left_out_; }

  Eigen::Vector3d at(const AxisPosition& position, const ApproachDirection& direction) const;
  /// At many positions; `directions` one for all or one for each. Throws std::invalid_argument where counts
  /// differ.
  void at(std::span<const AxisPosition> positions, std::span<const ApproachDirection> directions,
          std::span<Eigen::Vector3d> errors) const;

 private:
  LinearAxisErrors() = default;

  /// Workpiece to tool; axes that the machine lacks first, with polynomials that are zero.
  std::array<AxisPolynomials, 3> axes_;
  std::vector<std::size_t> effects_left_out_;
};

}  // namespace volcal
