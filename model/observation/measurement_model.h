#pragma once
/// The measurement model of a campaign: predicts every reading from the parameter vector and gives its
/// derivatives. Kinematics at first order (chain.h), plus, on request, the exact transforms' second-order
/// remainder held fixed at a given parameter vector.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/effects/effect.h"
#include "volcal/model/instruments/instrument.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

inline constexpr int kMaxGroups = 36;
inline constexpr int kMaxSupport = 64;

/// Derivatives of one row (all channels of one reading). Function part: coefficient j of slot s in group g
/// has derivative basis_value[g][j - start] * weight[channel][g-th group's first weight + s].
struct RowJacobian {
  int channels = 0;
  double predicted[kMaxChannels];
  std::vector<int> start;                        ///< per group: first active basis function
  std::vector<double> basis_value;               ///< concatenated supports of the groups
  std::vector<double> weight[kMaxChannels];      ///< concatenated slots of the groups
  std::vector<int> tail_index;                   ///< parameters outside the functions
  std::vector<double> tail_value[kMaxChannels];  ///< their derivatives
};

/// Raw parameters that a row depends on, and its derivatives as a dense vector over all parameters.
std::vector<int> touched_parameters(const ParameterLayout& layout, const RowJacobian& row);
Eigen::VectorXd dense_row(const ParameterLayout& layout, const RowJacobian& row, int channel);

class MeasurementModel {
 public:
  /// `spec` must be resolved: every function that uses knots has breakpoints. Throws InputError.
  MeasurementModel(const Campaign& campaign, const ModelSpec& spec);
  ~MeasurementModel();
  MeasurementModel(const MeasurementModel&) = delete;
  MeasurementModel& operator=(const MeasurementModel&) = delete;

  const Campaign& campaign() const { return campaign_; }
  const ModelSpec& spec() const { return spec_; }
  const KinematicChain& chain() const { return chain_; }
  const ParameterLayout& layout() const { return layout_; }
  const BoundSetup& bound(std::size_t setup) const { return *bound_[setup]; }

  /// Parameters to start from: guesses, and the model file's coefficients where it has them.
  Eigen::VectorXd initial_parameters() const;
  /// Prediction of one reading, `channels` values, SI.
  void predict(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
               double* predicted) const;
  /// Prediction and derivatives; `out` is reused between calls.
  void linearize(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                 RowJacobian& out) const;

  /// Fixes the second-order remainder (exact minus first-order functional point) at these parameters; it is
  /// added to every later prediction. Without it predictions are first order.
  void set_second_order_remainder(const Eigen::VectorXd& parameters);
  void clear_second_order_remainder() { remainder_w_.clear(); }

  /// Stated standard deviation of a channel, SI: constant, per metre and repeatability, or the sigma column.
  double sigma(std::size_t setup, std::size_t row, int channel, const Eigen::VectorXd& parameters) const;

  /// Errors at a commanded position (effects and tool errors not included), SI.
  PoseErrors<double> errors_at(const AxisPosition& position, const Eigen::VectorXd& parameters) const;

 private:
  struct EffectPlace;
  struct SetupPlace;

  AxisPosition position(const Readings& readings, std::size_t row) const;
  void build_layout();
  void add_block(ParameterBlock block);

  const Campaign& campaign_;
  ModelSpec spec_;
  KinematicChain chain_;
  ParameterLayout layout_;
  std::vector<std::unique_ptr<BoundSetup>> bound_;
  std::vector<std::unique_ptr<BoundEffect>> effects_;
  std::vector<EffectPlace> effect_places_;
  std::vector<SetupPlace> setup_places_;
  std::vector<std::vector<Eigen::Vector3d>> remainder_w_;
};

/// First-order error of the functional point at a commanded position and tool, by parameters: linear map with
/// one row per component (ex, ey, ez in m, ea, eb, ec in rad) and one column per parameter of `layout`.
Eigen::Matrix<double, 6, Eigen::Dynamic> pose_error_rows(const KinematicChain& chain,
                                                         const ParameterLayout& layout,
                                                         const AxisPosition& position,
                                                         const Eigen::Vector3d& tool_offset);

}  // namespace volcal
