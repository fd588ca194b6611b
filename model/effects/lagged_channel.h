#pragma once
/// A temperature channel behind a lumped thermal mass: what follows it late.

#include <Eigen/Core>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "volcal/model/effects/formula_effect.h"

namespace volcal {

bool has_time_and_channel(const Setup& setup, const std::string& channel);
/// Throws InputError where the campaign lacks one of them.
void check_time_and_channel(const Campaign& campaign, const std::string& channel, const std::string& label,
                            const SourcePlace& place);

/// Lagged temperatures of one setup's rows by channel and lag: effects on several targets ask for the same
/// ones, and each is made of the whole campaign's channel. For several threads at once. Memory: 8 bytes x
/// rows x at most kMost.
class KeptHistories {
 public:
  using Values = std::shared_ptr<const Eigen::VectorXd>;
  static constexpr std::size_t kMost = 48;  ///< then it begins anew

  Values find(const std::string& channel, double lag) const;
  void keep(const std::string& channel, double lag, Values values);

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, double>, Values> known_;
};

/// Per reading of a setup, the lagged temperature less 20 degC: y with lag y' = T - y from the first reading
/// of the campaign's channel on, T linear between readings; 0 where time or channel were not recorded. `lag`:
/// s.
Eigen::VectorXd lagged_excess(const SetupView& view, const std::string& channel, double lag);

/// How an effect depends on what a channel was before; its shape is the time constant, added by the kind.
struct ChannelHistory {
  std::string label;  ///< "late by air", behind what is moved
  EffectDriver driver;
  std::string shape;  ///< "lag"
  Eigen::VectorXd (*values)(const SetupView& view, const std::string& channel, double time_constant);
};
/// Of the error motion, or the tool, that a table with key `temperature` is about.
std::unique_ptr<FormulaEffect> motion_by_history(const EffectTable& table, const ChannelHistory& history);
std::unique_ptr<FormulaEffect> tool_by_history(const EffectTable& table, const ChannelHistory& history);

/// Candidates where times are recorded: rotations, since displacements are scale, straightness or the tool's,
/// by every channel; the tool by every channel.
std::vector<EffectSpec> rotations_by_history(const Campaign& campaign, const std::string& kind);
std::vector<EffectSpec> tools_by_history(const Campaign& campaign, const std::string& kind);

}  // namespace volcal
