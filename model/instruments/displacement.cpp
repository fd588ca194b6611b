#include <algorithm>
#include <map>
#include <utility>

#include "volcal/model/instruments/nuisance.h"

namespace volcal {
namespace {

constexpr std::size_t kDeviationColumns = 1;

const InstrumentSchema kDisplacementSchema = {
    .name = "displacement",
    .summary =
        "Linear displacement along a fixed direction: axis lines, body and face diagonals, step diagonals.",
    .equation = "displacement = u.(P - P_first) (1 + scale) + offset",
    .source = "ISO 230-2 (lines), ISO 230-6 (diagonals); ISO/TR 16907, 7.5",
    .keys =
        [] {
          std::vector<KeySchema> keys = {
              {.key = "direction",
               .type = KeyType::Vector3,
               .help = "beam direction, workpiece coordinates; default: first to last commanded point"},
              {.key = "offset_per",
               .type = KeyType::Text,
               .help = "one free offset per setup or per line",
               .choices = {"setup", "line"}}};
          for (const KeySchema& key : length_scale_keys()) keys.push_back(key);
          return keys;
        }(),
    .column_sets =
        {{{.column = "displacement_mm", .help = "displacement along the beam", .plausible_max = 1e5}},
         {{.column = "deviation_um",
           .help = "displacement minus commanded displacement along the beam",
           .plausible_max = 1e5}}},
    .noise_keys = length_noise_keys(),
    .traits = {.laser_length = LaserLength::Displacement,
               .line_reading = LineReading::Along,
               .length_from_zero = true}};

class DisplacementSetup final : public EquationBase<DisplacementSetup> {
 public:
  explicit DisplacementSetup(SetupContext context) : nominal_point_w_(std::move(context.nominal_point_w)) {
    const Setup& setup = context.setup;
    if (setup.options.has("direction")) {
      beam_w_ = unit_direction(context, "direction");
    } else if (const auto line = line_direction(nominal_point_w_)) {
      beam_w_ = *line;
    } else {
      context.fail("all commanded points coincide, so the beam direction is unknown",
                   "give direction = [x, y, z]");
    }
    reading_is_deviation_ = setup.readings.column_set == kDeviationColumns;
    add_offsets(setup);
    if (auto scale = length_scale_nuisance(setup)) {
      scale_index_ = static_cast<int>(nuisance()[0].size());
      add_nuisance(std::move(*scale));
    }
    set_local_nuisance_size(scale_index_ < 0 ? 1 : 2);
  }

  void local_nuisance(std::size_t row, int* index) const override {
    index[0] = offset_of_row_.empty() ? 0 : offset_of_row_[row];
    if (scale_index_ >= 0) index[1] = scale_index_;
  }

  template <class T>
  void equation(std::size_t row, const ToolState<T>& state, const T* nuisance, T* predicted) const {
    const Vector3<T> path_w = state.point_w - nominal_point_w_.front().cast<T>();
    T along = path_w.dot(beam_w_.cast<T>());
    if (scale_index_ >= 0) along = along * (1.0 + nuisance[1]);
    predicted[0] = along + nuisance[0] - commanded(row);
  }

  void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                 Linearization& out) const override {
    const double along = beam_w_.dot(state.point_w - nominal_point_w_.front());
    const double scale = scale_index_ >= 0 ? 1.0 + nuisance[1] : 1.0;
    out.predicted[0] = along * scale + nuisance[0] - commanded(row);
    for (int k = 0; k < 3; ++k) {
      out.d_state[0][k] = beam_w_[k] * scale;
      out.d_state[0][3 + k] = out.d_state[0][6 + k] = 0.0;
    }
    out.d_nuisance[0][0] = 1.0;
    out.d_nuisance[0][1] = along;
  }

  double noise_length(std::size_t row, int /*channel*/) const override {
    return std::abs(beam_w_.dot(nominal_point_w_[row] - nominal_point_w_.front()));
  }

 private:
  /// Commanded displacement that a deviation reading has had taken off.
  double commanded(std::size_t row) const {
    return reading_is_deviation_ ? beam_w_.dot(nominal_point_w_[row] - nominal_point_w_.front()) : 0.0;
  }

  void add_offsets(const Setup& setup) {
    const bool per_line =
        setup.options.text("offset_per").value_or("setup") == "line" && !setup.readings.line.empty();
    if (!per_line) {
      add_nuisance(scalar_nuisance(setup.name + ": offset", mean_offset(setup)));
      return;
    }
    std::map<std::int32_t, int> order;
    for (const std::int32_t line : setup.readings.line) {
      order.try_emplace(line, static_cast<int>(order.size()));
    }
    for (const std::int32_t line : setup.readings.line) offset_of_row_.push_back(order.at(line));
    NuisanceBlock block;
    block.name = setup.name + ": offset";
    block.labels.resize(order.size());
    for (const auto& [line, index] : order) block.labels[index] = "line " + std::to_string(line);
    block.is_angle.assign(order.size(), false);
    block.guess = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(order.size()), mean_offset(setup));
    block.prior_mean = block.guess;
    block.prior_sigma = Eigen::VectorXd::Zero(block.guess.size());
    add_nuisance(std::move(block));
  }

  double mean_offset(const Setup& setup) const {
    double sum = 0.0;
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const double along = beam_w_.dot(nominal_point_w_[row] - nominal_point_w_.front());
      sum += setup.readings.value[0][row] - along + commanded(row);
    }
    return sum / static_cast<double>(setup.readings.size());
  }

  std::vector<Eigen::Vector3d> nominal_point_w_;
  Eigen::Vector3d beam_w_ = Eigen::Vector3d::Zero();
  bool reading_is_deviation_ = false;
  std::vector<int> offset_of_row_;
  int scale_index_ = -1;
};

class Displacement final : public Instrument {
 public:
  const InstrumentSchema& schema() const override { return kDisplacementSchema; }
  std::unique_ptr<BoundSetup> bind(SetupContext context) const override {
    return std::make_unique<DisplacementSetup>(std::move(context));
  }
};

}  // namespace

const Instrument& displacement() {
  static const Displacement instrument;
  return instrument;
}

}  // namespace volcal
