#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <utility>

#include "volcal/model/description/parameter_names.h"
#include "volcal/model/instruments/nuisance.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

const InstrumentSchema kLaserTrackerSchema = {
    .name = "laser-tracker",
    .summary = "Laser tracker: distance, azimuth and elevation of the reflector at the tool.",
    .equation = "length, azimuth (from +x to +y), elevation (from the xy plane) of P in the station's frame",
    .source = "ISO 10360-10; ISO/TR 16907, 7.6",
    .keys =
        [] {
          std::vector<KeySchema> keys = {
              {.key = "station",
               .type = KeyType::Text,
               .help = "name of the station; setups that name it share its position"},
              {.key = "station_mm",
               .type = KeyType::Vector3,
               .required = true,
               .help = "first guess of the station, workpiece coordinates",
               .plausible_max = 1e5},
              {.key = "station_sigma_mm",
               .help = "standard uncertainty of station_mm; absent = free",
               .plausible_max = 1e4}};
          for (const KeySchema& key : length_scale_keys()) keys.push_back(key);
          return keys;
        }(),
    .column_sets = {{{.column = "length_mm", .help = "distance", .plausible_max = 1e5},
                     {.column = "azimuth_deg", .help = "azimuth", .plausible_max = 720.0},
                     {.column = "elevation_deg", .help = "elevation", .plausible_max = 90.0}}},
    .noise_keys =
        [] {
          std::vector<KeySchema> keys = length_noise_keys();
          keys.push_back({.key = "angle_urad",
                          .required = true,
                          .help = "standard deviation of azimuth and elevation",
                          .plausible_max = 1e4});
          return keys;
        }(),
    .traits = {.laser_length = LaserLength::Distance,
               .length_from_zero = true,
               .encoders = {{"azimuth", 1}, {"elevation", 2}},
               .stands_on_floor = [](const Options&) { return true; }}};

/// Reflector in the station's frame from one reading.
Eigen::Vector3d cartesian(const Readings& readings, std::size_t row) {
  const double length = readings.value[0][row];
  const double azimuth = readings.value[1][row];
  const double elevation = readings.value[2][row];
  return length * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
}

constexpr double kNarrow = 1e-3;        // width of a cloud of points that has none, of its length
constexpr double kLeastWidth_m = 0.05;  // about the common direction of vectors from a guessed station

struct RotationGuess {
  Eigen::Matrix3d rotation_ws = Eigen::Matrix3d::Identity();
  bool determined = true;
};

/// Rotation that best turns the columns of `from` into those of `to` (Kabsch 1976).
Eigen::Matrix3d best_rotation(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(to * from.transpose(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d signs(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Eigen::Matrix3Xd centred(const Eigen::Matrix3Xd& points) {
  return points.colwise() - points.rowwise().mean();
}

/// Root mean square extents of columns about the origin, greatest first.
Eigen::Vector3d extents(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3d moments = points * points.transpose() / static_cast<double>(points.cols());
  return Eigen::JacobiSVD<Eigen::Matrix3d>(moments).singularValues().cwiseSqrt();
}

/// From points in the station's frame to workpiece directions. Points on one line leave a turn about it open,
/// which their vectors from the station fix, unless these lie on the line, too.
RotationGuess rotation_guess(const Readings& readings, const std::vector<Eigen::Vector3d>& points_w,
                             const Eigen::Vector3d& station_w) {
  Eigen::Matrix3Xd read_s(3, static_cast<Eigen::Index>(points_w.size())), nominal_w = read_s;
  for (std::size_t row = 0; row < points_w.size(); ++row) {
    read_s.col(static_cast<Eigen::Index>(row)) = cartesian(readings, row);
    nominal_w.col(static_cast<Eigen::Index>(row)) = points_w[row];
  }
  const Eigen::Vector3d width = extents(centred(nominal_w));
  if (width[1] > kNarrow * width[0]) return {best_rotation(centred(read_s), centred(nominal_w)), true};
  const Eigen::Matrix3Xd from_station_w = nominal_w.colwise() - station_w;
  return {best_rotation(read_s, from_station_w), extents(from_station_w)[1] > kLeastWidth_m};
}

class LaserTrackerSetup final : public EquationBase<LaserTrackerSetup> {
 public:
  explicit LaserTrackerSetup(SetupContext context) : nominal_point_w_(std::move(context.nominal_point_w)) {
    const Setup& setup = context.setup;
    set_channels(3);
    station_guess_w_ = *setup.options.vector("station");
    const RotationGuess guess = rotation_guess(setup.readings, nominal_point_w_, station_guess_w_);
    rotation_ws_ = guess.rotation_ws;
    is_turned_ = guess.determined;
    azimuth_ = setup.readings.value[1];
    add_nuisance(point_nuisance(station_parameter(setup.options.text("station").value_or(setup.name)),
                                station_guess_w_, setup.options.number("station_sigma").value_or(0.0)));
    NuisanceBlock rotation = point_nuisance(setup.name + ": station rotation", Eigen::Vector3d::Zero(), 0.0);
    rotation.is_angle.assign(3, true);
    add_nuisance(std::move(rotation));
    if (auto scale = length_scale_nuisance(setup)) {
      has_scale_ = true;
      add_nuisance(std::move(*scale));
    }
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    using std::atan2;
    using std::sqrt;
    const Vector3<T> station_w(nuisance[0], nuisance[1], nuisance[2]);
    const Eigen::Matrix<T, 3, 3> turn = rotation_321<T>(nuisance[3], nuisance[4], nuisance[5]);
    const Vector3<T> v =
        turn.transpose() * (rotation_ws_.transpose().cast<T>() * (state.point_w - station_w));
    predicted[0] = v.norm();
    if (has_scale_) predicted[0] = predicted[0] * (1.0 + nuisance[6]);
    predicted[1] = atan2(v[1], v[0]);
    predicted[1] += full_turns(row, value_of(predicted[1]));
    predicted[2] = atan2(v[2], sqrt(v[0] * v[0] + v[1] * v[1]));
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    const Eigen::Vector3d a =
        rotation_ws_.transpose() * (state.point_w - Eigen::Map<const Eigen::Vector3d>(nuisance));
    const Eigen::Matrix3d turn = rotation_321(nuisance[3], nuisance[4], nuisance[5]);
    const Eigen::Vector3d v = turn.transpose() * a;
    const Eigen::Matrix3d d_point = turn.transpose() * rotation_ws_.transpose();
    Eigen::Matrix3d d_turn;
    for (int k = 0; k < 3; ++k) d_turn.col(k) = rotation_derivative(k, nuisance + 3).transpose() * a;
    const Eigen::Matrix3d d_spherical = spherical_gradient(v);
    const double scale = has_scale_ ? 1.0 + nuisance[6] : 1.0;
    for (int channel = 0; channel < 3; ++channel) {
      const double factor = channel == 0 ? scale : 1.0;
      const Eigen::RowVector3d point = factor * d_spherical.row(channel) * d_point;
      const Eigen::RowVector3d angles = factor * d_spherical.row(channel) * d_turn;
      for (int k = 0; k < 3; ++k) {
        out.d_state[channel][k] = point[k];
        out.d_state[channel][3 + k] = out.d_state[channel][6 + k] = 0.0;
        out.d_nuisance[channel][k] = -point[k];
        out.d_nuisance[channel][3 + k] = angles[k];
      }
      if (has_scale_) out.d_nuisance[channel][6] = channel == 0 ? v.norm() : 0.0;
    }
  }

  bool is_foreseen(int channel) const override { return channel == 0 || is_turned_; }

  double noise_length(std::size_t row, int channel) const override {
    return channel == 0 ? (nominal_point_w_[row] - station_guess_w_).norm() : 0.0;
  }

  double noise_length_at(std::size_t row, int channel, const double* nuisance) const override {
    return channel == 0 ? (nominal_point_w_[row] - Eigen::Map<const Eigen::Vector3d>(nuisance)).norm() : 0.0;
  }

  double noise_constant(const Options& noise, int channel) const override {
    return noise.number(channel == 0 ? "constant" : "angle").value_or(0.0);
  }

 private:
  static double value_of(double x) { return x; }
  static double value_of(const InstrumentJet& x) { return x.a; }

  /// Whole turns that bring a predicted azimuth next to the reading.
  double full_turns(std::size_t row, double azimuth) const {
    const double turn = 2.0 * std::numbers::pi;
    return turn * std::round((azimuth_[row] - azimuth) / turn);
  }

  /// d(length, azimuth, elevation)/dv.
  static Eigen::Matrix3d spherical_gradient(const Eigen::Vector3d& v) {
    const double length = v.norm();
    const double in_plane2 = v[0] * v[0] + v[1] * v[1];
    const double in_plane = std::sqrt(in_plane2);
    Eigen::Matrix3d gradient;
    gradient.row(0) = v.transpose() / length;
    gradient.row(1) << -v[1] / in_plane2, v[0] / in_plane2, 0.0;
    gradient.row(2) << -v[0] * v[2] / (in_plane * length * length),
        -v[1] * v[2] / (in_plane * length * length), in_plane / (length * length);
    return gradient;
  }

  /// d(Rz(c) Ry(b) Rx(a))/d(angle k): e_k generators between the elementary rotations.
  static Eigen::Matrix3d rotation_derivative(int k, const double* angles) {
    const Eigen::Matrix3d rx = rotation_about(0, angles[0]);
    const Eigen::Matrix3d ry = rotation_about(1, angles[1]);
    const Eigen::Matrix3d rz = rotation_about(2, angles[2]);
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
    Eigen::Matrix3d generator;
    generator << 0.0, -axis[2], axis[1], axis[2], 0.0, -axis[0], -axis[1], axis[0], 0.0;
    if (k == 0) return rz * ry * generator * rx;
    if (k == 1) return rz * generator * ry * rx;
    return generator * rz * ry * rx;
  }

  std::vector<Eigen::Vector3d> nominal_point_w_;
  std::vector<double> azimuth_;
  Eigen::Vector3d station_guess_w_;
  Eigen::Matrix3d rotation_ws_;
  bool is_turned_ = true;  ///< the guess of the rotation is determined
  bool has_scale_ = false;
};

class LaserTracker final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kLaserTrackerSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<LaserTrackerSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& laser_tracker() {
  static const LaserTracker instrument;
  return instrument;
}

}  // namespace volcal
