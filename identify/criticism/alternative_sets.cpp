#include "volcal/identify/criticism/alternative_sets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "volcal/identify/criticism/proposals/hypothetical_campaign.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr int kPointsPerAxis = 5;
constexpr double kNoDifference = 1e-9;  // m: rounding and less than any machine moves
constexpr double kAnyNoise = 1e-6;      // m: the points are predicted, not measured

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of all readings that have it; nothing where none has.
template <class Column>
std::vector<double> of_all_setups(const Campaign& campaign, const Column& column) {
  std::vector<double> all;
  for (const Setup& setup : campaign.setups) {
    const std::vector<double>& own = column(setup);
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
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

void add_mean_conditions(const Campaign& campaign, std::size_t count, Readings& readings) {
  const auto times = of_all_setups(
      campaign, [](const Setup& setup) -> auto& { return setup.readings.time; });
  if (!times.empty()) readings.time.assign(count, mean(times));
  const auto feeds = of_all_setups(
      campaign, [](const Setup& setup) -> auto& { return setup.readings.feed; });
  if (!feeds.empty()) readings.feed.assign(count, mean(feeds));
  for (const std::string& channel : temperature_channels(campaign)) {
    static const std::vector<double> kNone;
    const auto values = of_all_setups(
        campaign, [&](const Setup& setup) -> auto& {
          const auto found = setup.readings.temperature.find(channel);
          return found == setup.readings.temperature.end() ? kNone : found->second;
        });
    readings.temperature[channel].assign(count, mean(values));
  }
}

/// The instrument that reads the displacements of the functional point themselves.
std::string reader_of_error_vectors() {
  for (const Instrument* instrument : instruments()) {
    if (instrument->schema().traits.reads_error_vectors) return instrument->schema().name;
  }
  throw std::logic_error("no instrument reads error vectors");
}

/// Error vectors at the lattice, with a tool, approached from one side.
Setup points_of_volume(const Campaign& campaign, const std::vector<AxisPosition>& poses, std::size_t tool,
                       std::int8_t direction) {
  Setup setup;
  setup.name = "volume of tool " + std::to_string(tool) + (direction > 0 ? " +" : " -");
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
  add_mean_conditions(campaign, poses.size(), readings);
  return setup;
}

ExtraMeasurement volume_of(const Campaign& campaign, const std::vector<AxisPosition>& poses) {
  ExtraMeasurement volume;
  volume.is_path = false;
  std::vector<std::size_t> tools;
  for (const Setup& setup : campaign.setups) {
    if (std::ranges::find(tools, setup.tool) == tools.end()) tools.push_back(setup.tool);
  }
  for (const std::size_t tool : tools) {
    for (const std::int8_t direction : {std::int8_t{-1}, std::int8_t{1}})
      volume.setups.push_back(points_of_volume(campaign, poses, tool, direction));
  }
  return volume;
}

/// What a unit of each amplitude makes of the machine, the rest of the model adjusted to it.
struct MemberPrediction {
  Eigen::MatrixXd columns;  ///< three rows per point
  Eigen::VectorXd amplitude;
  Eigen::MatrixXd covariance;
};

/// Less what is common to all points.
void centre(Eigen::MatrixXd& columns) {
  for (auto column : columns.colwise()) {
    auto points = column.reshaped(3, column.size() / 3);
    const Eigen::Vector3d common = points.rowwise().mean();
    points.colwise() -= common;
  }
}

class SetJudge {
 public:
  SetJudge(const ModelState& reached, const FitResult& result)
      : reached_(reached),
        poses_(lattice(reached.model().campaign())),
        volume_(reached.model().campaign(), result, reached.model().noise_groups(),
                {volume_of(reached.model().campaign(), poses_)}),
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
    const auto exceeds = [&set](std::size_t i) {
      return set.members[i].difference >
             std::max(kNoDifference, kCoverageFactor * set.members[i].difference_u);
    };
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
      centre(predictions[i].columns);
    }
    const std::size_t chosen = *set.chosen;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i == chosen) {
        set.members[i].difference = set.members[i].difference_u = 0.0;
      } else if (family(members[i]).effect) {
        state_difference(predictions[chosen], predictions[i],
                         gram.block(first[chosen], first[i], predictions[chosen].amplitude.size(),
                                    predictions[i].amplitude.size()),
                         set.members[i]);
      }
    }
  }

  /// Where it is largest. `between`: of the two members' columns after projection.
  void state_difference(const MemberPrediction& one, const MemberPrediction& other,
                        const Eigen::MatrixXd& between, MemberFinding& member) const {
    const Eigen::VectorXd difference = other.columns * other.amplitude - one.columns * one.amplitude;
    const Eigen::Index points = difference.size() / 3;
    const auto of_point = [&](Eigen::Index i) { return difference.segment<3>(3 * i); };
    Eigen::Index where = 0;
    for (Eigen::Index i = 1; i < points; ++i) {
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
