#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/instruments/nuisance.h"
#include "volcal/model/instruments/reading_frame.h"

namespace volcal {
namespace {

enum ProbedColumns : std::size_t { kCentres, kContacts, kDiameters };

constexpr double kUnitNormal = 1e-3;  // a normal may be this far from unit length

/// n . tip
std::vector<double> reach_of_contacts(const Readings& readings) {
  std::vector<double> reach(readings.given.front().size(), 0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t row = 0; row < reach.size(); ++row)
      reach[row] += readings.given[k][row] * readings.given[3 + k][row];
  }
  return reach;
}

ColumnSchema coordinate(const std::string& column, const std::string& help) {
  return {.column = column, .help = help, .plausible_max = 1e5};
}

ColumnSchema normal_component(const std::string& column) {
  return {.column = column, .help = "outward unit normal at the contact"};
}

const InstrumentSchema kProbedSphereSchema = {
    .name = "probed-sphere",
    .summary =
        "Touch probe on a reference sphere: centres as the control records them, single contacts, or "
        "diameters.",
    .equation =
        "centre = S - e; contact: n.tip = n.(S - e) + radius; diameter = 2 radius; e the error at the "
        "commanded position of the reading",
    .source = "ISO 230-10; ISO 10791-6, annex C; Ibaraki et al., Precision Engineering 34 (2010) 387",
    .keys =
        {{.key = "sphere",
          .type = KeyType::Text,
          .help = "name of the sphere's place and session; setups that name the same share its centre"},
         {.key = "contact",
          .type = KeyType::Text,
          .help = "kind of contact, as a side of the probe; setups of one kind share its radius"},
         {.key = "radius_mm",
          .help =
              "distance of a recorded contact from the sphere's centre, as calibrated; default 0: tips are "
              "reduced to the centre",
          .plausible_min = 0.1,
          .plausible_max = 1e3},
         {.key = "radius_sigma_um",
          .help = "standard uncertainty of radius_mm: 0 = calibrated, absent = free",
          .plausible_max = 1e6},
         frame_key()},
    .column_sets = {{coordinate("cx_mm", "centre, x"), coordinate("cy_mm", "centre, y"),
                     coordinate("cz_mm", "centre, z")},
                    {{.column = "reach_mm",
                      .help = "recorded tip along the normal, n.tip",
                      .plausible_max = 1e5,
                      .derived = true}},
                    {coordinate("diameter_mm", "distance of two opposite contacts")}},
    .noise_keys = {{.key = "constant_um",
                    .help = "standard deviation of every component, contact or diameter",
                    .plausible_min = 1e-3,
                    .plausible_max = 1e4}},
    .traits = {.sphere_reading = SphereReading::Place},
    .given_columns = {{},
                      {coordinate("tip_x_mm", "recorded tip at the contact, x"),
                       coordinate("tip_y_mm", "recorded tip at the contact, y"),
                       coordinate("tip_z_mm", "recorded tip at the contact, z"), normal_component("n_x"),
                       normal_component("n_y"), normal_component("n_z")},
                      {}},
    .derive_reading = reach_of_contacts};

/// 0: recorded tips are reduced to the centre.
double nominal_radius(const SetupContext& context) {
  return context.setup.options.number("radius").value_or(0.0);
}

/// The radius of a kind of contact, free or held.
class ContactRadius {
 public:
  /// Index of the parameter among the setup's; -1 = calibrated.
  int parameter = -1;
  double calibrated = 0.0;

  template <class T>
  T value(const T* nuisance) const {
    return parameter < 0 ? T(calibrated) : nuisance[parameter];
  }
  bool is_free() const { return parameter >= 0; }
};

std::optional<NuisanceBlock> radius_nuisance(const SetupContext& context) {
  const auto sigma = context.setup.options.number("radius_sigma");
  if (sigma && *sigma == 0.0) return std::nullopt;
  const std::string kind = context.setup.options.text("contact").value_or(context.setup.name);
  return scalar_nuisance("contact " + kind + ": radius", nominal_radius(context), sigma.value_or(0.0));
}

std::string sphere_name(const Setup& setup) {
  return sphere_parameter(setup.options.text("sphere").value_or(setup.name));
}

class ProbedCentres final : public EquationBase<ProbedCentres> {
 public:
  explicit ProbedCentres(const SetupContext& context)
      : frames_(reading_frames(context)), nominal_point_w_(context.nominal_point_w) {
    set_channels(3);
    const auto& value = context.setup.readings.value;
    Eigen::Vector3d guess_w = Eigen::Vector3d::Zero();
    for (std::size_t row = 0; row < frames_.size(); ++row) {
      const Eigen::Vector3d centre(value[0][row], value[1][row], value[2][row]);
      guess_w += frames_[row].rotation.transpose() * centre + frames_[row].origin_w;
    }
    guess_w /= static_cast<double>(frames_.size());
    add_nuisance(point_nuisance(sphere_name(context.setup), guess_w, 0.0));
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> sphere_w(nuisance[0], nuisance[1], nuisance[2]);
    const Vector3<T> error_w = state.point_w - nominal_point_w_[row].cast<T>();
    const Vector3<T> recorded_w = sphere_w - error_w - frames_[row].origin_w.cast<T>();
    const Vector3<T> recorded = frames_[row].rotation.cast<T>() * recorded_w;
    for (int k = 0; k < 3; ++k) predicted[k] = recorded[k];
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    for (int channel = 0; channel < 3; ++channel) {
      for (int k = 0; k < kStateSize; ++k)
        out.d_state[channel][k] = k < 3 ? -frames_[row].rotation(channel, k) : 0.0;
      for (int k = 0; k < 3; ++k) out.d_nuisance[channel][k] = frames_[row].rotation(channel, k);
    }
  }

  double noise_length(std::size_t /*row*/, int /*channel*/) const override { return 0.0; }

 private:
  std::vector<ReadingFrame> frames_;
  std::vector<Eigen::Vector3d> nominal_point_w_;
};

class ProbedContacts final : public EquationBase<ProbedContacts> {
 public:
  explicit ProbedContacts(const SetupContext& context) : nominal_point_w_(context.nominal_point_w) {
    const Setup& setup = context.setup;
    const double radius = nominal_radius(context);
    const std::vector<ReadingFrame> frames = reading_frames(context);
    Eigen::Vector3d guess_w = Eigen::Vector3d::Zero();
    for (std::size_t row = 0; row < frames.size(); ++row) {
      const auto given = [&](std::size_t first) {
        const auto& all = setup.readings.given;
        return Eigen::Vector3d(all[first][row], all[first + 1][row], all[first + 2][row]);
      };
      const Eigen::Vector3d normal = given(3);
      if (std::abs(normal.norm() - 1.0) > kUnitNormal) {
        throw InputError({setup.data, static_cast<int>(setup.readings.source_line[row])},
                         "n_x, n_y, n_z have the length " + std::to_string(normal.norm()),
                         normal.norm() > 0.0
                             ? "a normal has the length 1: divide n_x, n_y and n_z of every contact by their "
                               "length, the root of the sum of their squares"
                             : "give the direction out of the sphere at the contact, as n_x = 1, n_y = 0, "
                               "n_z = 0 on its +X side");
      }
      normal_w_.emplace_back(frames[row].rotation.transpose() * normal);
      shift_.push_back(normal_w_.back().dot(frames[row].origin_w));
      guess_w += frames[row].rotation.transpose() * (given(0) - radius * normal) + frames[row].origin_w;
    }
    guess_w /= static_cast<double>(frames.size());
    add_nuisance(point_nuisance(sphere_name(setup), guess_w, 0.0));
    radius_.calibrated = radius;
    if (auto block = radius_nuisance(context)) {
      radius_.parameter = 3;
      add_nuisance(std::move(*block));
    }
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> sphere_w(nuisance[0], nuisance[1], nuisance[2]);
    const Vector3<T> error_w = state.point_w - nominal_point_w_[row].cast<T>();
    predicted[0] = normal_w_[row].cast<T>().dot(sphere_w - error_w) - shift_[row] + radius_.value(nuisance);
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    for (int k = 0; k < kStateSize; ++k) out.d_state[0][k] = k < 3 ? -normal_w_[row][k] : 0.0;
    for (int k = 0; k < 3; ++k) out.d_nuisance[0][k] = normal_w_[row][k];
    if (radius_.is_free()) out.d_nuisance[0][3] = 1.0;
  }

  double noise_length(std::size_t /*row*/, int /*channel*/) const override { return 0.0; }

 private:
  std::vector<Eigen::Vector3d> nominal_point_w_;
  std::vector<Eigen::Vector3d> normal_w_;
  std::vector<double> shift_;  ///< of the frame's origin along the normal
  ContactRadius radius_;
};

class ProbedDiameters final : public EquationBase<ProbedDiameters> {
 public:
  explicit ProbedDiameters(const SetupContext& context) {
    radius_.calibrated = nominal_radius(context);
    if (auto block = radius_nuisance(context)) {
      radius_.parameter = 0;
      add_nuisance(std::move(*block));
    }
  }

  template <class T>
  void equation(std::size_t /*row*/, const ToolState<T>& /*state*/, const T* nuisance, T* predicted) const {
    predicted[0] = 2.0 * radius_.value(nuisance);
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    equation(row, state, nuisance, out.predicted);
    for (int k = 0; k < kStateSize; ++k) out.d_state[0][k] = 0.0;
    if (radius_.is_free()) out.d_nuisance[0][0] = 2.0;
  }

  double noise_length(std::size_t /*row*/, int /*channel*/) const override { return 0.0; }

 private:
  ContactRadius radius_;
};

class ProbedSphere final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kProbedSphereSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    switch (context.setup.readings.column_set) {
      case kContacts:
        return std::make_unique<ProbedContacts>(context);
      case kDiameters:
        return std::make_unique<ProbedDiameters>(context);
      default:
        return std::make_unique<ProbedCentres>(context);
    }
  }
};

}  // namespace

const Instrument& probed_sphere() {
  static const ProbedSphere instrument;
  return instrument;
}

}  // namespace volcal
