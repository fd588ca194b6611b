#include "volcal/identify/solve/priors/rotary_gauge.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "volcal/identify/numeric/dense.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

constexpr int kPosesPerUnknown = 2;
constexpr int kFewestPoses = 200;
// Singular value beside the largest: splines resolve a rotation less well than Fourier series do.
constexpr double kExchangeable = 1e-3;
constexpr double kHeldExchange =
    1e-7;  // m or rad: nothing beside the wide prior, and no rounding beside readings
// Of locations beside functions: an exchange between the two is settled in the functions.
constexpr double kWeightOfLocations = 1e-3;

class RotaryGauge {
 public:
  RotaryGauge(const MeasurementModel& model, const DatumSpace& datum)
      : model_(model), datum_(datum), chain_(model.chain()), machine_(model.campaign().machine) {
    for (const auto& function : datum.functions()) {
      if (is_rotary(function.symbol.axis) && function.size() > 0) functions_.push_back(&function);
    }
    for (const auto& block : datum.blocks()) {
      if (model.layout().blocks[block.block].location) locations_.push_back(&block);
    }
  }

  Eigen::MatrixXd precision() const {
    Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(datum_.size(), datum_.size());
    if (functions_.empty() || machine_.tools.empty()) return precision;
    const std::vector<int> index = coordinates();
    const Eigen::MatrixXd exchanged = exchanges(static_cast<int>(index.size()));
    if (exchanged.cols() == 0) return precision;
    const Eigen::MatrixXd held = weights().asDiagonal() * exchanged;
    const Eigen::MatrixXd gram = held.transpose() * held;
    precision(index, index) = held * solve_positive_definite(gram, Eigen::MatrixXd(held.transpose())) /
                              (kHeldExchange * kHeldExchange);
    return precision;
  }

 private:
  std::vector<int> coordinates() const {
    std::vector<int> index;
    for (const auto* function : functions_) {
      for (int i = 0; i < function->size(); ++i) index.push_back(function->offset + i);
    }
    for (const auto* block : locations_) index.push_back(block->offset);
    return index;
  }

  Eigen::VectorXd weights() const {
    std::vector<double> weight;
    for (const auto* function : functions_)
      weight.insert(weight.end(), static_cast<std::size_t>(function->size()), 1.0);
    weight.insert(weight.end(), locations_.size(), kWeightOfLocations);
    return Eigen::Map<const Eigen::VectorXd>(weight.data(), static_cast<Eigen::Index>(weight.size()));
  }

  /// Combinations of the coordinates, one column each, that frames make up for at all poses.
  Eigen::MatrixXd exchanges(int count) const {
    const auto poses = spread_poses(machine_, std::max(kFewestPoses, kPosesPerUnknown * count));
    Eigen::MatrixXd columns(3 * static_cast<Eigen::Index>(poses.size()), count);
    Eigen::MatrixXd frames;
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      const std::size_t tool = pose % machine_.tools.size();
      const auto rows = frame_columns(machine_, chain_, poses[pose], tool);
      if (pose == 0) frames.resize(columns.rows(), rows.cols());
      frames.middleRows<3>(3 * static_cast<Eigen::Index>(pose)) = rows;
      columns.middleRows<3>(3 * static_cast<Eigen::Index>(pose)) = errors_at(poses[pose], tool, count);
    }
    return hidden_behind(frames, columns);
  }

  Eigen::Matrix<double, 3, Eigen::Dynamic> errors_at(const AxisPosition& position, std::size_t tool,
                                                     int count) const {
    Eigen::Matrix<double, 3, Eigen::Dynamic> columns(3, count);
    std::vector<JointLever> levers(chain_.joint_count());
    chain_.levers(position, machine_.tools[tool].offset, levers.data());
    const auto lever_of = [&](AxisName axis) { return *std::ranges::find(levers, axis, &JointLever::axis); };
    Eigen::Index next = 0;
    for (const auto* function : functions_) {
      const ErrorSymbol symbol = function->symbol;
      const int group = model_.layout().find(symbol)->group;
      const Basis& basis = *model_.layout().groups[static_cast<std::size_t>(group)].basis;
      const Eigen::RowVectorXd values =
          basis.row(position[index_of(symbol.axis)]).transpose() * function->basis;
      columns.middleCols(next, values.size()) =
          KinematicChain::motion_lever_w(lever_of(symbol.axis), symbol.component) * values;
      next += values.size();
    }
    for (const auto* block : locations_) {
      const LocationSymbol symbol = *model_.layout().blocks[block->block].location;
      columns.col(next++) = KinematicChain::location_lever_w(lever_of(symbol.axis), symbol.component);
    }
    return columns;
  }

  /// Null vectors of the columns with the frames projected out.
  static Eigen::MatrixXd hidden_behind(const Eigen::MatrixXd& frames, const Eigen::MatrixXd& columns) {
    const SymmetricEigen of_frames = eigen_decomposition(frames.transpose() * frames);
    const double least = 1e-12 * of_frames.values[of_frames.values.size() - 1];
    Eigen::MatrixXd seen = columns;
    for (Eigen::Index i = 0; i < of_frames.values.size(); ++i) {
      if (of_frames.values[i] <= least) continue;
      const Eigen::VectorXd direction = frames * of_frames.vectors.col(i) / std::sqrt(of_frames.values[i]);
      seen -= direction * (direction.transpose() * seen);
    }
    const SymmetricEigen eigen = eigen_decomposition(seen.transpose() * seen);
    const double largest = eigen.values[eigen.values.size() - 1];
    const auto hidden = (eigen.values.array() < kExchangeable * kExchangeable * largest).count();
    return eigen.vectors.leftCols(hidden);
  }

  const MeasurementModel& model_;
  const DatumSpace& datum_;
  const KinematicChain& chain_;
  const Machine& machine_;
  std::vector<const DatumSpace::FunctionCoordinates*> functions_;
  std::vector<const DatumSpace::BlockCoordinates*> locations_;
};

}  // namespace

Eigen::MatrixXd rotary_gauge(const MeasurementModel& model, const DatumSpace& datum) {
  return RotaryGauge(model, datum).precision();
}

}  // namespace volcal
