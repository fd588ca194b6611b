#pragma once
/// Effects beyond the rigid body: unknown amplitudes times known drivers, acting on error motions.
/// A new effect is one file (a kind with its schema) and one line in registry.cpp.

#include <memory>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/description/schema.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

/// One unknown amplitude: adds amplitude x driver to the error motion `target`.
struct EffectAmplitude {
  std::string label;  ///< "reversal EXX"
  ErrorSymbol target;
  std::string unit;  ///< edge unit of the amplitude: "um", "urad", "um/m/K"
  double si_per_unit = 1.0;
  std::string option;        ///< stem of the schema's key that holds the value of an identified model
  double guess = 0.0;        ///< SI; the value of an identified model, else 0
  double prior_mean = 0.0;   ///< SI
  double prior_sigma = 0.0;  ///< SI; 0 = no prior
};

/// An effect applied to a machine. Thread-safe after construction.
class BoundEffect {
 public:
  virtual ~BoundEffect() = default;
  const std::vector<EffectAmplitude>& amplitudes() const { return amplitudes_; }
  /// Driver of every amplitude at a reading of a setup.
  virtual void drivers(const Setup& setup, std::size_t row, double* driver) const = 0;

 protected:
  std::vector<EffectAmplitude> amplitudes_;
};

class EffectKind {
 public:
  virtual ~EffectKind() = default;
  virtual const EffectSchema& schema() const = 0;
  /// Throws InputError naming file and line of the effect in the model file.
  virtual std::unique_ptr<BoundEffect> bind(const EffectSpec& spec, const std::string& model_file,
                                            const Machine& machine) const = 0;
  /// Whether the driver varies in the campaign; without variation the amplitude cannot be told from a
  /// constant. Throws InputError when the campaign lacks a column without which the effect makes no sense.
  virtual bool visible_in(const EffectSpec& spec, const Campaign& campaign) const = 0;
};

}  // namespace volcal
