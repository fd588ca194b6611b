#pragma once
/// The measurement model for stretches of readings of one setup side by side: the same predictions and
/// derivatives as MeasurementModel::linearize() gives one reading at a time, to rounding, in vector loops.
///
/// The gradient needs no row of the Jacobian. Weighted errors of a reading's channels act as a force and a
/// torque on the tool; their work on a unit of every motion of a joint (virtual work) is what the functions
/// of that joint gather at the position of its axis (gradient_sums.h).

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "volcal/model/instruments/instrument.h"
#include "volcal/model/observation/gradient_sums.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Readings first_row to first_row + size of a setup, size <= kLanes, with the same parameters besides the
/// functions'.
struct ReadingBlock {
  std::uint32_t setup = 0;
  std::uint32_t first_row = 0;
  int size = 0;
  std::uint32_t own = 0;  ///< number of their own parameters: BlockModel::own_parameters()
};

/// What a block's derivatives are made of besides those of the instrument; the place and the levers do not
/// depend on the parameters. Memory of one thread.
struct BlockLevers {
  std::vector<Lanes> position;     ///< per axis
  std::vector<Lanes> arm_s;        ///< 3 per joint
  std::vector<Lanes> rotation_ws;  ///< 9 per joint, filled where it turns
  std::vector<Lanes> rotation_wt;  ///< 9; filled where the machine turns the tool's offset
  std::vector<Lanes> driver;       ///< per shared term, then per term and slope of the effects
  std::vector<Lanes> motion;       ///< per disturbance: its size, or the work on a unit of it
  ToolStateLanes tool;
};

/// A block linearised at some parameters.
struct BlockLinearization {
  LinearizationLanes reading;
  std::vector<Lanes> floor_arm_w;  ///< 3, where the floor tilts
};

class BlockModel {
 public:
  /// `model` must outlive the object.
  explicit BlockModel(const MeasurementModel& model);

  const MeasurementModel& model() const { return model_; }
  /// All readings, setup by setup, row by row.
  const std::vector<ReadingBlock>& blocks() const { return blocks_; }
  /// Distinct lists of the parameters that only some readings have: tool offset error, then nuisance.
  const std::vector<std::vector<int>>& own_parameters() const { return own_; }
  /// Of the own parameters, those of the instrument.
  std::span<const int> nuisance_of(const ReadingBlock& block) const;
  /// Parameters of the shared tail, place by place.
  std::vector<int> shared_parameters() const;
  BlockLevers make_levers() const;

  /// Levers and linearisation of a block. `tabulated`: MeasurementModel::tabulate(parameters).
  void linearize(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                 const TabulatedFunctions& tabulated, BlockLevers& levers, BlockLinearization& out) const;
  /// The levers, sizes of all disturbances and the tool's state: linearize() without the instrument.
  void find_state(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                  const TabulatedFunctions& tabulated, BlockLevers& levers, BlockLinearization& out) const;
  /// What the instrument reads of the tool's state, without effects on the reading itself.
  void measure(const ReadingBlock& block, const Eigen::Ref<const Eigen::VectorXd>& parameters,
               const ToolStateLanes& tool, LinearizationLanes& out) const;
  /// The levers alone, for a linearisation made earlier.
  void find_levers(const ReadingBlock& block, const Eigen::VectorXd& parameters, BlockLevers& levers) const;
  /// sums += J^T e, `error` per channel; lanes beyond the block's size must be 0. Uses up `levers.motion`.
  void add_work(const ReadingBlock& block, const BlockLinearization& linearized, const Lanes* error,
                BlockLevers& levers, GradientSums& sums) const;

  /// Rows of the Jacobian for one channel, each times `scale`, row_width() numbers per reading: segment after
  /// segment, each filled up with zeros to whole multiples of kRowAlignment. First per group the derivatives
  /// to the values of its functions (not yet multiplied with the basis), then the shared tail (RowJacobian),
  /// then the block's own parameters. Uses up `levers.motion`.
  void make_rows(const ReadingBlock& block, const BlockLinearization& linearized, int channel,
                 const Lanes& scale, BlockLevers& levers, double* rows) const;
  /// The same for one number that the instrument sees: `component` of the tool's state (ToolState, in its
  /// order), or, from kStateSize on, the offset of a channel. Not where effects tilt the floor.
  void make_rows_of_state(const ReadingBlock& block, int component, BlockLevers& levers, double* rows) const;
  static constexpr int kRowAlignment = 8;
  std::size_t group_count() const { return model_.layout().groups.size(); }
  int segment_begin(std::size_t segment) const { return segment_begin_[segment]; }
  int row_width() const { return segment_begin_.back(); }

 private:
  void cut_setup(std::size_t setup);
  std::uint32_t own_number(const std::vector<int>& parameters);
  void find_drivers(const ReadingBlock& block, const Eigen::VectorXd& parameters, BlockLevers& levers) const;
  void add_functions(const ReadingBlock& block, const TabulatedFunctions& tabulated,
                     BlockLevers& levers) const;
  void add_terms(const ReadingBlock& block, const Eigen::VectorXd& parameters, BlockLevers& levers) const;
  void move_tool(const ReadingBlock& block, const Eigen::VectorXd& parameters, BlockLevers& levers,
                 BlockLinearization& out) const;
  void add_remainder(const ReadingBlock& block, Lanes* point_w) const;
  void move_offset(BlockLevers& levers, const Lanes* change_t) const;
  void tilt_floor(BlockLevers& levers, BlockLinearization& out) const;
  void find_work(const BlockLinearization& linearized, const Lanes* force, const Lanes* torque,
                 BlockLevers& levers) const;
  void add_column(const Lanes& lanes, int size, double* column) const;
  void make_rows_of_work(const ReadingBlock& block, const BlockLevers& levers, double* rows) const;
  void gather(const ReadingBlock& block, const BlockLevers& levers, GradientSums& sums) const;

  const MeasurementModel& model_;
  std::vector<ReadingBlock> blocks_;
  std::vector<std::vector<int>> own_;
  std::map<std::vector<int>, std::uint32_t> own_numbers_;  ///< places in own_
  std::vector<int> segment_begin_;                         ///< of a row, and its width
  bool turns_ = false;                                     ///< the machine has rotary axes
  bool moves_tool_ = false;  ///< some reading's tool offset is uncertain or disturbed
};

}  // namespace volcal
