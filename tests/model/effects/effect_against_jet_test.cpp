// Derivatives of readings to the amplitudes of every registered effect, against automatic ones through the
// exact transforms.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/jet_rotation.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using testing_support::effect_campaign;
using testing_support::turn_of;
using JetVector = Vector3<InstrumentJet>;

/// What an effect with small amplitudes does to one reading: its k-th amplitude is derivative k, at 0.
struct Disturbed {
  PoseErrors<InstrumentJet> errors;
  JetVector tool, station, floor;
  std::array<InstrumentJet, kMaxChannels> reading{};

  Disturbed(const Effect& effect, const Eigen::RowVectorXd& driver, const Eigen::Vector3d& tool_offset)
      : tool(tool_offset.cast<InstrumentJet>()), station(JetVector::Zero()), floor(JetVector::Zero()) {
    const std::vector<EffectTerm> terms = effect.terms();
    for (std::size_t k = 0; k < terms.size(); ++k) {
      target(terms[k].target) +=
          InstrumentJet(0.0, static_cast<int>(terms[k].amplitude)) * driver[static_cast<Eigen::Index>(k)];
    }
  }

  InstrumentJet& target(const EffectTarget& target) {
    const auto component = static_cast<std::size_t>(target.component);
    switch (target.kind) {
      case TargetKind::Motion:
        return errors.motion[index_of(target.symbol.axis)][index_of(target.symbol.component)];
      case TargetKind::ToolOffset:
        return tool[target.component];
      case TargetKind::Station:
        return station[target.component];
      case TargetKind::Floor:
        return floor[target.component];
      case TargetKind::Reading:
        break;
    }
    return reading[component];
  }

  /// Of the errors of the axes on one side of the bed alone.
  PoseErrors<InstrumentJet> errors_of(const Machine& machine, bool workpiece_side) const {
    PoseErrors<InstrumentJet> own;
    for (const Joint& joint : machine.structure.joints) {
      if (joint.workpiece_side == workpiece_side)
        own.motion[index_of(joint.axis)] = errors.motion[index_of(joint.axis)];
    }
    return own;
  }
};

class EffectAgainstJet : public ::testing::TestWithParam<const char*> {
 protected:
  ToolState<InstrumentJet> state_of(const Disturbed& disturbed, const KinematicChain& chain,
                                    const AxisPosition& position, const Eigen::Vector3d& pivot_w) const {
    ToolState<InstrumentJet> state;
    const auto turn = [&](bool workpiece_side) {
      return turn_of(chain
                         .exact_pose<InstrumentJet>(position, disturbed.tool,
                                                    disturbed.errors_of(campaign_.machine, workpiece_side))
                         .rotation_wt);
    };
    state.point_w = chain.exact_pose<InstrumentJet>(position, disturbed.tool, disturbed.errors).point_w -
                    disturbed.station;
    const JetVector arm = state.point_w - pivot_w.cast<InstrumentJet>();
    state.point_w += disturbed.floor.cross(arm);
    state.rotation_tool_side = turn(false) + disturbed.floor;
    state.rotation_workpiece_side = turn(true) - disturbed.floor;
    return state;
  }

  Campaign campaign_ = effect_campaign(GetParam());
};

TEST_P(EffectAgainstJet, DerivativesToAmplitudesEqualAutomaticOnes) {
  constexpr std::size_t kRow = 7;
  int effects = 0, acting = 0;
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& spec : kind->examples(campaign_)) {
      ModelSpec with_effect;
      with_effect.default_function.basis = "zero";
      with_effect.effects.push_back(spec);
      const MeasurementModel model(campaign_, with_effect);
      const EffectBinding& bound = model.binding().effects.front();
      const Eigen::VectorXd at = model.initial_parameters();
      ++effects;
      for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
        const Readings& readings = campaign_.setups[setup].readings;
        const Disturbed disturbed(*bound.effect, bound.driver[setup].row(kRow),
                                  model.binding().setups[setup].tool_offset);
        const ToolState<InstrumentJet> state = state_of(
            disturbed, model.chain(), readings.commanded_position(kRow), model.binding().floor_pivot_w);
        RowJacobian row;
        model.linearize(setup, kRow, at, row);
        InstrumentJet nuisance[kMaxLocalNuisance], expected[kMaxChannels];
        const int own = model.bound(setup).local_nuisance_size();
        for (int k = 0; k < own; ++k)
          nuisance[k] = InstrumentJet(at[row.tail_index[row.tail_index.size() - own + k]]);
        model.bound(setup).predict(kRow, state, nuisance, expected);
        for (int channel = 0; channel < row.channels; ++channel) {
          const auto derivatives = dense_row(model.layout(), row, channel);
          for (int k = 0; k < bound.amplitude_count(); ++k) {
            const double automatic =
                expected[channel].v[k] + disturbed.reading[static_cast<std::size_t>(channel)].v[k];
            EXPECT_NEAR(derivatives[bound.first_parameter + k], automatic,
                        1e-10 * (1.0 + std::abs(automatic)))
                << bound.effect->amplitudes()[static_cast<std::size_t>(k)].label << " in "
                << campaign_.setups[setup].name;
            acting += automatic != 0.0 ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GT(effects, static_cast<int>(effect_kinds().size()));
  EXPECT_GT(acting, effects);
}

INSTANTIATE_TEST_SUITE_P(Structures, EffectAgainstJet,
                         ::testing::Values("w X' b Y Z t", "w Y' b X Z t", "w b X Y Z t",
                                           "w C' A' Y' b X Z t"));

}  // namespace
}  // namespace volcal
