#include <utility>

#include "volcal/model/description/parameter_names.h"
#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

/// Out of the plane of a circle the centre is invisible to first order; there it stays at the guess.
constexpr double kDefaultCentreSigma = 0.1e-3;

const InstrumentSchema kBallBarSchema = {
    .name = "ball-bar",
    .summary = "Telescoping ball-bar: distance between a ball at the table and one at the tool.",
    .equation = "length = |P - centre| + bar length error",
    .source = "ISO 230-4; ISO/TR 16907, 7.6",
    .keys = {{.key = "centre_mm",
              .type = KeyType::Vector3,
              .required = true,
              .help = "centre ball, workpiece coordinates, as set up",
              .plausible_max = 1e5},
             {.key = "centre_sigma_mm",
              .help = "standard uncertainty of centre_mm; default 0.1",
              .plausible_max = 1e3},
             {.key = "length_sigma_um",
              .help = "standard uncertainty of the bar's length: 0 = calibrated, absent = free",
              .plausible_max = 1e6}},
    .column_sets = {{{.column = "length_mm", .help = "length of the bar", .plausible_max = 1e4}}},
    .noise_keys = length_noise_keys(),
    .traits = {.length_from_zero = true, .has_bar = true, .reads_in_motion = true}};

class BallBarSetup final : public EquationBase<BallBarSetup> {
 public:
  explicit BallBarSetup(SetupContext context) : nominal_point_w_(std::move(context.nominal_point_w)) {
    const Setup& setup = context.setup;
    centre_guess_w_ = *setup.options.vector("centre");
    const auto centre_sigma = setup.options.number("centre_sigma");
    NuisanceBlock centre = point_nuisance(centre_parameter(setup.name), centre_guess_w_,
                                          centre_sigma.value_or(kDefaultCentreSigma));
    centre.weak_default_prior = !centre_sigma;
    add_nuisance(std::move(centre));
    const auto length_sigma = setup.options.number("length_sigma");
    if (length_sigma && *length_sigma == 0.0) return;
    has_length_error_ = true;
    NuisanceBlock length =
        scalar_nuisance(setup.name + ": bar length error", length_guess(setup), length_sigma.value_or(0.0));
    length.prior_mean.setZero();
    add_nuisance(std::move(length));
  }

  template <class T>
  void equation(std::size_t /*row*/, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> centre_w(nuisance[0], nuisance[1], nuisance[2]);
    predicted[0] = (state.point_w - centre_w).norm();
    if (has_length_error_) predicted[0] += nuisance[3];
  }

  void linearize(std::size_t /*row*/, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    const Eigen::Vector3d bar = state.point_w - Eigen::Map<const Eigen::Vector3d>(nuisance);
    const double length = bar.norm();
    out.predicted[0] = length + (has_length_error_ ? nuisance[3] : 0.0);
    for (int k = 0; k < 3; ++k) {
      out.d_state[0][k] = bar[k] / length;
      out.d_state[0][3 + k] = out.d_state[0][6 + k] = 0.0;
      out.d_nuisance[0][k] = -bar[k] / length;
    }
    out.d_nuisance[0][3] = 1.0;
  }

  double noise_length(std::size_t row, int /*channel*/) const override {
    return (nominal_point_w_[row] - centre_guess_w_).norm();
  }

  double noise_length_at(std::size_t row, int /*channel*/, const double* nuisance) const override {
    return (nominal_point_w_[row] - Eigen::Map<const Eigen::Vector3d>(nuisance)).norm();
  }

 private:
  double length_guess(const Setup& setup) const {
    double sum = 0.0;
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      sum += setup.readings.value[0][row] - noise_length(row, 0);
    }
    return sum / static_cast<double>(setup.readings.size());
  }

  std::vector<Eigen::Vector3d> nominal_point_w_;
  Eigen::Vector3d centre_guess_w_;
  bool has_length_error_ = false;
};

class BallBar final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kBallBarSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<BallBarSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& ball_bar() {
  static const BallBar instrument;
  return instrument;
}

}  // namespace volcal
