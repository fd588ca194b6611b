// What every registered instrument must keep: analytic derivatives equal automatic ones, the schema says what
// it needs, nothing is read that the schema does not declare.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr int kRows = 7;

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Eigen::Vector3d uniform_vector(std::mt19937_64& random, double low, double high) {
  return {uniform(random, low, high), uniform(random, low, high), uniform(random, low, high)};
}

/// A setup made from nothing but the schema; every optional key is given when `all_keys`.
Setup setup_from(const InstrumentSchema& schema, bool all_keys, std::size_t choice, std::size_t column_set,
                 std::mt19937_64& random) {
  volcal::Setup setup;
  setup.name = "S";
  setup.instrument = schema.name;
  for (const KeySchema& key : schema.keys) {
    if (!key.required && !all_keys) continue;
    const std::string stem(stem_of_key(key.key));
    if (key.type == KeyType::Vector3) setup.options.set(stem, uniform_vector(random, -3.0, -1.0));
    if (key.type == KeyType::Number) setup.options.set(stem, 1e-3);
    if (key.type == KeyType::Boolean) setup.options.set(stem, true);
    if (key.type == KeyType::Text) {
      setup.options.set(stem,
                        key.choices.empty() ? std::string("name") : key.choices[choice % key.choices.size()]);
    }
  }
  setup.readings.column_set = column_set;
  for (std::size_t channel = 0; channel < schema.column_sets[column_set].size(); ++channel) {
    std::vector<double> column(kRows);
    for (double& value : column) value = uniform(random, 0.5, 1.0);
    setup.readings.value.push_back(column);
  }
  for (const ColumnSchema& given : schema.given_of(column_set)) {
    std::vector<double> column(kRows);
    for (double& value : column) value = uniform(random, 0.5, 1.0);
    if (unit_of_key(given.column).suffix.empty()) column.assign(kRows, 1.0 / std::sqrt(3.0));
    setup.readings.given.push_back(column);
  }
  for (int row = 0; row < kRows; ++row) {
    setup.readings.source_line.push_back(row + 2);
    setup.readings.line.push_back(row % 2);
  }
  return setup;
}

SetupContext context_of(const Setup& setup, const Machine& machine, std::mt19937_64& random) {
  SetupContext context{setup, machine, "campaign.toml", {}};
  for (int row = 0; row < kRows; ++row) context.nominal_point_w.push_back(uniform_vector(random, 0.0, 1.0));
  return context;
}

struct Case {
  const Instrument* instrument;
  bool all_keys;
  std::size_t choice;
  std::size_t column_set;
};

std::string name_of_case(const Case& tested) {
  std::string name = tested.instrument->schema().name;
  std::ranges::replace(name, '-', '_');
  return name + (tested.all_keys ? "_all_keys_" : "_required_keys_") + std::to_string(tested.choice) +
         "_columns_" + std::to_string(tested.column_set);
}

void PrintTo(const Case& tested, std::ostream* out) { *out << name_of_case(tested); }

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const Instrument* instrument : instruments()) {
    for (std::size_t set = 0; set < instrument->schema().column_sets.size(); ++set) {
      cases.push_back({instrument, false, 0, set});
      for (std::size_t choice = 0; choice < 3; ++choice) cases.push_back({instrument, true, choice, set});
    }
  }
  return cases;
}

ToolState<double> drawn_state(std::mt19937_64& random) {
  ToolState<double> state;
  state.point_w = uniform_vector(random, 0.0, 1.0);
  state.rotation_tool_side = uniform_vector(random, -1e-4, 1e-4);
  state.rotation_workpiece_side = uniform_vector(random, -1e-4, 1e-4);
  return state;
}

class InstrumentContract : public ::testing::TestWithParam<Case> {};

TEST_P(InstrumentContract, AnalyticDerivativesEqualAutomaticOnes) {
  std::mt19937_64 random(5);
  const Machine machine;
  const InstrumentSchema& schema = GetParam().instrument->schema();
  const volcal::Setup setup =
      setup_from(schema, GetParam().all_keys, GetParam().choice, GetParam().column_set, random);
  const auto bound = GetParam().instrument->bind(context_of(setup, machine, random));
  ASSERT_EQ(static_cast<std::size_t>(bound->channels()), schema.column_sets[GetParam().column_set].size());
  const int local = bound->local_nuisance_size();
  ASSERT_LE(local, kMaxLocalNuisance);

  for (std::size_t row = 0; row < kRows; ++row) {
    const ToolState<double> state = drawn_state(random);
    double nuisance[kMaxLocalNuisance];
    for (double& value : nuisance) value = uniform(random, -0.2, 0.2);

    ToolState<InstrumentJet> jet_state;
    for (int k = 0; k < 3; ++k) {
      jet_state.point_w[k] = InstrumentJet(state.point_w[k], k);
      jet_state.rotation_tool_side[k] = InstrumentJet(state.rotation_tool_side[k], 3 + k);
      jet_state.rotation_workpiece_side[k] = InstrumentJet(state.rotation_workpiece_side[k], 6 + k);
    }
    InstrumentJet jet_nuisance[kMaxLocalNuisance];
    for (int k = 0; k < local; ++k) jet_nuisance[k] = InstrumentJet(nuisance[k], kStateSize + k);
    InstrumentJet automatic[kMaxChannels];
    bound->predict(row, jet_state, jet_nuisance, automatic);

    Linearization analytic;
    bound->linearize(row, state, nuisance, analytic);
    double plain[kMaxChannels];
    bound->predict(row, state, nuisance, plain);
    for (int channel = 0; channel < bound->channels(); ++channel) {
      EXPECT_NEAR(analytic.predicted[channel], automatic[channel].a, 1e-12);
      EXPECT_NEAR(plain[channel], automatic[channel].a, 1e-12);
      for (int k = 0; k < kStateSize; ++k) {
        EXPECT_NEAR(analytic.d_state[channel][k], automatic[channel].v[k], 1e-10)
            << schema.name << " state " << k;
      }
      for (int k = 0; k < local; ++k) {
        EXPECT_NEAR(analytic.d_nuisance[channel][k], automatic[channel].v[kStateSize + k], 1e-10)
            << schema.name << " nuisance " << k;
      }
    }
  }
}

TEST_P(InstrumentContract, ReadingsSideBySideAreTheSameAsOneByOne) {
  std::mt19937_64 random(6);
  const Machine machine;
  const InstrumentSchema& schema = GetParam().instrument->schema();
  const volcal::Setup setup =
      setup_from(schema, GetParam().all_keys, GetParam().choice, GetParam().column_set, random);
  const auto bound = GetParam().instrument->bind(context_of(setup, machine, random));
  const int local = bound->local_nuisance_size();
  double nuisance[kMaxLocalNuisance];
  for (double& value : nuisance) value = uniform(random, -0.2, 0.2);
  std::vector<ToolState<double>> states(kLanes);
  ToolStateLanes side_by_side;
  for (int i = 0; i < kLanes; ++i) {
    const ToolState<double> state = states[static_cast<std::size_t>(i)] = drawn_state(random);
    for (int k = 0; k < 3; ++k) {
      side_by_side.point_w[k][i] = state.point_w[k];
      side_by_side.rotation_tool_side[k][i] = state.rotation_tool_side[k];
      side_by_side.rotation_workpiece_side[k][i] = state.rotation_workpiece_side[k];
    }
  }
  constexpr int kFirst = 2, kCount = kRows - kFirst;
  LinearizationLanes lanes;
  lanes.resize(bound->channels(), bound->sees_rotation() ? kStateSize : 3, local);
  bound->linearize_lanes(kFirst, kCount, side_by_side, nuisance, lanes);
  for (int i = 0; i < kCount; ++i) {
    Linearization single;
    bound->linearize(kFirst + static_cast<std::size_t>(i), states[static_cast<std::size_t>(i)], nuisance,
                     single);
    for (int channel = 0; channel < bound->channels(); ++channel) {
      EXPECT_NEAR(lanes.predicted(channel)[i], single.predicted[channel], 1e-14);
      for (int k = 0; k < kStateSize; ++k) {
        const double derivative = k < lanes.state_size() ? lanes.d_state(channel)[k][i] : 0.0;
        EXPECT_NEAR(derivative, single.d_state[channel][k], 1e-14) << schema.name << " state " << k;
      }
      for (int k = 0; k < local; ++k) {
        EXPECT_NEAR(lanes.d_nuisance(channel)[k][i], single.d_nuisance[channel][k], 1e-14)
            << schema.name << " nuisance " << k;
      }
    }
  }
}

TEST_P(InstrumentContract, NuisanceBlocksAreNamedAndComplete) {
  std::mt19937_64 random(6);
  const Machine machine;
  const volcal::Setup setup = setup_from(GetParam().instrument->schema(), GetParam().all_keys,
                                         GetParam().choice, GetParam().column_set, random);
  const auto bound = GetParam().instrument->bind(context_of(setup, machine, random));
  int total = 0;
  for (const NuisanceBlock& block : bound->nuisance()) {
    EXPECT_FALSE(block.name.empty());
    EXPECT_EQ(block.labels.size(), static_cast<std::size_t>(block.size()));
    EXPECT_EQ(block.is_angle.size(), static_cast<std::size_t>(block.size()));
    EXPECT_EQ(block.prior_mean.size(), block.size());
    EXPECT_EQ(block.prior_sigma.size(), block.size());
    EXPECT_TRUE(block.guess.allFinite());
    total += block.size();
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    int index[kMaxLocalNuisance];
    bound->local_nuisance(row, index);
    for (int k = 0; k < bound->local_nuisance_size(); ++k) {
      EXPECT_GE(index[k], 0);
      EXPECT_LT(index[k], total);
    }
    for (int channel = 0; channel < bound->channels(); ++channel)
      EXPECT_GE(bound->noise_length(row, channel), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, InstrumentContract, ::testing::ValuesIn(all_cases()),
                         ::testing::PrintToStringParamName());

TEST(InstrumentSchemas, SayWhatTheyAre) {
  for (const Instrument* instrument : instruments()) {
    const InstrumentSchema& schema = instrument->schema();
    EXPECT_EQ(find_instrument(schema.name), instrument);
    EXPECT_FALSE(schema.summary.empty());
    EXPECT_FALSE(schema.equation.empty());
    EXPECT_FALSE(schema.source.empty());
    ASSERT_FALSE(schema.column_sets.empty());
    for (const auto& columns : schema.column_sets) {
      for (const ColumnSchema& column : columns)
        EXPECT_FALSE(unit_of_key(column.column).suffix.empty()) << column.column;
    }
    for (const KeySchema& key : schema.keys) EXPECT_FALSE(key.help.empty()) << schema.name << " " << key.key;
  }
}

// Hand-worked: a square in the xy plane turned by -10 urad about z drops its X arm by 10 um per metre in y,
// so the deviation read there rises by 10 um/m; its Y arm leans to +x and the deviation in x falls by 10
// um/m.
TEST(Straightness, ArmsOfATurnedSquareDeviateWithOppositeSigns) {
  const Machine machine;
  const auto slope_derivative = [&](const Eigen::Vector3d& line, const Eigen::Vector3d& across) {
    volcal::Setup setup;
    setup.name = "S";
    setup.instrument = "straightness";
    setup.options.set("direction", across);
    setup.options.set("reference", std::string("square"));
    setup.readings.value = {{0.0, 0.0}};
    setup.readings.source_line = {2, 3};
    SetupContext context{setup, machine, "campaign.toml", {Eigen::Vector3d::Zero(), line}};
    const auto bound = find_instrument("straightness")->bind(context);
    EXPECT_EQ(bound->nuisance()[1].name, "reference square: slope");
    ToolState<double> state;
    state.point_w = line;
    const double nuisance[2] = {0.0, 0.0};
    Linearization out;
    bound->linearize(1, state, nuisance, out);
    return out.d_nuisance[0][1];
  };
  EXPECT_DOUBLE_EQ(slope_derivative(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()), 1.0);
  EXPECT_DOUBLE_EQ(slope_derivative(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()), -1.0);
}

// Hand-worked: turned by 10 urad about z, a point at x = 0.5 m of an artefact shifts by 5 um in y; the third
// component is not read. Setups on one artefact turn about one point, the origin.
TEST(VolumetricPoints, SetupsOnOneArtefactShareItsAlignment) {
  const Machine machine;
  std::vector<std::string> names;
  for (const double x : {0.5, 1.5}) {
    volcal::Setup setup;
    setup.name = "S" + std::to_string(names.size());
    setup.options.set("artefact", std::string("plate"));
    setup.readings.column_set = 1;
    setup.readings.value = {{0.0, 0.0}, {0.0, 0.0}};
    setup.readings.source_line = {2, 3};
    SetupContext context{setup, machine, "campaign.toml", {{x, 0.0, 0.0}, {x, 0.0, 0.2}}};
    const auto bound = find_instrument("volumetric-points")->bind(context);
    ASSERT_EQ(bound->channels(), 2);
    for (const NuisanceBlock& block : bound->nuisance()) names.push_back(block.name);
    ToolState<double> state;
    state.point_w = {x, 0.0, 0.0};
    const double nuisance[6] = {1e-6, 2e-6, 3e-6, 0.0, 0.0, 10e-6};
    double predicted[kMaxChannels];
    bound->predict(0, state, nuisance, predicted);
    EXPECT_NEAR(predicted[0], 1e-6, 1e-15);
    EXPECT_NEAR(predicted[1], 2e-6 + 10e-6 * x, 1e-15);
  }
  EXPECT_EQ(names[0], "artefact plate: alignment shift");
  EXPECT_EQ(names[0], names[2]);
  EXPECT_EQ(names[1], names[3]);
}

}  // namespace
}  // namespace volcal
