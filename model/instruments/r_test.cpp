#include <string>
#include <utility>
#include <vector>

#include "volcal/model/description/parameter_names.h"
#include "volcal/model/instruments/nuisance.h"
#include "volcal/model/instruments/reading_frame.h"

namespace volcal {
namespace {

const InstrumentSchema kRTestSchema = {
    .name = "r-test",
    .summary =
        "Sphere and nest of three sensors: displacement of the tool against the workpiece while rotary axes "
        "turn and linear axes follow.",
    .equation = "d = P - P_nominal + sphere, in the axes of `frame`, there + zero of the sensors",
    .source = "ISO 10791-6, annex B; Weikert, CIRP Annals 53 (2004) 429",
    .keys = {{.key = "sphere",
              .type = KeyType::Text,
              .help = "name of the sphere's place; setups that name the same place share it"},
             frame_key()},
    .column_sets = {{{.column = "dx_um", .help = "displacement along x", .plausible_max = 1e5},
                     {.column = "dy_um", .help = "displacement along y", .plausible_max = 1e5},
                     {.column = "dz_um", .help = "displacement along z", .plausible_max = 1e5}}},
    .noise_keys = {{.key = "constant_um",
                    .help = "standard deviation of every component",
                    .plausible_min = 1e-3,
                    .plausible_max = 1e4}},
    .traits = {.sphere_reading = SphereReading::Displacement}};

class RTestSetup final : public EquationBase<RTestSetup> {
 public:
  explicit RTestSetup(const SetupContext& context)
      : frames_(reading_frames(context)), nominal_point_w_(context.nominal_point_w) {
    const Setup& setup = context.setup;
    set_channels(3);
    const std::string sphere = setup.options.text("sphere").value_or(setup.name);
    add_nuisance(point_nuisance(sphere_parameter(sphere), Eigen::Vector3d::Zero(), 0.0));
    has_zero_ = !reads_in_workpiece(setup);
    if (has_zero_)
      add_nuisance(point_nuisance(setup.name + ": zero of the sensors", Eigen::Vector3d::Zero(), 0.0));
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> sphere_w(nuisance[0], nuisance[1], nuisance[2]);
    const Vector3<T> displacement_w = state.point_w - nominal_point_w_[row].cast<T>() + sphere_w;
    const Vector3<T> read = frames_[row].rotation.cast<T>() * displacement_w;
    for (int k = 0; k < 3; ++k) predicted[k] = has_zero_ ? T(read[k] + nuisance[3 + k]) : read[k];
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    const Eigen::Matrix3d& rotation = frames_[row].rotation;
    for (int channel = 0; channel < 3; ++channel) {
      for (int k = 0; k < kStateSize; ++k) out.d_state[channel][k] = k < 3 ? rotation(channel, k) : 0.0;
      for (int k = 0; k < 3; ++k) {
        out.d_nuisance[channel][k] = rotation(channel, k);
        if (has_zero_) out.d_nuisance[channel][3 + k] = channel == k ? 1.0 : 0.0;
      }
    }
  }

  double noise_length(std::size_t /*row*/, int /*channel*/) const override { return 0.0; }

 private:
  std::vector<ReadingFrame> frames_;
  std::vector<Eigen::Vector3d> nominal_point_w_;
  bool has_zero_ = false;
};

class RTest final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kRTestSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<RTestSetup>(context);
  }
};

}  // namespace

const Instrument& r_test() {
  static const RTest instrument;
  return instrument;
}

}  // namespace volcal
