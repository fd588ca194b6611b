#include "volcal/model/effects/effect.h"

#include "volcal/model/description/units.h"

namespace volcal {

std::string EffectAmplitude::unit() const { return unit_text(unit_of_key(key).suffix); }
double EffectAmplitude::si_per_unit() const { return unit_of_key(key).si_per_unit; }

std::string EffectShape::unit() const { return unit_text(unit_of_key(key).suffix); }
double EffectShape::si_per_unit() const { return unit_of_key(key).si_per_unit; }

Eigen::VectorXd Effect::shape_values() const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(shapes_.size()));
  for (std::size_t i = 0; i < shapes_.size(); ++i) values[static_cast<Eigen::Index>(i)] = shapes_[i].value;
  return values;
}

}  // namespace volcal
