#include "volcal/model/effects/effect.h"

#include <cmath>

#include "volcal/model/description/units.h"

namespace volcal {

std::string EffectAmplitude::unit() const { return unit_text(unit_of_key(key).suffix); }
double EffectAmplitude::si_per_unit() const { return unit_of_key(key).si_per_unit; }

void EffectAmplitude::keep(double value, Options& options) const {
  const std::string stem(stem_of_key(key));
  if (element < 0) return options.set(stem, value);
  std::vector<double> all = options.numbers(stem).value_or(std::vector<double>{});
  const auto place = static_cast<std::size_t>(element);
  if (all.size() <= place) all.resize(place + 1, 0.0);
  all[place] = value;
  options.set(stem, std::move(all));
}

std::string EffectShape::unit() const { return unit_text(unit_of_key(key).suffix); }
double EffectShape::si_per_unit() const { return unit_of_key(key).si_per_unit; }

std::string surface_name(const Effect& effect) {
  const std::string& first = effect.amplitudes().front().label;
  return first.substr(0, first.rfind(' '));
}

std::string effect_label(const Effect& effect) {
  return effect.surface() != nullptr ? surface_name(effect) : effect.amplitudes().front().label;
}

Eigen::VectorXd Effect::shape_values() const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(shapes_.size()));
  for (std::size_t i = 0; i < shapes_.size(); ++i) values[static_cast<Eigen::Index>(i)] = shapes_[i].value;
  return values;
}

std::vector<Eigen::VectorXd> Effect::scan(const Campaign& /*campaign*/) const {
  constexpr int kSteps = 16;
  std::vector<Eigen::VectorXd> values = {shape_values()};
  if (shapes_.size() != 1 || !(shapes_[0].scan_max > shapes_[0].scan_min)) return values;
  values.clear();
  const double low = shapes_[0].scan_min, high = shapes_[0].scan_max;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const double value = low > 0.0 ? low * std::pow(high / low, share) : low + share * (high - low);
    values.emplace_back(Eigen::VectorXd::Constant(1, value));
  }
  return values;
}

}  // namespace volcal
