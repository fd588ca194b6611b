#include <cmath>
#include <utility>

#include "volcal/model/description/parameter_names.h"
#include "volcal/model/instruments/nuisance.h"
#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

const InstrumentSchema kLaserTracerSchema = {
    .name = "laser-tracer",
    .summary = "Tracking interferometer: change of distance from a station to the reflector at the tool.",
    .equation = "length = |P - S| (1 + scale) - L0",
    .source =
        "Schwenke et al., CIRP Annals 54 (2005): multilateration with tracking interferometers; ISO/TR "
        "16907, 7.6",
    .keys =
        [] {
          std::vector<KeySchema> keys = {
              {.key = "station",
               .type = KeyType::Text,
               .help = "name of the station; setups that name the same station share its position"},
              {.key = "station_mm",
               .type = KeyType::Vector3,
               .required = true,
               .help = "first guess of the station, workpiece coordinates; centimetres are near enough",
               .plausible_max = 1e5},
              {.key = "station_sigma_mm",
               .help = "standard uncertainty of station_mm; absent = free",
               .plausible_max = 1e4}};
          for (const KeySchema& key : length_scale_keys()) keys.push_back(key);
          return keys;
        }(),
    .column_sets = {{{.column = "length_mm", .help = "interferometer reading", .plausible_max = 1e5}}},
    .noise_keys = length_noise_keys(),
    .traits = {.laser_length = LaserLength::Distance,
               .length_from_zero = true,
               .stands_on_floor = [](const Options&) { return true; }}};

/// `nuisance`: station and dead path; d_nuisance: their derivatives.
VOLCAL_VECTOR_LOOPS void measure_lengths(const Lanes* __restrict point_w, const double* nuisance,
                                         double scale, Lanes& __restrict predicted, Lanes* __restrict d_point,
                                         Lanes* __restrict d_nuisance) {
  const double sx = nuisance[0], sy = nuisance[1], sz = nuisance[2], dead_path = nuisance[3];
  for (int i = 0; i < kLanes; ++i) {
    const double x = point_w[0].value[i] - sx, y = point_w[1].value[i] - sy, z = point_w[2].value[i] - sz;
    const double distance = std::sqrt(x * x + y * y + z * z);
    const double factor = scale / distance;
    predicted.value[i] = distance * scale - dead_path;
    d_point[0].value[i] = x * factor;
    d_point[1].value[i] = y * factor;
    d_point[2].value[i] = z * factor;
    d_nuisance[0].value[i] = -(x * factor);
    d_nuisance[1].value[i] = -(y * factor);
    d_nuisance[2].value[i] = -(z * factor);
    d_nuisance[3].value[i] = -1.0;
  }
}

class LaserTracerSetup final : public EquationBase<LaserTracerSetup> {
 public:
  explicit LaserTracerSetup(SetupContext context) : nominal_point_w_(std::move(context.nominal_point_w)) {
    const Setup& setup = context.setup;
    station_guess_w_ = *setup.options.vector("station");
    add_nuisance(point_nuisance(station_parameter(setup.options.text("station").value_or(setup.name)),
                                station_guess_w_, setup.options.number("station_sigma").value_or(0.0)));
    add_nuisance(scalar_nuisance(setup.name + ": dead path", dead_path_guess(setup)));
    if (auto scale = length_scale_nuisance(setup)) {
      has_scale_ = true;
      add_nuisance(std::move(*scale));
    }
  }

  template <class T>
  void equation(std::size_t /*row*/, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> station_w(nuisance[0], nuisance[1], nuisance[2]);
    const T distance = (state.point_w - station_w).norm();
    predicted[0] = (has_scale_ ? T(distance * (1.0 + nuisance[4])) : distance) - nuisance[3];
  }

  void linearize(std::size_t /*row*/, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    const Eigen::Vector3d from_station = state.point_w - Eigen::Map<const Eigen::Vector3d>(nuisance);
    const double distance = from_station.norm();
    const double scale = has_scale_ ? 1.0 + nuisance[4] : 1.0;
    const Eigen::Vector3d beam = from_station * (scale / distance);
    out.predicted[0] = distance * scale - nuisance[3];
    for (int k = 0; k < 3; ++k) {
      out.d_state[0][k] = beam[k];
      out.d_state[0][3 + k] = out.d_state[0][6 + k] = 0.0;
      out.d_nuisance[0][k] = -beam[k];
    }
    out.d_nuisance[0][3] = -1.0;
    if (has_scale_) out.d_nuisance[0][4] = distance;
  }

  void linearize_lanes(std::size_t /*first_row*/, int /*count*/, const ToolStateLanes& state,
                       const double* nuisance, LinearizationLanes& out) const override {
    measure_lengths(state.point_w, nuisance, has_scale_ ? 1.0 + nuisance[4] : 1.0, out.predicted(0),
                    out.d_state(0), out.d_nuisance(0));
    if (has_scale_) {
      for (int i = 0; i < kLanes; ++i)
        out.d_nuisance(0)[4][i] = (out.predicted(0)[i] + nuisance[3]) / (1.0 + nuisance[4]);
    }
  }

  double noise_length(std::size_t row, int /*channel*/) const override {
    return (nominal_point_w_[row] - station_guess_w_).norm();
  }

  double noise_length_at(std::size_t row, int /*channel*/, const double* nuisance) const override {
    return (nominal_point_w_[row] - Eigen::Map<const Eigen::Vector3d>(nuisance)).norm();
  }

 private:
  double dead_path_guess(const Setup& setup) const {
    double sum = 0.0;
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      sum += noise_length(row, 0) - setup.readings.value[0][row];
    }
    return sum / static_cast<double>(setup.readings.size());
  }

  std::vector<Eigen::Vector3d> nominal_point_w_;
  Eigen::Vector3d station_guess_w_;
  bool has_scale_ = false;
};

class LaserTracer final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kLaserTracerSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<LaserTracerSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& laser_tracer() {
  static const LaserTracer instrument;
  return instrument;
}

}  // namespace volcal
