#include <algorithm>
#include <array>
#include <span>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
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
      .keys = {{.key = "symbol",
                .type = KeyType::Text,
                .required = true,
                .help = "error motion that jumps at reversal: EXX, EYX, ECX ..."},
               {.key = "amplitude_um",
                .help = "b of an identified model, displacements: value towards + minus value towards -",
                .plausible_min = 1e-6,
                .plausible_max = 5000.0},
               {.key = "amplitude_urad",
                .help = "b of an identified model, rotations",
                .plausible_min = 1e-6,
                .plausible_max = 5000.0}},
  };
  return schema;
}

ErrorSymbol checked_symbol(const EffectSpec& spec, const std::string& model_file) {
  const SourcePlace place{model_file, spec.source_line};
  const auto text = spec.options.text("symbol");
  if (!text) throw InputError(place, "effect \"reversal\" names no symbol", "add symbol = \"EXX\"");
  const auto symbol = ErrorSymbol::parse(*text);
  if (!symbol) {
    throw InputError(place, "\"" + *text + "\" is no error motion",
                     "write E, the component X Y Z A B C, the moving axis, as in EXX or ECX");
  }
  return *symbol;
}

class BoundReversal final : public BoundEffect {
 public:
  BoundReversal(ErrorSymbol symbol, double amplitude) : axis_(index_of(symbol.axis)) {
    amplitudes_.push_back({.label = "reversal " + symbol.name(),
                           .target = symbol,
                           .unit = std::string(edge_unit(symbol.component)),
                           .si_per_unit = kMetrePerMicrometre,
                           .option = "amplitude",
                           .guess = amplitude});
  }

  void drivers(const Setup& setup, std::size_t row, double* driver) const override {
    const auto& direction = setup.readings.direction[axis_];
    driver[0] = direction.empty() ? 0.0 : 0.5 * direction[row];
  }

 private:
  std::size_t axis_;
};

class Reversal final : public EffectKind {
 public:
  const EffectSchema& schema() const override { return reversal_schema(); }

  std::unique_ptr<BoundEffect> bind(const EffectSpec& spec, const std::string& model_file,
                                    const Machine& machine) const override {
    const ErrorSymbol symbol = checked_symbol(spec, model_file);
    if (!machine.has_axis(symbol.axis)) {
      throw InputError({model_file, spec.source_line},
                       "reversal of " + symbol.name() + ": the machine has no axis " + letter_of(symbol.axis),
                       "name an axis of structure \"" + machine.structure.code + "\" or remove the effect");
    }
    return std::make_unique<BoundReversal>(symbol, spec.options.number("amplitude").value_or(0.0));
  }

  bool visible_in(const EffectSpec& spec, const Campaign& campaign) const override {
    const ErrorSymbol symbol = checked_symbol(spec, {});
    bool plus = false;
    bool minus = false;
    for (const Setup& setup : campaign.setups) {
      for (const std::int8_t direction : setup.readings.direction[index_of(symbol.axis)]) {
        plus = plus || direction > 0;
        minus = minus || direction < 0;
      }
    }
    return plus && minus;
  }
};

}  // namespace

const EffectKind& reversal_effect() {
  static const Reversal kind;
  return kind;
}

}  // namespace volcal
