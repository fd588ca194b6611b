// Effects without a formula, against functions whose coefficients are known.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using testing_support::effect_campaign;

EffectSpec stated(const std::string& target, const std::string& drivers, std::vector<double> from,
                  std::vector<double> to, std::vector<double> pieces) {
  EffectSpec spec = effect_spec("empirical", {{"target", target},
                                              {"drivers", drivers},
                                              {"from", std::move(from)},
                                              {"to", std::move(to)},
                                              {"pieces", std::move(pieces)}});
  spec.source_line = 7;
  return spec;
}

std::unique_ptr<Effect> effect_of(const EffectSpec& spec) {
  return find_effect("empirical")->make(spec, "model.toml");
}

class Empirical : public ::testing::Test {
 protected:
  Empirical() : model_(campaign_, zero_model()) {
    views_ = setup_views(campaign_, model_.binding(), model_.chain());
  }

  static ModelSpec zero_model() {
    ModelSpec model;
    model.default_function.basis = "zero";
    return model;
  }

  /// Of the coefficients of u (share of the first range), constant along a second driver: row sums weighted
  /// with nodes.
  Eigen::VectorXd straight(const Effect& effect, std::size_t setup) const {
    const TensorBasis& basis = *effect.surface();
    const Eigen::MatrixXd rows = effect.drivers(views_[setup], effect.shape_values());
    const Eigen::Index along = basis.size() / basis.size(0);
    Eigen::VectorXd coefficients(basis.size());
    for (Eigen::Index k = 0; k < coefficients.size(); ++k) coefficients[k] = basis.nodes(0)[k / along];
    return rows * coefficients;
  }

  static std::string problem(const std::function<void()>& action) {
    try {
      action();
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().line, 7);
      EXPECT_FALSE(error.remedy().empty());
      return error.problem();
    }
    return "accepted";
  }

  Campaign campaign_ = effect_campaign();
  MeasurementModel model_;
  std::vector<SetupView> views_;
};

TEST_F(Empirical, IsTheFunctionOfItsDrivers) {
  const auto effect = effect_of(stated("EAY", "y T_spindle", {0.0, 15.0}, {500.0, 30.0}, {3, 2}));
  EXPECT_EQ(effect_label(*effect), "surface EAY by y T_spindle");
  EXPECT_EQ(effect->name(), EffectName::of_parts("empirical", "EAY", "y T_spindle", "surface"));
  const Readings& readings = campaign_.setups[1].readings;
  const Eigen::VectorXd values = straight(*effect, 1);
  for (std::size_t row = 0; row < readings.size(); ++row)
    EXPECT_NEAR(values[static_cast<Eigen::Index>(row)], readings.position[1][row] / 0.5, 1e-12);
}

TEST_F(Empirical, AFactorMultipliesIt) {
  EffectSpec spec = stated("EXX", "x", {0.0}, {500.0}, {4});
  spec.options.set("factor", std::string("dir_y"));
  const auto effect = effect_of(spec);
  EXPECT_EQ(effect_label(*effect), "curve EXX by dir_y x");
  const Readings& readings = campaign_.setups[0].readings;
  const Eigen::VectorXd values = straight(*effect, 0);
  for (std::size_t row = 0; row < readings.size(); ++row) {
    EXPECT_NEAR(values[static_cast<Eigen::Index>(row)],
                readings.direction[1][row] * readings.position[0][row] / 0.5, 1e-12);
  }
}

TEST_F(Empirical, ActsOnlyWhereItIsSaidTo) {
  EffectSpec spec = stated("EXX", "x", {0.0}, {500.0}, {4});
  spec.options.set("only", std::string("tool side"));
  const auto effect = effect_of(spec);
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    const bool acts = !effect->drivers(views_[setup], effect->shape_values()).isZero(0.0);
    EXPECT_EQ(acts, campaign_.setups[setup].tool == 1) << campaign_.setups[setup].name;
  }
}

TEST_F(Empirical, IsNothingWhereADriverWasNotRecorded) {
  campaign_.setups[2].readings.temperature.erase("spindle");
  const auto effect = effect_of(stated("EXX", "T_spindle", {15.0}, {30.0}, {4}));
  EXPECT_TRUE(effect->drivers(views_[2], effect->shape_values()).isZero(0.0));
  EXPECT_EQ(effect->unrecorded(views_[2]), testing_support::kEffectRows);
  EXPECT_EQ(effect->unrecorded(views_[0]), 0u);
}

TEST_F(Empirical, TakesItsRangeAndPiecesFromTheReadings) {
  EffectSpec open =
      effect_spec("empirical", {{"target", std::string("EXX")}, {"drivers", std::string("feed x")}});
  const EffectKind& kind = *find_effect("empirical");
  EXPECT_TRUE(kind.is_open(open));
  const EffectSpec resolved = kind.resolved(open, views_, "model.toml");
  EXPECT_FALSE(kind.is_open(resolved));
  const auto from = *resolved.options.numbers("from"), to = *resolved.options.numbers("to");
  EXPECT_NEAR(from[0], 600.0, 1e-9);  // 0.010 to 0.014 m/s in mm/min
  EXPECT_NEAR(to[0], 840.0, 1e-9);
  double low = 1.0, high = 0.0;
  for (const auto& setup : campaign_.setups) {
    low = std::min(low, std::ranges::min(setup.readings.position[0]));
    high = std::max(high, std::ranges::max(setup.readings.position[0]));
  }
  EXPECT_NEAR(from[1], 1e3 * low, 1e-9);
  EXPECT_NEAR(to[1], 1e3 * high, 1e-9);
  EXPECT_EQ(*resolved.options.numbers("pieces"), (std::vector<double>{4, 6}));  // five feeds
}

TEST_F(Empirical, IdentifiedCoefficientsComeBack) {
  const EffectSpec spec = stated("EAY", "x y", {0.0, 0.0}, {500.0, 500.0}, {1, 2});
  EffectSpec identified = spec;
  const auto effect = effect_of(spec);
  ASSERT_EQ(effect->amplitudes().size(), 20u);
  EXPECT_EQ(effect->amplitudes().front().key, "coefficients_urad");
  for (std::size_t k = 0; k < 20; ++k)
    effect->amplitudes()[k].keep(1e-6 * static_cast<double>(k), identified.options);
  const auto again = effect_of(identified);
  for (std::size_t k = 0; k < 20; ++k) EXPECT_EQ(again->amplitudes()[k].guess, 1e-6 * static_cast<double>(k));
}

TEST_F(Empirical, RefusesWhatItCannotBe) {
  const auto refused = [](const EffectSpec& spec) {
    const std::string text = problem([&] { effect_of(spec); }), of = "effect \"empirical\": ";
    EXPECT_TRUE(text.starts_with(of)) << text;
    return text.substr(std::min(of.size(), text.size()));
  };
  EXPECT_EQ(refused(stated("EAY", "x q", {0, 0}, {1, 1}, {2, 2})), "drivers: \"q\" is not a variable");
  EXPECT_EQ(refused(stated("EAY", "x y z a", {0}, {1}, {2})), "4 drivers");
  EXPECT_EQ(refused(stated("EAY", "x y", {0}, {1, 1}, {2, 2})), "from holds 1 numbers for 2 drivers");
  EXPECT_EQ(refused(stated("EAY", "x", {3}, {1}, {2})), "the range of x is empty");
  EXPECT_EQ(refused(stated("EAY", "x", {0}, {1}, {2.5})), "pieces: 2.5 is not a number of pieces");
  EXPECT_EQ(refused(stated("EAY", "x y z", {0, 0, 0}, {1, 1, 1}, {9, 9, 9})),
            "these pieces need 1728 coefficients");
  EXPECT_EQ(refused(stated("EVIL", "x", {0}, {1}, {2})), "\"EVIL\" is not a target");
  EffectSpec spec = stated("EAY", "x", {0}, {1}, {2});
  spec.options.set("only", std::string("the left half"));
  EXPECT_EQ(refused(spec), "only = \"the left half\" is not a part of a campaign");
  spec = stated("EAY", "x", {0}, {1}, {2});
  spec.options.set("coefficients", std::vector<double>{1e-6, 2e-6});
  EXPECT_EQ(refused(spec), "2 coefficients for 5 functions");
}

TEST_F(Empirical, AnOpenRangeCannotBeEvaluated) {
  EffectSpec open = effect_spec("empirical", {{"target", std::string("EXX")}, {"drivers", std::string("x")}});
  open.source_line = 7;
  const auto effect = effect_of(open);
  EXPECT_EQ(problem([&] { effect->drivers(views_[0], {}); }), "curve EXX by x has no range");
}

}  // namespace
}  // namespace volcal
