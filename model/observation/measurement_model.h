#pragma once
/// The measurement model of a campaign: predicts every reading from the parameter vector and gives its
/// derivatives. Kinematics at first order (chain.h), plus, on request, the exact transforms' second-order
/// remainder held fixed at a given parameter vector.

#include <Eigen/Core>
#include <map>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/measured_ends.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/instruments/instrument.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/campaign_binding.h"
#include "volcal/model/observation/parameters.h"
#include "volcal/model/observation/position_tables.h"
#include "volcal/model/observation/row_jacobian.h"

namespace volcal {

/// Location errors and amplitudes of effects that a model can have; more are refused.
inline constexpr std::size_t kMaxSharedTerms = 640;

class MeasurementModel {
 public:
  /// `spec` must be resolved: every function that uses knots has breakpoints. Throws InputError.
  MeasurementModel(const Campaign& campaign, ModelSpec spec);
  MeasurementModel(const MeasurementModel&) = delete;
  MeasurementModel& operator=(const MeasurementModel&) = delete;

  const Campaign& campaign() const { return campaign_; }
  const ModelSpec& spec() const { return spec_; }
  const KinematicChain& chain() const { return chain_; }
  const ParameterLayout& layout() const { return binding_.layout; }
  const BoundSetup& bound(std::size_t setup) const { return *binding_.setups[setup].bound; }
  const CampaignBinding& binding() const { return binding_; }
  const PositionTables& tables() const { return tables_; }
  /// Whether the joint's stator frame turns with rotary axes.
  bool joint_turns(std::size_t joint) const { return joint_turns_[joint] != 0; }
  /// Motion of every function, 6 x joint + component, group by group.
  const std::vector<int>& slot_motion() const { return slot_motion_; }
  /// Per setup and row; empty when predictions are first order.
  const std::vector<std::vector<Eigen::Vector3d>>& second_order_remainder_w() const { return remainder_w_; }
  /// Number of parameters besides the functions' that every row depends on; they lead its tail.
  int shared_tail_size() const {
    return static_cast<int>(binding_.shared_terms.size()) + binding_.effect_parameters;
  }

  /// Parameters to start from: guesses, and the model file's coefficients where it has them.
  Eigen::VectorXd initial_parameters() const;
  /// Prediction of one reading, `channels` values, SI.
  void predict(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
               double* predicted) const;
  /// Function values for many calls of linearize() with the same parameters.
  TabulatedFunctions tabulate(const Eigen::VectorXd& parameters) const;
  /// Prediction and derivatives; `out` is reused between calls. `tabulated`: those of `parameters`, or null;
  /// the result is the same to the bit.
  void linearize(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters, RowJacobian& out,
                 const TabulatedFunctions* tabulated = nullptr) const;

  /// Derivatives of a reading's channels to a unit of every disturbance (campaign_binding.h).
  using DisturbanceRows = Eigen::Matrix<double, kMaxChannels, kDisturbances, Eigen::RowMajor>;
  void disturbance_rows(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                        DisturbanceRows& out) const;

  /// Fixes the second-order remainder (exact minus first-order functional point) at these parameters; it is
  /// added to every later prediction. Without it predictions are first order.
  void set_second_order_remainder(const Eigen::VectorXd& parameters);

  /// Expands the effects' drivers about the shape parameters in `parameters`; at first they are expanded
  /// about the model file's values.
  void expand_effects(const Eigen::VectorXd& parameters);
  /// Whether the drivers at the shape parameters in `parameters`, and on the way to them, are about what
  /// their expansion makes of them: not where a time constant went through zero.
  bool follow_expansion(const Eigen::VectorXd& parameters) const;
  /// Expands the effects' drivers as far on the way to `parameters` as they follow their expansion, and puts
  /// the shape parameters there.
  void approach_effects(Eigen::VectorXd& parameters);

  /// Stated standard deviation of a channel, SI: constant, per metre and repeatability, or the sigma column.
  /// The part per metre counts the length from where a station is guessed to stand, or, with `estimated`,
  /// from where `parameters` put it.
  double sigma(std::size_t setup, std::size_t row, int channel, const Eigen::VectorXd& parameters,
               bool estimated = false) const;
  /// Length of a reading that its noise is in proportion to, m, as `parameters` put the stations.
  double noise_length(std::size_t setup, std::size_t row, int channel,
                      const Eigen::VectorXd& parameters) const;

  /// Errors at a commanded position (effects and tool errors not included), SI.
  PoseErrors<double> errors_at(const AxisPosition& position, const Eigen::VectorXd& parameters) const;

 private:
  struct RowState;

  /// Nuisance parameters of a row, as its instrument takes them.
  void local_nuisance(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                      double* nuisance) const;
  PoseErrors<double> errors_at_reading(std::size_t setup, std::size_t row, const AxisPosition& position,
                                       const Eigen::VectorXd& parameters) const;
  void add_functions(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                     const TabulatedFunctions* tabulated, RowState& state, RowJacobian& out) const;
  void add_terms(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                 RowState& state) const;
  void move_tool(RowState& state) const;
  void disturbance_sensitivity(const RowState& state, const Linearization& reading, int channel, bool all,
                               double* sensitivity) const;
  void evaluate(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                const TabulatedFunctions* tabulated, RowState& state, Linearization& reading,
                RowJacobian& out) const;
  void resize(int channels, int own_tail, RowJacobian& out) const;
  void fill_channel(const SetupBinding& place, const RowState& state, const Linearization& reading,
                    int channel, RowJacobian& out) const;

  const Campaign& campaign_;
  ModelSpec spec_;
  KinematicChain chain_;
  CampaignBinding binding_;
  PositionTables tables_;
  std::vector<char> joint_turns_;
  std::vector<int> slot_motion_;
  std::vector<int> group_support_;  ///< per function group: basis values of a row
  std::size_t value_count_ = 0;     ///< basis values of a row
  std::map<AxisName, MeasuredEnds> measured_;
  std::vector<std::vector<Eigen::Vector3d>> remainder_w_;
};

/// Errors of the functions and locations of `layout` at a commanded position, SI; effects are not in them.
PoseErrors<double> pose_errors(const ParameterLayout& layout, const AxisPosition& position,
                               const Eigen::VectorXd& parameters);

/// First-order error of the functional point at a commanded position and tool, by parameters: linear map with
/// one row per component (ex, ey, ez in m, ea, eb, ec in rad) and one column per parameter of `layout`.
/// `measured`: where the error functions are taken; other than `position` where they are held beyond the
/// readings.
Eigen::Matrix<double, 6, Eigen::Dynamic> pose_error_rows(const KinematicChain& chain,
                                                         const ParameterLayout& layout,
                                                         const AxisPosition& position,
                                                         const Eigen::Vector3d& tool_offset,
                                                         const AxisPosition& measured);

}  // namespace volcal
