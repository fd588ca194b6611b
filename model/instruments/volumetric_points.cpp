#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

constexpr std::array<std::string_view, 3> kComponentColumns = {"ex_um", "ey_um", "ez_um"};

ColumnSchema coordinate_column(int k) {
  static const std::array<std::string, 3> kHelp = {"error vector, x", "error vector, y", "error vector, z"};
  const auto i = static_cast<std::size_t>(k);
  return {.column = std::string(kComponentColumns[i]), .help = kHelp[i], .plausible_max = 1e5};
}

const InstrumentSchema kVolumetricPointsSchema = {
    .name = "volumetric-points",
    .summary = "Error vectors at points of the volume: grid plate, probed artefact, tracker points.",
    .equation =
        "e = P - P_nominal + t + rotation x (P_nominal - pivot), of which one, two or three components "
        "are read; pivot: centroid of the points, or the origin with `artefact`",
    .source = "ISO/TR 16907, 7.6",
    .keys = {{.key = "alignment",
              .type = KeyType::Text,
              .help = "rigid: the artefact's position and orientation are free; none: they are the machine's",
              .choices = {"rigid", "none"}},
             {.key = "artefact",
              .type = KeyType::Text,
              .help = "setups that name the same artefact share its rigid alignment"}},
    .column_sets = {{coordinate_column(0), coordinate_column(1), coordinate_column(2)},
                    {coordinate_column(0), coordinate_column(1)},
                    {coordinate_column(1), coordinate_column(2)},
                    {coordinate_column(0), coordinate_column(2)},
                    {coordinate_column(0)},
                    {coordinate_column(1)},
                    {coordinate_column(2)}},
    .noise_keys = length_noise_keys(),
    .traits = {.reads_error_vectors = true}};

class VolumetricPointsSetup final : public EquationBase<VolumetricPointsSetup> {
 public:
  explicit VolumetricPointsSetup(SetupContext context)
      : nominal_point_w_(std::move(context.nominal_point_w)) {
    const Options& options = context.setup.options;
    for (const ColumnSchema& column :
         kVolumetricPointsSchema.column_sets[context.setup.readings.column_set]) {
      const auto place = std::ranges::find(kComponentColumns, column.column) - kComponentColumns.begin();
      component_.push_back(static_cast<int>(place));
    }
    set_channels(static_cast<int>(component_.size()));
    for (const Eigen::Vector3d& point : nominal_point_w_) centroid_w_ += point;
    centroid_w_ /= static_cast<double>(nominal_point_w_.size());
    aligned_ = options.text("alignment").value_or("rigid") == "rigid";
    if (!aligned_) return;
    const auto artefact = options.text("artefact");
    if (!artefact) pivot_w_ = centroid_w_;
    const std::string owner = artefact ? "artefact " + *artefact : context.setup.name;
    add_nuisance(point_nuisance(owner + ": alignment shift", Eigen::Vector3d::Zero(), 0.0));
    NuisanceBlock rotation = point_nuisance(owner + ": alignment rotation", Eigen::Vector3d::Zero(), 0.0);
    rotation.is_angle.assign(3, true);
    add_nuisance(std::move(rotation));
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    Vector3<T> error_w = state.point_w - nominal_point_w_[row].cast<T>();
    if (aligned_) {
      const Vector3<T> shift(nuisance[0], nuisance[1], nuisance[2]);
      const Vector3<T> rotation(nuisance[3], nuisance[4], nuisance[5]);
      const Vector3<T> arm = (nominal_point_w_[row] - pivot_w_).cast<T>();
      error_w += shift + rotation.cross(arm);
    }
    for (std::size_t channel = 0; channel < component_.size(); ++channel) {
      predicted[channel] = error_w[component_[channel]];
    }
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    const Eigen::Vector3d arm = nominal_point_w_[row] - pivot_w_;
    for (std::size_t channel = 0; channel < component_.size(); ++channel) {
      const int direction = component_[channel];
      for (int k = 0; k < kStateSize; ++k) out.d_state[channel][k] = k == direction ? 1.0 : 0.0;
      if (!aligned_) continue;
      const Eigen::Vector3d turn = arm.cross(Eigen::Vector3d::Unit(direction));
      for (int k = 0; k < 3; ++k) {
        out.d_nuisance[channel][k] = k == direction ? 1.0 : 0.0;
        out.d_nuisance[channel][3 + k] = turn[k];
      }
    }
  }

  double noise_length(std::size_t row, int /*channel*/) const override {
    return (nominal_point_w_[row] - centroid_w_).norm();
  }

 private:
  std::vector<Eigen::Vector3d> nominal_point_w_;
  std::vector<int> component_;  ///< of the error vector, per channel
  Eigen::Vector3d centroid_w_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d pivot_w_ = Eigen::Vector3d::Zero();
  bool aligned_ = true;
};

class VolumetricPoints final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kVolumetricPointsSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<VolumetricPointsSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& volumetric_points() {
  static const VolumetricPoints instrument;
  return instrument;
}

}  // namespace volcal
