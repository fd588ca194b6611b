// What a choice between alternatives changes in the volume, against refits with each of them.

#include "volcal/identify/criticism/alternative_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/support/effect_campaign.h"
#include "tests/support/hidden_studies.h"
#include "tests/support/search_states.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;
using testing_support::hiding;
using testing_support::reversal;
using testing_support::setting_of;
using testing_support::test_of;

constexpr int kPlacesPerAxis = 5;  // per axis, as the lattice of alternative_sets.h

struct PlaceOfVolume {
  AxisPosition position{};
  ApproachDirection direction{};
};

/// Of the measured positions, both ways.
std::vector<PlaceOfVolume> places_of(const Campaign& campaign) {
  std::array<std::pair<double, double>, 3> range;
  for (std::size_t a = 0; a < 3; ++a) {
    range[a] = {1e9, -1e9};
    for (const Setup& setup : campaign.setups) {
      for (const double q : setup.readings.position[a])
        range[a] = {std::min(range[a].first, q), std::max(range[a].second, q)};
    }
  }
  std::vector<PlaceOfVolume> places;
  for (const std::int8_t direction : {std::int8_t{-1}, std::int8_t{1}}) {
    for (int i = 0; i < kPlacesPerAxis * kPlacesPerAxis * kPlacesPerAxis; ++i) {
      PlaceOfVolume place;
      const int share[] = {i / (kPlacesPerAxis * kPlacesPerAxis), i / kPlacesPerAxis % kPlacesPerAxis,
                           i % kPlacesPerAxis};
      for (std::size_t a = 0; a < 3; ++a) {
        place.position[a] =
            range[a].first + (range[a].second - range[a].first) * share[a] / (kPlacesPerAxis - 1.0);
        place.direction[a] = direction;
      }
      places.push_back(place);
    }
  }
  return places;
}

/// Displacements, less their mean.
Eigen::Matrix3Xd predicted(const FitResult& result, const Tool& tool,
                           const std::vector<PlaceOfVolume>& places) {
  const ErrorField field(result, tool, default_conditions(result));
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    const PlaceOfVolume& place = places[static_cast<std::size_t>(i)];
    all.col(i) = field.at(place.position, place.direction).head<3>();
  }
  return all.colwise() - all.rowwise().mean().eval();
}

FitResult refitted(const FittedStudy& study, const EffectSpec& effect) {
  ModelSpec model = testing_support::polynomials();
  model.effects = {effect};
  FitOptions options;
  options.noise = NoisePolicy::White;
  return fit(study.simulated.campaign, model, options);
}

/// `own` added, with `rival` as its alternative.
ModelState with_rival(const ModelState& given, const FamilyTest& own, const FamilyTest& rival) {
  const ModelState reached = given.with(own);
  std::vector<AddedEffect> added = reached.added();
  added.front().rivals = {rival};
  return reached.with_comparisons(std::move(added));
}

/// A rival that acts at every pose, and one that fades with the travel since a turn, which a pose does not
/// have.
TEST(AlternativeSets, DifferAsRefitsWithEachDo) {
  const FittedStudy study(hiding({reversal("EYY", 1.0e-6)}, {5, 4, 4}));
  const ModelState given = ModelState(study.model, setting_of(study.model)).tested();
  const FamilyTest own = test_of(given, {"reversal", "EYY", "", ""});
  const auto places = places_of(study.simulated.campaign);
  const Tool& tool = study.simulated.campaign.machine.tools[0];
  const auto spec = [&](const FamilyTest& test) {
    EffectSpec found = finding(given.setting(), test).spec;
    found.options.set("amplitude", 0.0);
    return found;
  };
  const Eigen::Matrix3Xd chosen = predicted(refitted(study, spec(own)), tool, places);
  for (const char* kind : {"position-reversal", "pre-travel"}) {
    const FamilyTest rival = test_of(given, {kind, "EYY", "", ""});
    const std::vector<SetFinding> sets = alternative_sets(with_rival(given, own, rival), study.result);
    ASSERT_EQ(sets.size(), 1U);
    ASSERT_EQ(sets[0].members.size(), 2U);
    EXPECT_EQ(sets[0].chosen, 0U) << "no member has fewer parameters";
    EXPECT_EQ(sets[0].farthest, 1U);
    const MemberFinding& member = sets[0].members[1];
    const Eigen::Matrix3Xd difference = predicted(refitted(study, spec(rival)), tool, places) - chosen;
    const double largest = difference.colwise().norm().maxCoeff();
    EXPECT_GT(largest, 0.3e-6) << kind;
    EXPECT_NEAR(member.difference, largest, 0.15 * largest) << kind;
    EXPECT_GT(member.difference_u, 0.0);
    EXPECT_TRUE(sets[0].matters);
    EXPECT_EQ(member.at.size(), 3U);
  }
}

/// X expands by 10 um/m/K with a column that is 6 K warmer than the air. At 20 degC of column and air, as
/// tables state it, a model by the air has 60 um/m of it in EXX; at what was recorded the two are one.
TEST(AlternativeSets, CountUnderTheConditionsOfTables) {
  constexpr double kWarmer = 6.0, kPerKelvin = 10e-6;
  sim::HiddenEffect expansion{.kind = "scale-expansion", .options = {}, .amplitude = kPerKelvin};
  expansion.options.set("axis", std::string("X"));
  expansion.options.set("channel", std::string("column"));
  sim::Study hidden = hiding({expansion}, {5, 4, 3});
  hidden.environment.channels = {{.name = "air", .start = 21.0, .drift = 3.0 / 3600.0},
                                 {.name = "column", .start = 21.0 + kWarmer, .drift = 3.0 / 3600.0}};
  const FittedStudy study(hidden);
  const ModelState given = ModelState(study.model, setting_of(study.model)).tested();
  const FamilyTest own = test_of(given, {"scale-expansion", "EXX", "T_column", ""});
  const FamilyTest rival = test_of(given, {"scale-expansion", "EXX", "T_air", ""});
  const std::vector<SetFinding> sets = alternative_sets(with_rival(given, own, rival), study.result);
  ASSERT_EQ(sets.size(), 1U);
  ASSERT_EQ(sets[0].members.size(), 2U);
  const MemberFinding& member = sets[0].members[1];

  const Campaign& campaign = study.simulated.campaign;
  const auto places = places_of(campaign);
  double least = 1e9, most = -1e9;
  for (const PlaceOfVolume& place : places) {
    least = std::min(least, place.position[0]);
    most = std::max(most, place.position[0]);
  }
  const double by_hand = 0.5 * kPerKelvin * kWarmer * (most - least);  // off the mean of all places
  EXPECT_NEAR(member.difference, by_hand, 0.1 * by_hand);
  const auto prediction = [&](const FamilyTest& test) {
    EffectSpec spec = finding(given.setting(), test).spec;
    spec.options.set("amplitude", 0.0);
    return predicted(refitted(study, spec), campaign.machine.tools[0], places);
  };
  const Eigen::Matrix3Xd difference = prediction(rival) - prediction(own);
  const double largest = difference.colwise().norm().maxCoeff();
  EXPECT_NEAR(member.difference, largest, 0.1 * largest);
  EXPECT_TRUE(sets[0].matters);
  const std::vector<std::pair<Variable, double>> at = {{temperature_of("air"), 20.0},
                                                       {temperature_of("column"), 20.0}};
  EXPECT_EQ(member.conditions, at);
}

EffectFinding reversal_of(const std::string& symbol) {
  EffectFinding effect;
  effect.spec = effect_spec("reversal", {{"symbol", symbol}});
  effect.label = "reversal " + symbol;
  effect.name = EffectName::of_parts("reversal", symbol, "dir", "step");
  return effect;
}

std::vector<std::string> symbols_of(const ModelSpec& model) {
  std::vector<std::string> symbols;
  for (const EffectSpec& each : model.effects) symbols.push_back(*each.options.text("symbol"));
  return symbols;
}

/// A model for every member of every set, the other sets at what was chosen; finer functions are no effect.
TEST(AlternativeSets, HaveAModelForEveryMember) {
  using Symbols = std::vector<std::string>;
  Diagnosis diagnosis;
  diagnosis.effects = {reversal_of("EXX")};
  diagnosis.one_of = {reversal_of("EYX"), reversal_of("EZX")};
  EffectFinding finer;
  finer.resolution = true;
  diagnosis.further_one_of = {{reversal_of("EYY"), finer, reversal_of("EZZ")}};
  diagnosis.sets.resize(2);
  diagnosis.sets[0].chosen = 1;
  diagnosis.sets[0].members.resize(2);
  diagnosis.sets[1].chosen = 0;
  diagnosis.sets[1].members.resize(3);
  const std::vector<OfferedModel> models =
      offered_models(ModelSpec{}, testing_support::effect_campaign(), diagnosis);
  ASSERT_EQ(models.size(), 3U);
  EXPECT_EQ(models[0].file, "extended.toml");
  EXPECT_EQ(symbols_of(models[0].model), (Symbols{"EXX", "EZX", "EYY"}));
  EXPECT_EQ(models[1].file, "alternative-1-1.toml");
  EXPECT_EQ(symbols_of(models[1].model), (Symbols{"EXX", "EYX", "EYY"}));
  EXPECT_EQ(models[2].file, "alternative-2-3.toml");
  EXPECT_EQ(symbols_of(models[2].model), (Symbols{"EXX", "EZX", "EZZ"}));
}

}  // namespace
}  // namespace volcal
