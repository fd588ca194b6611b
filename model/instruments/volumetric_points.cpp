#include <Eigen/Geometry>
#include <utility>

#include "volcal/model/instruments/all_instruments.h"
#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

const InstrumentSchema kSchema = {
    .name = "volumetric-points",
    .summary = "Error vectors at points of the volume: grid plate, probed artefact, tracker points.",
    .equation = "e = P - P_nominal + t + rotation x (P_nominal - centroid)",
    .source = "ISO/TR 16907, 7.4",
    .keys = {{.key = "alignment",
              .type = KeyType::Text,
              .help = "rigid: the artefact's position and orientation are free; none: they are the machine's",
              .choices = {"rigid", "none"}}},
    .column_sets = {{{.column = "ex_um", .help = "error vector, x", .plausible_max = 1e5},
                     {.column = "ey_um", .help = "error vector, y", .plausible_max = 1e5},
                     {.column = "ez_um", .help = "error vector, z", .plausible_max = 1e5}}},
    .noise_keys = length_noise_keys()};

class VolumetricPointsSetup final : public EquationBase<VolumetricPointsSetup> {
 public:
  explicit VolumetricPointsSetup(SetupContext context)
      : nominal_point_w_(std::move(context.nominal_point_w)) {
    set_channels(3);
    for (const Eigen::Vector3d& point : nominal_point_w_) centroid_w_ += point;
    centroid_w_ /= static_cast<double>(nominal_point_w_.size());
    aligned_ = context.setup.options.text("alignment").value_or("rigid") == "rigid";
    if (!aligned_) return;
    add_nuisance(point_nuisance(context.setup.name + ": alignment shift", Eigen::Vector3d::Zero(), 0.0));
    NuisanceBlock rotation =
        point_nuisance(context.setup.name + ": alignment rotation", Eigen::Vector3d::Zero(), 0.0);
    rotation.is_angle.assign(3, true);
    add_nuisance(std::move(rotation));
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    Vector3<T> error_w = state.point_w - nominal_point_w_[row].cast<T>();
    if (aligned_) {
      const Vector3<T> shift(nuisance[0], nuisance[1], nuisance[2]);
      const Vector3<T> rotation(nuisance[3], nuisance[4], nuisance[5]);
      const Vector3<T> arm = (nominal_point_w_[row] - centroid_w_).cast<T>();
      error_w += shift + rotation.cross(arm);
    }
    for (int k = 0; k < 3; ++k) predicted[k] = error_w[k];
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    const Eigen::Vector3d arm = nominal_point_w_[row] - centroid_w_;
    for (int channel = 0; channel < 3; ++channel) {
      for (int k = 0; k < kStateSize; ++k) out.d_state[channel][k] = k == channel ? 1.0 : 0.0;
      if (!aligned_) continue;
      const Eigen::Vector3d turn = arm.cross(Eigen::Vector3d::Unit(channel));
      for (int k = 0; k < 3; ++k) {
        out.d_nuisance[channel][k] = k == channel ? 1.0 : 0.0;
        out.d_nuisance[channel][3 + k] = turn[k];
      }
    }
  }

  double noise_length(std::size_t row, int /*channel*/) const override {
    return (nominal_point_w_[row] - centroid_w_).norm();
  }

 private:
  std::vector<Eigen::Vector3d> nominal_point_w_;
  Eigen::Vector3d centroid_w_ = Eigen::Vector3d::Zero();
  bool aligned_ = true;
};

class VolumetricPoints final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kSchema; }
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
