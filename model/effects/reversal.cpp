#include <algorithm>

#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

const EffectSchema& reversal_schema() {
  static const EffectSchema schema = {
      .kind = "reversal",
      .summary =
          "an error motion differs by b between the two directions of approach of its own axis; the "
          "error function is the mean, readings of unknown direction get 0",
      .source = "ISO 230-1 and ISO 230-2 (reversal value), as quoted in ISO/TR 16907:2015",
      .keys = joined({{symbol_key("error motion that jumps at reversal: EXX, EYX, ECX ...")},
                      motion_amplitude_keys({""}, "b: value towards + minus value towards -")})};
  return schema;
}

class ReversalEffect final : public Effect {
 public:
  explicit ReversalEffect(const EffectTable& table) : symbol_(table.symbol()) {
    name_ = {"reversal", symbol_.name(), std::string("dir_") + lower_letter_of(symbol_.axis), "step"};
    amplitudes_.push_back({.label = "reversal " + symbol_.name(),
                           .target = {.kind = TargetKind::Motion, .symbol = symbol_},
                           .key = motion_amplitude_key(symbol_, ""),
                           .guess = table.number("amplitude", 0.0)});
  }

  void check(const Campaign& campaign, const SourcePlace& place) const override {
    check_axis(campaign, symbol_.axis, "reversal of " + symbol_.name(), place);
  }

  Eigen::MatrixXd drivers(const SetupView& view, const Eigen::VectorXd& /*shape*/) const override {
    return 0.5 * directions(view, symbol_.axis);
  }

  std::size_t unrecorded(const SetupView& view) const override {
    const auto& direction = view.setup.readings.direction[index_of(symbol_.axis)];
    return direction.empty() ? view.rows()
                             : static_cast<std::size_t>(std::ranges::count(direction, std::int8_t{0}));
  }

 private:
  ErrorSymbol symbol_;
};

class Reversal final : public EffectKind {
 public:
  const EffectSchema& schema() const override { return reversal_schema(); }

  std::unique_ptr<Effect> make(const EffectSpec& spec, const std::string& model_file) const override {
    return std::make_unique<ReversalEffect>(EffectTable(spec, model_file));
  }

  std::vector<EffectSpec> candidates(const Campaign& campaign) const override {
    std::vector<EffectSpec> specs;
    for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
      specs.push_back(effect_spec("reversal", {{"symbol", symbol.name()}}));
    }
    return specs;
  }
};

}  // namespace

const EffectKind& reversal_effect() {
  static const Reversal kind;
  return kind;
}

}  // namespace volcal
