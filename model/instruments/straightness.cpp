#include <Eigen/Geometry>
#include <utility>

#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

const InstrumentSchema kStraightnessSchema = {
    .name = "straightness",
    .summary =
        "Deviation across a line of motion against a straight reference (straightedge, laser, square).",
    .equation = "deviation = v.(P - P_first) + offset + slope s",
    .source = "ISO 230-1, straightness and squareness; ISO/TR 16907, 7.5",
    .keys =
        {{.key = "direction",
          .type = KeyType::Vector3,
          .required = true,
          .help = "direction v of the deviation, workpiece coordinates"},
         {.key = "reference",
          .type = KeyType::Text,
          .help =
              "name of the artefact: setups that name it share its rotation (a square measures squareness)"}},
    .column_sets = {{{.column = "deviation_um", .help = "deviation along v", .plausible_max = 1e5}}},
    .noise_keys = length_noise_keys(),
    .traits = {.line_reading = LineReading::Across, .length_from_zero = true}};

class StraightnessSetup final : public EquationBase<StraightnessSetup> {
 public:
  explicit StraightnessSetup(SetupContext context) : nominal_point_w_(std::move(context.nominal_point_w)) {
    const Setup& setup = context.setup;
    across_w_ = unit_direction(context, "direction");
    const auto line = line_direction(nominal_point_w_);
    if (!line)
      context.fail("all commanded points coincide", "a straightness setup needs a line of positions");
    line_w_ = *line;
    slope_sign_ = reference_sign();
    add_nuisance(scalar_nuisance(setup.name + ": offset", setup.readings.value[0].front()));
    const auto reference = setup.options.text("reference");
    add_nuisance(scalar_nuisance(reference ? "reference " + *reference + ": slope" : setup.name + ": slope",
                                 0.0, 0.0, true));
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> path_w = state.point_w - nominal_point_w_.front().cast<T>();
    predicted[0] = path_w.dot(across_w_.cast<T>()) + nuisance[0] + nuisance[1] * (slope_sign_ * along(row));
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    const double lever = slope_sign_ * along(row);
    out.predicted[0] =
        across_w_.dot(state.point_w - nominal_point_w_.front()) + nuisance[0] + nuisance[1] * lever;
    for (int k = 0; k < 3; ++k) {
      out.d_state[0][k] = across_w_[k];
      out.d_state[0][3 + k] = out.d_state[0][6 + k] = 0.0;
    }
    out.d_nuisance[0][0] = 1.0;
    out.d_nuisance[0][1] = lever;
  }

  double noise_length(std::size_t row, int /*channel*/) const override { return std::abs(along(row)); }

 private:
  double along(std::size_t row) const {
    return line_w_.dot(nominal_point_w_[row] - nominal_point_w_.front());
  }

  /// The arms of a turned square deviate with opposite signs: the sign of line x v about the axis of the
  /// turn.
  double reference_sign() const {
    const Eigen::Vector3d turn = line_w_.cross(across_w_);
    Eigen::Index largest = 0;
    turn.cwiseAbs().maxCoeff(&largest);
    return turn[largest] < 0.0 ? -1.0 : 1.0;
  }

  std::vector<Eigen::Vector3d> nominal_point_w_;
  Eigen::Vector3d across_w_;
  Eigen::Vector3d line_w_;
  double slope_sign_ = 1.0;
};

class Straightness final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kStraightnessSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<StraightnessSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& straightness() {
  static const Straightness instrument;
  return instrument;
}

}  // namespace volcal
