#include <utility>

#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

std::string body_of(const Options& options) { return options.text("body").value_or("relative"); }

const InstrumentSchema kAngleSchema = {
    .name = "angle",
    .summary = "Electronic level or angular interferometer: rotation about one axis.",
    .equation = "angle = O.axis + offset",
    .source = "ISO 230-1, angular error motions; ISO/TR 16907, 7.5",
    .keys = {{.key = "axis",
              .type = KeyType::Vector3,
              .required = true,
              .help = "axis of the rotation read, workpiece coordinates"},
             {.key = "body",
              .type = KeyType::Text,
              .help = "relative: tool against workpiece; tool or table: a level on that body "
                      "(on the table it reads minus a workpiece-side error)",
              .choices = {"relative", "tool", "table"}}},
    .column_sets = {{{.column = "angle_urad", .help = "angle", .plausible_max = 1e6}}},
    .noise_keys = {{.key = "constant_urad", .help = "standard deviation", .plausible_max = 1e3}},
    .traits = {.line_reading = LineReading::Rotation,
               .stands_on_floor = [](const Options& options) { return body_of(options) != "relative"; }}};

class AngleSetup final : public EquationBase<AngleSetup> {
 public:
  explicit AngleSetup(const SetupContext& context) {
    const Setup& setup = context.setup;
    const Eigen::Vector3d axis_w = unit_direction(context, "axis");
    const std::string body = body_of(setup.options);
    if (body != "table") tool_side_w_ = axis_w;
    if (body == "relative") workpiece_side_w_ = axis_w;
    if (body == "table") workpiece_side_w_ = -axis_w;
    add_nuisance(scalar_nuisance(setup.name + ": offset", setup.readings.value[0].front(), 0.0, true));
  }

  template <class T>
  void equation(std::size_t /*row*/, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    predicted[0] = state.rotation_tool_side.dot(tool_side_w_.cast<T>()) +
                   state.rotation_workpiece_side.dot(workpiece_side_w_.cast<T>()) + nuisance[0];
  }

  void linearize(std::size_t /*row*/, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    out.predicted[0] = tool_side_w_.dot(state.rotation_tool_side) +
                       workpiece_side_w_.dot(state.rotation_workpiece_side) + nuisance[0];
    for (int k = 0; k < 3; ++k) {
      out.d_state[0][k] = 0.0;
      out.d_state[0][3 + k] = tool_side_w_[k];
      out.d_state[0][6 + k] = workpiece_side_w_[k];
    }
    out.d_nuisance[0][0] = 1.0;
  }

  bool sees_rotation() const override { return true; }

  double noise_length(std::size_t /*row*/, int /*channel*/) const override { return 0.0; }

 private:
  Eigen::Vector3d tool_side_w_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d workpiece_side_w_ = Eigen::Vector3d::Zero();
};

class Angle final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kAngleSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<AngleSetup>(context);
  }
};

}  // namespace

const Instrument& angle() {
  static const Angle instrument;
  return instrument;
}

}  // namespace volcal
