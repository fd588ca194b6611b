#include "volcal/identify/criticism/alternative_sets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "volcal/identify/criticism/proposals/hypothetical_campaign.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/scale_expansions.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr int kPointsPerAxis = 5;
constexpr double kNoDifference = 1e-9;  // m: rounding and less than any machine moves
constexpr double kAnyNoise = 1e-6;      // m: the points are predicted, not measured

/// Under which the volume is predicted.
struct VolumeConditions {
  std::map<std::string, double> temperature_degC;
  std::optional<double> time;  ///< s
  std::optional<double> feed;  ///< m/s

  friend bool operator==(const VolumeConditions&, const VolumeConditions&) = default;

  /// In its unit; absent for what is none of these or was not recorded.
  std::optional<double> value(const Variable& variable) const {
    if (variable.kind == Variable::Kind::Time) return time;
    if (variable.kind == Variable::Kind::Feed && feed) return *feed / variable.unit().si_per_unit;
    const auto channel = temperature_degC.find(variable.subject);
    if (variable.kind != Variable::Kind::Temperature || channel == temperature_degC.end())
      return std::nullopt;
    return channel->second;
  }
};

VolumeConditions mean_conditions(const Campaign& campaign) {
  const RecordedConditions recorded = recorded_conditions(campaign);
  VolumeConditions mean;
  for (const auto& [channel, range] : recorded.temperature_degC) mean.temperature_degC[channel] = range.mean;
  if (recorded.time) mean.time = recorded.time->mean;
  if (recorded.feed) mean.feed = recorded.feed->mean;
  return mean;
}

/// Those of the model and of all that may be part of it.
std::set<std::string> channels_of_scales(const ModelState& reached, const FitResult& result) {
  std::set<std::string> channels = expansion_channels(reached.model().campaign().machine, result.identified);
  const auto add = [&](const FamilyTest& test) {
    const Family& family = reached.setting().families[test.family];
    if (family.effect) channels.merge(expansion_channels(*family.effect));
  };
  for (const AddedEffect& added : reached.added()) {
    add(added.test);
    for (const FamilyTest& rival : added.rivals) add(rival);
  }
  return channels;
}

/// Those that tables are stated at, 20 degC where an expansion is known, and the mean ones of the campaign.
std::vector<VolumeConditions> conditions_of_volume(const ModelState& reached, const FitResult& result) {
  const VolumeConditions mean = mean_conditions(reached.model().campaign());
  VolumeConditions tables = mean;
  for (const std::string& channel : channels_of_scales(reached, result)) {
    const auto recorded = tables.temperature_degC.find(channel);
    if (recorded != tables.temperature_degC.end()) recorded->second = kReferenceTemperature_degC;
  }
  if (tables == mean) return {tables};
  return {tables, mean};
}

/// Lattice of the measured positions of the linear axes, the others at 0.
std::vector<AxisPosition> lattice(const Campaign& campaign) {
  std::vector<AxisPosition> poses(1);
  for (const AxisName axis : campaign.machine.linear_axes()) {
    const MeasuredRange range = measured_range(campaign, axis);
    const int points = range.max > range.min ? kPointsPerAxis : 1;
    std::vector<AxisPosition> more;
    for (const AxisPosition& pose : poses) {
      for (int i = 0; i < points; ++i) {
        AxisPosition next = pose;
        next[index_of(axis)] =
            points == 1 ? range.min : range.min + (range.max - range.min) * i / (points - 1.0);
        more.push_back(next);
      }
    }
    poses = std::move(more);
  }
  return poses;
}

void add_conditions(const VolumeConditions& conditions, std::size_t count, Readings& readings) {
  if (conditions.time) readings.time.assign(count, *conditions.time);
  if (conditions.feed) readings.feed.assign(count, *conditions.feed);
  for (const auto& [channel, value] : conditions.temperature_degC)
    readings.temperature[channel].assign(count, value);
}

/// The instrument that reads the displacements of the functional point themselves.
std::string reader_of_error_vectors() {
  for (const Instrument* instrument : instruments()) {
    if (instrument->schema().traits.reads_error_vectors) return instrument->schema().name;
  }
  throw std::logic_error("no instrument reads error vectors");
}

/// Error vectors at the lattice, with a tool, approached from one side.
Setup points_of_volume(const Campaign& campaign, const std::vector<AxisPosition>& poses,
                       const VolumeConditions& conditions, std::size_t tool, std::int8_t direction) {
  Setup setup;
  setup.name = "volume";
  setup.instrument = reader_of_error_vectors();
  setup.tool = tool;
  setup.options.set("alignment", std::string("none"));
  setup.noise.set("constant", kAnyNoise);
  setup.has_noise = true;
  Readings& readings = setup.readings;
  readings.source_line.assign(poses.size(), 0);
  readings.value.assign(3, std::vector<double>(poses.size(), 0.0));
  for (const Axis& axis : campaign.machine.axes) {
    const std::size_t a = index_of(axis.name);
    for (const AxisPosition& pose : poses) readings.position[a].push_back(pose[a]);
    readings.direction[a].assign(poses.size(), direction);
  }
  add_conditions(conditions, poses.size(), readings);
  return setup;
}

/// Under the conditions one after the other; as many points under each.
ExtraMeasurement volume_of(const Campaign& campaign, const std::vector<AxisPosition>& poses,
                           const std::vector<VolumeConditions>& conditions) {
  ExtraMeasurement volume;
  volume.is_path = false;
  std::vector<std::size_t> tools;
  for (const Setup& setup : campaign.setups) {
    if (std::ranges::find(tools, setup.tool) == tools.end()) tools.push_back(setup.tool);
  }
  for (const VolumeConditions& each : conditions) {
    for (const std::size_t tool : tools) {
      for (const std::int8_t direction : {std::int8_t{-1}, std::int8_t{1}}) {
        volume.setups.push_back(points_of_volume(campaign, poses, each, tool, direction));
        volume.setups.back().name += " " + std::to_string(volume.setups.size());
      }
    }
  }
  return volume;
}

/// What a unit of each amplitude makes of the machine, the rest of the model adjusted to it.
struct MemberPrediction {
  Eigen::MatrixXd columns;  ///< three rows per point
  Eigen::VectorXd amplitude;
  Eigen::MatrixXd covariance;
};

/// Less what is common to all points under the same conditions.
void centre(Eigen::Index conditions, Eigen::MatrixXd& columns) {
  const Eigen::Index points = columns.rows() / 3 / conditions;
  for (auto column : columns.colwise()) {
    for (Eigen::Index c = 0; c < conditions; ++c) {
      auto own = column.segment(3 * points * c, 3 * points).reshaped(3, points);
      const Eigen::Vector3d common = own.rowwise().mean();
      own.colwise() -= common;
    }
  }
}

/// What changes at a pose and drives any of the members.
std::set<Variable> drivers_at_rest(const std::vector<const Effect*>& effects) {
  std::set<Variable> drivers;
  for (const Effect* effect : effects) {
    for (const Variable& variable : effect->name().driver.variables()) {
      if (variable.changes_at_rest()) drivers.insert(variable);
    }
  }
  return drivers;
}

bool exceeds_uncertainty(const MemberFinding& member) {
  return member.difference > std::max(kNoDifference, kCoverageFactor * member.difference_u);
}

class SetJudge {
 public:
  SetJudge(const ModelState& reached, const FitResult& result)
      : reached_(reached),
        poses_(lattice(reached.model().campaign())),
        conditions_(conditions_of_volume(reached, result)),
        volume_(reached.model().campaign(), result, reached.model().noise_groups(),
                {volume_of(reached.model().campaign(), poses_, conditions_)}),
        rows_(volume_.rows(0)) {}

  SetFinding judge(std::size_t added) {
    std::vector<FamilyTest> members{reached_.added()[added].test};
    const auto& rivals = reached_.added()[added].rivals;
    members.insert(members.end(), rivals.begin(), rivals.end());
    SetFinding set;
    set.chosen = simplest(members);
    if (set.chosen) chosen_.insert(members[*set.chosen].family);
    for (const FamilyTest& member : members) {
      const LadderStep step = ladder_step_with(reached_, added, member);
      set.members.push_back({.rms_heldout = step.rms_heldout,
                             .systematic = step.systematic,
                             .systematic_low = step.systematic_low,
                             .systematic_high = step.systematic_high});
    }
    if (set.chosen) compare(added, members, set);
    find_farthest(set);
    return set;
  }

 private:
  static void find_farthest(SetFinding& set) {
    const auto exceeds = [&set](std::size_t i) { return exceeds_uncertainty(set.members[i]); };
    for (std::size_t i = 0; i < set.members.size(); ++i) {
      if (i == set.chosen || std::isnan(set.members[i].difference)) continue;
      const bool further = !set.farthest || exceeds(i) > exceeds(*set.farthest) ||
                           (exceeds(i) == exceeds(*set.farthest) &&
                            set.members[i].difference > set.members[*set.farthest].difference);
      if (further) set.farthest = i;
    }
    set.matters = set.farthest && exceeds(*set.farthest);
  }

  const Family& family(const FamilyTest& test) const { return reached_.setting().families[test.family]; }

  /// Of the fewest parameters, and no other set's choice; nothing where none can stand in a model file.
  std::optional<std::size_t> simplest(const std::vector<FamilyTest>& members) const {
    const auto parameters = [this](const FamilyTest& test) {
      const Family& own = family(test);
      return own.amplitudes() + (own.scan.size() > 1 ? test.shape.size() : 0);
    };
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (!family(members[i]).effect || chosen_.contains(members[i].family)) continue;
      if (!best || parameters(members[i]) < parameters(members[*best])) best = i;
    }
    return best;
  }

  /// Derivatives of the points to the parameters of the model without the set; shapes of other effects held.
  Eigen::MatrixXd model_rows(std::size_t left_out, const Projector& projector) const {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(rows_.model.rows(), projector.parameters());
    rows.leftCols(rows_.model.cols()) = rows_.model;
    for (const AddedSurface& surface : reached_.surfaces()) {
      rows.middleCols(surface.first, surface.size()) =
          volume_.columns(0, rows_, *surface.effect, surface.effect->shape_values());
    }
    Eigen::Index at = projector.parameters() - projector.accepted();
    for (std::size_t i = 0; i < reached_.added().size(); ++i) {
      const AddedEffect& other = reached_.added()[i];
      if (i == left_out) continue;
      if (const Family& own = reached_.family_of(other); own.effect) {
        const Eigen::Index count = std::min(own.amplitudes(), other.columns.cols());
        rows.middleCols(at, count) = volume_.columns(0, rows_, *own.effect, other.test.shape).leftCols(count);
      }
      at += other.columns.cols();
    }
    return rows;
  }

  void compare(std::size_t added, const std::vector<FamilyTest>& members, SetFinding& set) const {
    const auto projector = reached_.projector_without({added});
    const Eigen::MatrixXd rows = model_rows(added, *projector);
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(reached_.model().size()), 0);
    std::vector<Eigen::Index> first;
    for (const FamilyTest& member : members) {
      first.push_back(columns.cols());
      append_columns(family_columns(reached_.model(), family(member), member.shape), columns);
    }
    const Eigen::MatrixXd gram = projector->project(columns).grams.front();
    const Eigen::MatrixXd imitation = projector->imitation(columns);
    std::vector<MemberPrediction> predictions(members.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (!family(members[i]).effect) continue;
      const Eigen::Index count = family(members[i]).amplitudes();
      predictions[i] = {volume_.columns(0, rows_, *family(members[i]).effect, members[i].shape) -
                            rows * imitation.middleCols(first[i], count),
                        members[i].score.amplitude, members[i].score.covariance};
      centre(std::ssize(conditions_), predictions[i].columns);
    }
    const std::size_t chosen = *set.chosen;
    std::vector<const Effect*> effects;
    for (const FamilyTest& member : members) {
      if (family(member).effect) effects.push_back(family(member).effect.get());
    }
    const std::set<Variable> drivers = drivers_at_rest(effects);
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i == chosen) {
        set.members[i].difference = set.members[i].difference_u = 0.0;
      } else if (family(members[i]).effect) {
        state_difference(predictions[chosen], predictions[i],
                         gram.block(first[chosen], first[i], predictions[chosen].amplitude.size(),
                                    predictions[i].amplitude.size()),
                         drivers, set.members[i]);
      }
    }
  }

  /// Where it is largest, under conditions where that exceeds its uncertainty if there are any. `between`: of
  /// the two members' columns after projection.
  void state_difference(const MemberPrediction& one, const MemberPrediction& other,
                        const Eigen::MatrixXd& between, const std::set<Variable>& drivers,
                        MemberFinding& member) const {
    std::optional<MemberFinding> most;
    for (std::size_t c = 0; c < conditions_.size(); ++c) {
      MemberFinding here = member;
      state_largest(one, other, between, c, here);
      for (const Variable& driver : drivers) {
        if (const auto value = conditions_[c].value(driver)) here.conditions.emplace_back(driver, *value);
      }
      const bool is_more =
          !most || exceeds_uncertainty(here) > exceeds_uncertainty(*most) ||
          (exceeds_uncertainty(here) == exceeds_uncertainty(*most) && here.difference > most->difference);
      if (is_more) most = std::move(here);
    }
    member = std::move(*most);
  }

  /// Under the conditions of this number.
  void state_largest(const MemberPrediction& one, const MemberPrediction& other,
                     const Eigen::MatrixXd& between, std::size_t conditions, MemberFinding& member) const {
    const Eigen::VectorXd difference = other.columns * other.amplitude - one.columns * one.amplitude;
    const Eigen::Index points = difference.size() / 3 / std::ssize(conditions_);
    const Eigen::Index first_point = points * static_cast<Eigen::Index>(conditions);
    const auto of_point = [&](Eigen::Index i) { return difference.segment<3>(3 * i); };
    Eigen::Index where = first_point;
    for (Eigen::Index i = first_point; i < first_point + points; ++i) {
      if (of_point(i).squaredNorm() > of_point(where).squaredNorm()) where = i;
    }
    member.difference = of_point(where).norm();
    const auto pose = static_cast<std::size_t>(where) % poses_.size();
    for (const AxisName axis : reached_.model().campaign().machine.linear_axes())
      member.at.push_back(poses_[pose][index_of(axis)]);
    if (!(member.difference > 0.0)) {
      member.difference_u = 0.0;
      return;
    }
    const Eigen::RowVector3d along = of_point(where).transpose() / member.difference;
    const Eigen::RowVectorXd first = along * one.columns.middleRows(3 * where, 3);
    const Eigen::RowVectorXd second = along * other.columns.middleRows(3 * where, 3);
    const Eigen::VectorXd weighed = one.covariance * first.transpose();
    const Eigen::VectorXd other_weighed = other.covariance * second.transpose();
    const double variance =
        first.dot(weighed) + second.dot(other_weighed) - 2.0 * weighed.dot(between * other_weighed);
    member.difference_u = std::sqrt(std::max(0.0, variance));
  }

  const ModelState& reached_;
  std::vector<AxisPosition> poses_;
  std::vector<VolumeConditions> conditions_;
  HypotheticalCampaign volume_;
  HypotheticalRows rows_;
  std::set<std::size_t> chosen_;  ///< families
};

}  // namespace

std::vector<SetFinding> alternative_sets(const ModelState& reached, const FitResult& result) {
  std::vector<SetFinding> sets;
  std::optional<SetJudge> judge;
  for (std::size_t i = 0; i < reached.added().size(); ++i) {
    if (reached.added()[i].rivals.empty()) continue;
    if (!judge) judge.emplace(reached, result);
    sets.push_back(judge->judge(i));
  }
  return sets;
}

}  // namespace volcal
