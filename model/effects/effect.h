#pragma once
/// Effects beyond the rigid body: amplitude x driver, added to what the effect acts on. An effect has a
/// target (an error motion, the tool's offset, a station, the floor, the reading itself), a driver (axis
/// position, direction of approach, time, temperature, tool ...) and a shape (step, linear, periodic ...),
/// which may have parameters of its own (period, time constant). A new effect is one file (a kind with its
/// schema) and one line in registry.cpp.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/description/schema.h"
#include "volcal/model/description/symbols.h"
#include "volcal/model/effects/effect_name.h"

namespace volcal {

class KeptHistories;
class TensorBasis;

enum class TargetKind { Motion, ToolOffset, Station, Floor, Reading };

/// What an amplitude is added to: an error motion (m, rad), the tool's offset in tool coordinates (m), the
/// station's position in workpiece coordinates (m), the rotation of the machine against the floor about the
/// middle of its travel (rad, about workpiece axes; for instruments on the floor), a channel of the reading
/// (m, rad).
struct EffectTarget {
  TargetKind kind = TargetKind::Motion;
  ErrorSymbol symbol;  ///< of Motion
  int component = 0;   ///< ToolOffset, Station, Floor: 0..2 = x, y, z; Reading: the channel
};

/// One unknown amplitude: adds amplitude x driver to the target, and to the others of Effect::terms().
struct EffectAmplitude {
  std::string label;  ///< unique in a model: "reversal EXX"
  EffectTarget target;
  std::string key;     ///< schema key of its value, with unit: "amplitude_um_per_K"
  double guess = 0.0;  ///< SI; the value of an identified model, else 0
  int element = -1;    ///< of the list that the key holds; -1: the key holds a number
  /// Of one of several amplitudes of an effect, what they describe together ("lead error EXX") and which it
  /// is
  /// ("cos", "x", "P2"); `part` is empty where there is one alone.
  std::string of = {};
  std::string part = {};

  std::string unit() const;  ///< edge unit: "um/K"
  double si_per_unit() const;
  /// Keeps a value, SI, where the amplitude is read from.
  void keep(double value, Options& options) const;
};

/// Label of a part of what several amplitudes describe: "lead error EXX cos".
std::string part_label(const std::string& of, const std::string& part);

/// One of the places where an amplitude acts, with a driver of its own.
struct EffectTerm {
  std::size_t amplitude = 0;  ///< number among the effect's
  EffectTarget target;
};

/// A parameter of the shape, on which the driver depends nonlinearly.
struct EffectShape {
  std::string label;      ///< unique in a model: "lead error EXX: period"
  std::string key;        ///< "period_mm"
  double value = 0.0;     ///< SI
  double sigma = 0.0;     ///< SI, standard uncertainty before the fit; 0 = exact, not estimated
  double scan_min = 0.0;  ///< SI, range in which it is looked for; min = max: never scanned
  double scan_max = 0.0;

  std::string unit() const;
  double si_per_unit() const;
  /// As sentences call it: "time constant".
  std::string word() const;
};

/// A setup as effects see it.
struct SetupView {
  const Campaign& campaign;
  const Setup& setup;
  std::vector<Eigen::Vector3d> nominal_point_w;  ///< per row, m
  Eigen::VectorXd
      length;  ///< per row, m: length that scales the noise of channel 0; empty: nothing is measured
  /// s, time of the first reading, from which growth and drift count; absent: of `campaign`.
  std::optional<double> clock_start = {};
  bool is_path = true;  ///< the rows were read one after another; false: poses that have no order
  /// What lagged_excess() has found for these rows, kept for the next effect that asks; null: nothing is
  /// kept.
  std::shared_ptr<KeptHistories> histories = {};

  std::size_t rows() const { return setup.readings.size(); }
};

/// One effect with its keys' values. Immutable, so thread-safe.
class Effect {
 public:
  virtual ~Effect() = default;
  const EffectName& name() const { return name_; }
  const std::vector<EffectAmplitude>& amplitudes() const { return amplitudes_; }
  const std::vector<EffectShape>& shapes() const { return shapes_; }
  /// Where the amplitudes act, those of one amplitude together and in the order of the amplitudes: as a rule
  /// one term each, several where one cause acts in several places.
  std::vector<EffectTerm> terms() const;
  /// Values of the shape's parameters, in the order of shapes().
  Eigen::VectorXd shape_values() const;

  /// Throws InputError when the machine or the campaign lacks what the effect is about: an axis, a tool, a
  /// station, a column without which it makes no sense.
  virtual void check(const Campaign& campaign, const SourcePlace& place) const = 0;
  /// Drivers of all readings of a setup, rows x terms; 0 where the effect does not act or its driver was
  /// not recorded. `shape`: values of the shape's parameters, SI.
  virtual Eigen::MatrixXd drivers(const SetupView& view, const Eigen::VectorXd& shape) const = 0;
  /// Values of the shape's parameters at which an unknown shape is looked for; one entry, the given shape,
  /// when nothing is to be looked for. Neighbours are near enough not to miss what lies between.
  virtual std::vector<Eigen::VectorXd> scan(const Campaign& campaign) const;
  /// Set where the amplitudes are the coefficients of one function of its drivers: a prior ties them together
  /// (identify/solve/priors/surface_prior.h), and none of them means anything alone.
  virtual const TensorBasis* surface() const { return nullptr; }
  /// What drivers() has lost where a function of recorded variables fades out beyond the readings it was
  /// drawn from: drivers with its last value held, less drivers(). Empty where none of the readings is
  /// beyond.
  virtual Eigen::MatrixXd faded_drivers(const SetupView& /*view*/) const { return {}; }
  /// Whether its driver is an expression of what EffectName::driver lists: it changes where any of that does.
  virtual bool changes_with_any_driver() const { return false; }
  /// Readings of a setup on which the effect acts, but whose driver was not recorded.
  virtual std::size_t unrecorded(const SetupView& /*view*/) const { return 0; }

 protected:
  EffectName name_;
  std::vector<EffectAmplitude> amplitudes_;
  std::vector<EffectShape> shapes_;
  std::vector<EffectTerm> terms_;  ///< empty: every amplitude acts on its own target alone
};

/// Every term as an effect of its own, with the same amplitudes' labels and the same shapes: what a term does
/// alone. An effect whose amplitudes act on one target each stays as it is.
std::vector<std::shared_ptr<const Effect>> single_terms(std::shared_ptr<const Effect> effect);

/// What all amplitudes of an effect describe together: "surface EAY by y z", "lead error EXX", "reversal
/// EXX".
const std::string& common_label(const Effect& effect);
/// That of a surface, else the label of the first amplitude.
std::string effect_label(const Effect& effect);

class EffectKind {
 public:
  virtual ~EffectKind() = default;
  virtual const EffectSchema& schema() const = 0;
  /// Throws InputError naming file and line of the effect in the model file.
  virtual std::unique_ptr<Effect> make(const EffectSpec& spec, const std::string& model_file) const = 0;
  /// Whether the spec leaves open what the readings are to tell, as the range of a driver.
  virtual bool is_open(const EffectSpec& /*spec*/) const { return false; }
  /// With that. Throws InputError where they do not tell.
  virtual EffectSpec resolved(const EffectSpec& spec, const std::vector<SetupView>& /*views*/,
                              const std::string& /*model_file*/) const {
    return spec;
  }
  /// Every effect of this kind that could act in the campaign, amplitudes unknown: what a diagnosis tests.
  virtual std::vector<EffectSpec> candidates(const Campaign& campaign) const = 0;
  /// Effects to show and to try the kind on; other than the candidates for a kind that nobody can guess.
  virtual std::vector<EffectSpec> examples(const Campaign& campaign) const { return candidates(campaign); }
};

}  // namespace volcal
