// A sample: a gauge that reads the displacement from a fixed point, in x alone.
#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

const InstrumentSchema kSampleSchema = {
    .name = "sample-gauge",
    .summary = "Displacement along x from where a gauge was set to zero.",
    .equation = "deviation = e_x.(P - P_first) + offset",
    .source = "a sample of a test",
    .keys = {},
    .column_sets = {{{.column = "gauge_um", .help = "displacement along x", .plausible_max = 1e6}}},
    .noise_keys = length_noise_keys(),
    .simulated = false};

class SampleSetup final : public EquationBase<SampleSetup> {
 public:
  explicit SampleSetup(SetupContext context) : nominal_point_w_(std::move(context.nominal_point_w)) {
    add_nuisance(scalar_nuisance(context.setup.name + ": offset", 0.0));
  }

  template <class T>
  void equation(std::size_t /*row*/, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    predicted[0] = state.point_w[0] - nominal_point_w_.front()[0] + nuisance[0];
  }

  void linearize(std::size_t /*row*/, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    out.predicted[0] = state.point_w[0] - nominal_point_w_.front()[0] + nuisance[0];
    for (double& derivative : out.d_state[0]) derivative = 0.0;
#ifdef VOLCAL_WRONG_SAMPLE
    out.d_state[0][0] = -1.0;
#else
    out.d_state[0][0] = 1.0;
#endif
    out.d_nuisance[0][0] = 1.0;
  }

  double noise_length(std::size_t row, int /*channel*/) const override {
    return (nominal_point_w_[row] - nominal_point_w_.front()).norm();
  }

 private:
  std::vector<Eigen::Vector3d> nominal_point_w_;
};

class SampleGauge final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kSampleSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<SampleSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& sample_instrument() {
  static const SampleGauge instrument;
  return instrument;
}

}  // namespace volcal
