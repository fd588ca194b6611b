#include "volcal/model/effects/effect.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

std::string EffectShape::word() const {
  std::string word(stem_of_key(key));
  std::ranges::replace(word, '_', ' ');
  return word;
}

std::string part_label(const std::string& of, const std::string& part) {
  return part.empty() ? of : of + " " + part;
}

const std::string& common_label(const Effect& effect) {
  const EffectAmplitude& first = effect.amplitudes().front();
  return first.part.empty() ? first.label : first.of;
}

std::string effect_label(const Effect& effect) {
  return effect.surface() != nullptr ? common_label(effect) : effect.amplitudes().front().label;
}

std::vector<EffectTerm> Effect::terms() const {
  if (!terms_.empty()) return terms_;
  std::vector<EffectTerm> terms;
  terms.reserve(amplitudes_.size());
  for (std::size_t k = 0; k < amplitudes_.size(); ++k) terms.push_back({k, amplitudes_[k].target});
  return terms;
}

namespace {

class SingleTerm final : public Effect {
 public:
  SingleTerm(std::shared_ptr<const Effect> whole, const EffectTerm& term, Eigen::Index column)
      : whole_(std::move(whole)), column_(column) {
    name_ = whole_->name();
    amplitudes_ = {whole_->amplitudes()[term.amplitude]};
    amplitudes_.front().target = term.target;
    shapes_ = whole_->shapes();
  }
  void check(const Campaign& campaign, const SourcePlace& place) const override {
    whole_->check(campaign, place);
  }
  Eigen::MatrixXd drivers(const SetupView& view, const Eigen::VectorXd& shape) const override {
    return whole_->drivers(view, shape).col(column_);
  }
  bool changes_with_any_driver() const override { return whole_->changes_with_any_driver(); }
  std::size_t unrecorded(const SetupView& view) const override { return whole_->unrecorded(view); }

 private:
  std::shared_ptr<const Effect> whole_;
  Eigen::Index column_;
};

}  // namespace

std::vector<std::shared_ptr<const Effect>> single_terms(std::shared_ptr<const Effect> effect) {
  const std::vector<EffectTerm> terms = effect->terms();
  if (terms.size() == effect->amplitudes().size()) return {std::move(effect)};
  std::vector<std::shared_ptr<const Effect>> single;
  for (std::size_t k = 0; k < terms.size(); ++k)
    single.push_back(std::make_shared<SingleTerm>(effect, terms[k], static_cast<Eigen::Index>(k)));
  return single;
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
