#pragma once
/// Effects as a schema and three functions: what most kinds need. A kind's file defines the functions and
/// hands them to a FormulaKind.

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "volcal/model/effects/effect_keys.h"

namespace volcal {

/// An effect whose driver is a formula.
class FormulaEffect final : public Effect {
 public:
  using Formula = std::function<Eigen::MatrixXd(const SetupView& view, const Eigen::VectorXd& shape)>;
  using Check = std::function<void(const Campaign& campaign, const SourcePlace& place)>;
  using Scan = std::function<std::vector<Eigen::VectorXd>(const Campaign& campaign)>;
  using Count = std::function<std::size_t(const SetupView& view)>;

  FormulaEffect(EffectName name, std::vector<EffectAmplitude> amplitudes, Formula formula, Check check)
      : formula_(std::move(formula)), check_(std::move(check)) {
    name_ = std::move(name);
    amplitudes_ = std::move(amplitudes);
  }
  /// The only amplitude acts on all of these targets; the formula has a column for each.
  void act_on(const std::vector<EffectTarget>& targets) {
    terms_.clear();
    for (const EffectTarget& target : targets) terms_.push_back({0, target});
  }
  /// The formula has a column for each, those of one amplitude together.
  void act_on(std::vector<EffectTerm> terms) { terms_ = std::move(terms); }
  void add_shape(EffectShape shape) { shapes_.push_back(std::move(shape)); }
  void count_unrecorded(Count count) { unrecorded_ = std::move(count); }
  void scan_by(Scan scan) { scan_ = std::move(scan); }
  void be_expression() { expression_ = true; }

  void check(const Campaign& campaign, const SourcePlace& place) const override { check_(campaign, place); }
  Eigen::MatrixXd drivers(const SetupView& view, const Eigen::VectorXd& shape) const override {
    return formula_(view, shape);
  }
  bool changes_with_any_driver() const override { return expression_; }
  std::size_t unrecorded(const SetupView& view) const override { return unrecorded_ ? unrecorded_(view) : 0; }
  std::vector<Eigen::VectorXd> scan(const Campaign& campaign) const override {
    return scan_ ? scan_(campaign) : Effect::scan(campaign);
  }

 private:
  Scan scan_;
  Formula formula_;
  Check check_;
  Count unrecorded_;
  bool expression_ = false;
};

class FormulaKind final : public EffectKind {
 public:
  using Make = std::unique_ptr<FormulaEffect> (*)(const EffectTable& table);
  using Candidates = std::vector<EffectSpec> (*)(const Campaign& campaign);

  /// `example_finder` is given for a kind without candidates.
  FormulaKind(EffectSchema schema, Make maker, Candidates finder, Candidates example_finder = nullptr)
      : schema_(std::move(schema)), make_(maker), candidates_(finder), examples_(example_finder) {}
  const EffectSchema& schema() const override { return schema_; }
  std::unique_ptr<Effect> make(const EffectSpec& spec, const std::string& model_file) const override {
    return make_(EffectTable(spec, model_file));
  }
  std::vector<EffectSpec> candidates(const Campaign& campaign) const override {
    return candidates_(campaign);
  }
  std::vector<EffectSpec> examples(const Campaign& campaign) const override {
    return examples_ != nullptr ? examples_(campaign) : candidates_(campaign);
  }

 private:
  EffectSchema schema_;
  Make make_;
  Candidates candidates_;
  Candidates examples_;
};

/// Unrecorded when the setup has no times, or no such temperature channel.
FormulaEffect::Count without_time();
FormulaEffect::Count without_channel(const std::string& channel);

/// An amplitude of an error motion: key "amplitude_um_<per>" or "amplitude_urad_<per>"; of one of several,
/// `part` in the place of "amplitude".
EffectAmplitude motion_amplitude(const EffectTable& table, const std::string& of, ErrorSymbol symbol,
                                 const std::string& per, const std::string& part = {});
/// Amplitudes along x, y, z of a tool's offset or a station: keys "x_<unit>", "y_<unit>", "z_<unit>".
std::vector<EffectAmplitude> vector_amplitudes(const EffectTable& table, const std::string& of,
                                               TargetKind kind, const std::string& unit);
std::vector<KeySchema> vector_amplitude_keys(const std::string& unit, const std::string& help);
/// An amplitude of a channel of the reading.
EffectAmplitude reading_amplitude(const EffectTable& table, const std::string& of, const std::string& key,
                                  int channel = 0, const std::string& part = {});
/// A parameter of the shape, from keys "<stem>_<unit>" and "<stem>_sigma_<unit>"; the range is where it is
/// looked for when it is unknown.
EffectShape shape_parameter(const EffectTable& table, const std::string& label, const std::string& stem,
                            const std::string& unit, double otherwise, double scan_min, double scan_max);
std::vector<KeySchema> shape_keys(const std::string& stem, const std::string& unit, const std::string& help);

KeySchema text_key(const std::string& key, const std::string& help, bool required = true);
KeySchema axis_key(const std::string& key, const std::string& help);

}  // namespace volcal
