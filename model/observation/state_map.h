#pragma once
/// What the instruments of a campaign see of the tool, for several parameter vectors side by side.
///
/// With kinematics of first order the tool's state at a reading is affine in the parameters: a constant, plus
/// coefficients of the reading times the values of the functions at its positions and times the parameters
/// that act besides. The coefficients are those of BlockModel::make_rows_of_state() and are kept; a pass over
/// the readings serves kVectors parameter vectors at a time, each with the same sums in the same order
/// whatever its neighbours. Equal to BlockModel::linearize() and add_work() to rounding.
///
/// Where a joint does not turn and only the point is seen, displacements need no coefficients and rotations
/// share those of the arm: point += d + e x arm, three numbers in place of eighteen.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "volcal/model/observation/block_model.h"

namespace volcal {

class StateMap {
 public:
  static constexpr int kVectors = 8;

  /// Whether states are affine in the parameters: not where shapes of effects are estimated, whose amplitudes
  /// multiply them, nor where effects tilt the floor, which turns displaced points.
  static bool is_exact_for(const MeasurementModel& model);

  /// `model` must outlive the object, and is_exact_for() must hold for it.
  explicit StateMap(const BlockModel& model);

  /// Numbers that an instrument sees at the readings of a block: components in the order of ToolState, the
  /// first three where it sees no rotation, then, where there are effects, the offset of every channel.
  struct Seen {
    ToolStateLanes tool;
    Lanes offset[kMaxChannels];
  };

  /// One number for each of kVectors parameter vectors.
  struct alignas(64) Octet {
    double value[kVectors];
  };
  /// Of everything that states depend on: the functions at every position, and the parameters besides.
  class Numbers {
   public:
    explicit Numbers(const StateMap& map);
    void set_zero();
    Octet& of_parameter(int parameter) { return parameters_[static_cast<std::size_t>(parameter)]; }

   private:
    friend class StateMap;
    std::vector<std::vector<Octet>> functions_;  ///< per group: positions x functions
    std::vector<Octet> parameters_;              ///< raw
  };

  /// `parameters`: raw, a column for each of up to kVectors vectors; further ones are zero.
  void set_parameters(const Eigen::MatrixXd& parameters, Numbers& values) const;
  /// `seen`: kVectors of them.
  void find(std::size_t block, const Numbers& values, Seen* seen) const;

  /// The adjoint: adds what the loads at a block's readings do on a unit of everything in `sums`. `load`:
  /// kVectors of them, lanes beyond the block's size are not read.
  void add_work(std::size_t block, const Seen* load, Numbers& sums) const;
  /// In raw parameters, a column per vector.
  Eigen::MatrixXd gradients(const Numbers& sums) const;

 private:
  struct Place {
    int components = 0;
    std::size_t coefficients = 0;  ///< first of its readings x (arms, then slots x components)
    std::size_t constants = 0;     ///< first of its components
    std::vector<char> has_arm;     ///< per group: d + e x arm
  };
  /// Rows of the Jacobian of a block, one matrix after another, of every component that is seen.
  using Rows = std::vector<std::vector<double>>;

  void add_block(const ReadingBlock& block, const TabulatedFunctions& zero, BlockLevers& levers);
  bool has_arm(const ReadingBlock& block, std::size_t group, const Rows& rows) const;
  void keep_rows(const ReadingBlock& block, const Rows& rows);

  const BlockModel& model_;
  std::vector<std::vector<int>> besides_;  ///< per setup: parameters besides the functions', slot by slot
  std::vector<Place> places_;              ///< per block
  std::vector<double> coefficients_;
  std::vector<Lanes> constants_;
};

}  // namespace volcal
