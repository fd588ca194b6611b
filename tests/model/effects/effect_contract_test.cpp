// What every registered effect must keep.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/schema_keys.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using testing_support::five_axis_effect_campaign;

struct Candidate {
  const EffectKind* kind;
  EffectSpec spec;
  std::unique_ptr<Effect> effect;
};

std::vector<Candidate> candidates_of(const Campaign& campaign) {
  std::vector<Candidate> all;
  for (const EffectKind* kind : effect_kinds()) {
    for (EffectSpec& spec : kind->examples(campaign)) {
      all.push_back({kind, spec, kind->make(spec, "model.toml")});
    }
  }
  return all;
}

ModelSpec model_without_functions() {
  ModelSpec model;
  model.default_function.basis = "zero";
  return model;
}

class EffectContract : public ::testing::Test {
 protected:
  Campaign campaign_ = five_axis_effect_campaign();
  std::vector<Candidate> candidates_ = candidates_of(campaign_);
};

TEST_F(EffectContract, KindsDescribeThemselves) {
  std::set<std::string> kinds;
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSchema& schema = kind->schema();
    EXPECT_FALSE(schema.kind.empty());
    EXPECT_FALSE(schema.summary.empty()) << schema.kind;
    EXPECT_FALSE(schema.source.empty()) << schema.kind;
    EXPECT_TRUE(kinds.insert(schema.kind).second) << schema.kind << " is registered twice";
    EXPECT_EQ(find_effect(schema.kind), kind);
    std::set<std::string> keys;
    for (const KeySchema& key : schema.keys) {
      EXPECT_TRUE(keys.insert(key.key).second) << schema.kind << ": key " << key.key << " twice";
      EXPECT_FALSE(key.help.empty()) << schema.kind << ": " << key.key;
      EXPECT_LT(key.plausible_min, key.plausible_max) << schema.kind << ": " << key.key;
    }
  }
  EXPECT_EQ(find_effect("gremlins"), nullptr);
  EXPECT_TRUE(kinds.contains("reversal"));
}

TEST_F(EffectContract, CandidatesHaveNamesUnitsAndKeys) {
  std::set<std::string> labels;
  std::set<EffectName> names;
  std::set<std::string> kinds;
  for (const auto& [kind, spec, effect] : candidates_) {
    kinds.insert(spec.kind);
    EXPECT_EQ(effect->name().kind, kind->schema().kind);
    EXPECT_FALSE(effect->name().target.empty()) << spec.kind;
    EXPECT_FALSE(effect->name().driver.empty()) << spec.kind;
    EXPECT_FALSE(effect->name().shape.empty()) << spec.kind;
    EXPECT_TRUE(names.insert(effect->name()).second) << spec.kind << " " << effect->name().target.name();
    ASSERT_FALSE(effect->amplitudes().empty()) << spec.kind;
    for (const EffectAmplitude& amplitude : effect->amplitudes()) {
      EXPECT_TRUE(labels.insert(amplitude.label).second) << amplitude.label << " twice";
      EXPECT_TRUE(testing_support::has_key(kind->schema(), amplitude.key))
          << amplitude.label << ": " << amplitude.key;
      EXPECT_FALSE(amplitude.unit().empty()) << amplitude.label;
      EXPECT_EQ(amplitude.guess, 0.0) << amplitude.label;
      if (amplitude.target.kind != TargetKind::Motion) {
        EXPECT_GE(amplitude.target.component, 0) << amplitude.label;
        EXPECT_LT(amplitude.target.component, 3) << amplitude.label;
      }
    }
    for (const EffectShape& shape : effect->shapes()) {
      EXPECT_TRUE(labels.insert(shape.label).second) << shape.label << " twice";
      EXPECT_TRUE(testing_support::has_key(kind->schema(), shape.key)) << shape.label << ": " << shape.key;
      EXPECT_LE(shape.scan_min, shape.scan_max) << shape.label;
      EXPECT_TRUE(std::isfinite(shape.value)) << shape.label;
    }
  }
  EXPECT_EQ(kinds.size(), effect_kinds().size())
      << "a kind has no candidate in a campaign that has everything";
}

/// Every amplitude acts somewhere, first where it says; those of one stand together.
TEST_F(EffectContract, TermsAreThoseOfTheAmplitudesInTheirOrder) {
  for (const auto& [kind, spec, effect] : candidates_) {
    const std::vector<EffectTerm> terms = effect->terms();
    EXPECT_TRUE(std::ranges::is_sorted(terms, {}, &EffectTerm::amplitude)) << spec.kind;
    for (std::size_t k = 0; k < effect->amplitudes().size(); ++k) {
      const auto first = std::ranges::find(terms, k, &EffectTerm::amplitude);
      ASSERT_NE(first, terms.end()) << spec.kind;
      EXPECT_EQ(first->target.kind, effect->amplitudes()[k].target.kind) << spec.kind;
      EXPECT_EQ(first->target.symbol, effect->amplitudes()[k].target.symbol) << spec.kind;
    }
  }
}

/// Identified values can be written into the effect's table and are read from it again.
TEST_F(EffectContract, IdentifiedValuesSurviveInTheOptions) {
  for (const auto& [kind, spec, effect] : candidates_) {
    EffectSpec identified = spec;
    for (const EffectAmplitude& amplitude : effect->amplitudes()) {
      amplitude.keep(3.0 * amplitude.si_per_unit(), identified.options);
    }
    for (const EffectShape& shape : effect->shapes()) {
      identified.options.set(std::string(stem_of_key(shape.key)), 1.1 * shape.value);
    }
    const auto again = kind->make(identified, "model.toml");
    EXPECT_EQ(again->name(), effect->name());
    for (const EffectAmplitude& amplitude : again->amplitudes()) {
      EXPECT_EQ(amplitude.guess, 3.0 * amplitude.si_per_unit()) << amplitude.label;
    }
    for (std::size_t i = 0; i < again->shapes().size(); ++i) {
      EXPECT_EQ(again->shapes()[i].value, 1.1 * effect->shapes()[i].value) << again->shapes()[i].label;
    }
  }
}

TEST_F(EffectContract, DriversAreFiniteRepeatableAndNotNothing) {
  const MeasurementModel model(campaign_, model_without_functions());
  const std::vector<SetupView> views = setup_views(campaign_, model.binding(), model.chain());
  for (const auto& [kind, spec, effect] : candidates_) {
    EXPECT_NO_THROW(effect->check(campaign_, {"model.toml", 1})) << effect->amplitudes()[0].label;
    double squares = 0.0;
    for (const SetupView& view : views) {
      const Eigen::MatrixXd once = effect->drivers(view, effect->shape_values());
      ASSERT_EQ(once.rows(), static_cast<Eigen::Index>(view.rows())) << effect->amplitudes()[0].label;
      ASSERT_EQ(once.cols(), static_cast<Eigen::Index>(effect->terms().size()));
      EXPECT_TRUE(once.allFinite()) << effect->amplitudes()[0].label;
      EXPECT_EQ(once, effect->drivers(view, effect->shape_values())) << effect->amplitudes()[0].label;
      EXPECT_LE(effect->unrecorded(view), view.rows());
      squares += once.squaredNorm();
    }
    EXPECT_GT(squares, 0.0) << effect->amplitudes()[0].label;
  }
}

/// Fifth differences over the readings of a setup whose positions are moved along one linear axis in equal
/// steps, all else held: 0 for a polynomial of fourth degree, so for a cubic.
TEST_F(EffectContract, DeclaredPolynomialsAreSo) {
  constexpr std::size_t kSteps = 6;
  constexpr double kBinomial[kSteps] = {-1, 5, -10, 10, -5, 1};
  const MeasurementModel model(campaign_, model_without_functions());
  const std::vector<SetupView> views = setup_views(campaign_, model.binding(), model.chain());
  std::set<std::string> declared, curved;
  for (const auto& [kind, spec, effect] : candidates_) {
    if (effect->amplitudes()[0].target.kind != TargetKind::Motion) continue;
    bool is_curved = false;
    for (const Axis& axis : campaign_.machine.axes) {
      if (is_rotary(axis.name)) continue;
      Campaign moved = campaign_;
      std::vector<Eigen::MatrixXd> steps;
      double largest = 0.0;
      for (std::size_t step = 0; step < kSteps; ++step) {
        Readings& readings = moved.setups[0].readings;
        readings = campaign_.setups[0].readings;
        for (double& position : readings.position[index_of(axis.name)])
          position = axis.travel_min + (0.1 + 0.137 * static_cast<double>(step)) * axis.travel();
        SetupView view{moved,           moved.setups[0],      views[0].nominal_point_w,
                       views[0].length, views[0].clock_start, views[0].is_path};
        steps.push_back(effect->drivers(view, effect->shape_values()));
        largest = std::max(largest, steps.back().cwiseAbs().maxCoeff());
      }
      Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(steps[0].rows(), steps[0].cols());
      for (std::size_t step = 0; step < kSteps; ++step) difference += kBinomial[step] * steps[step];
      is_curved = is_curved || difference.cwiseAbs().maxCoeff() > 1e-9 * largest;
    }
    if (is_curved) curved.insert(spec.kind);
    if (kind->schema().polynomial) {
      EXPECT_FALSE(is_curved) << effect->amplitudes()[0].label;
      declared.insert(spec.kind);
    }
  }
  EXPECT_GE(declared.size(), 10U);
  EXPECT_TRUE(curved.contains("lead-error")) << "the test sees no wave";
}

/// Prediction and derivatives of a model with the effect, against differences of the prediction.
TEST_F(EffectContract, DerivativesAreThoseOfThePrediction) {
  for (const auto& [kind, spec, effect] : candidates_) {
    ModelSpec spec_with = model_without_functions();
    spec_with.effects.push_back(spec);
    EffectSpec& added = spec_with.effects.back();
    for (const EffectAmplitude& amplitude : effect->amplitudes()) {
      amplitude.keep(5.0 * amplitude.si_per_unit(), added.options);
    }
    const MeasurementModel model(campaign_, spec_with);
    const Eigen::VectorXd at = model.initial_parameters();
    RowJacobian row;
    for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
      model.linearize(setup, 7, at, row);
      for (const ParameterBlock& block : model.layout().blocks) {
        if (block.kind != ParameterKind::Effect && block.kind != ParameterKind::EffectShape) continue;
        Eigen::VectorXd above = at, below = at;
        const double step =
            block.kind == ParameterKind::Effect ? 2.0 * block.si_per_unit[0] : 1e-3 * block.prior_sigma[0];
        above[block.offset] += step;
        below[block.offset] -= step;
        double high[kMaxChannels], low[kMaxChannels];
        model.predict(setup, 7, above, high);
        model.predict(setup, 7, below, low);
        for (int channel = 0; channel < row.channels; ++channel) {
          const double expected = (high[channel] - low[channel]) / (2.0 * step);
          const double derivative = dense_row(model.layout(), row, channel)[block.offset];
          EXPECT_NEAR(derivative, expected, 1e-5 * std::abs(expected) + 1e-14 / step)
              << block.name << " in " << campaign_.setups[setup].name;
        }
      }
    }
  }
}

TEST_F(EffectContract, ASpecWithoutItsKeysIsRefusedWithItsPlace) {
  for (const EffectKind* kind : effect_kinds()) {
    if (std::ranges::none_of(kind->schema().keys, &KeySchema::required)) continue;
    EffectSpec empty;
    empty.kind = kind->schema().kind;
    empty.source_line = 12;
    try {
      kind->make(empty, "model.toml");
      ADD_FAILURE() << empty.kind << " accepts a table without its required keys";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().file, "model.toml");
      EXPECT_EQ(error.place().line, 12);
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

}  // namespace
}  // namespace volcal
