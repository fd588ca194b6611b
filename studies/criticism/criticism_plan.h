#pragma once
/// The campaigns over which model criticism is counted. Campaign i of a row is a pure function of the row and
/// of seed + i: structure, layout, noise and what is hidden.
///
///   null      nothing is hidden; five kinds of noise take turns
///   listed    one effect of the catalogue
///   unlisted  one effect that is in no catalogue
///   pairs     two effects of the catalogue
///   left-out  one effect of the catalogue, whose kind the diagnosis does not know
///   partial   one effect of the catalogue, measured with ball-bar circles or body diagonals alone
///   shared    one cause with one amplitude in several places
///   axes      one cause with one amplitude on all linear axes
///   behind    one effect that is in no catalogue and one of the catalogue
///   rotary    one effect of rotary axes that the catalogue has, on machines of four structures
///   rotary-null     nothing is hidden in a machine with rotary axes; five kinds of noise take turns
///   rotary-missing  nothing is hidden, and the model that is diagnosed has no errors of rotary axes
///   mdb       three effects at 0.7, 1 and 1.3 times the amplitude that is found with 80 % power

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "volcal/model/description/model_spec.h"
#include "volcal/sim/study.h"
#include "volcal/studies/criticism/criticism_names.h"

namespace volcal::studies {

/// Names of the rows, in the order of the table.
std::span<const std::string> criticism_rows();
/// Nothing is hidden; the kinds of noise take turns.
bool is_null_row(const std::string& row);
/// "white", "drift", "line", "drift+line", "mixed" (correlated drift, line offsets and 0.3 % outliers).
std::span<const std::string> criticism_noises();

struct PlannedEffect {
  sim::HiddenEffect effect;  ///< without amplitude
  /// |g~ a|, visible signal to noise, that its amplitude is to have; 0 = `rms` counts
  double signal = 0.0;
  double rms = 0.0;  ///< m, on the readings
};

struct PlannedCampaign {
  std::string row;
  int index = 0;
  std::string layout;  ///< "4 stations, 2 tools, shuffled"
  std::string noise;
  sim::Study study;  ///< nothing hidden yet
  std::vector<PlannedEffect> hidden;
  ModelSpec given;                     ///< the model that is diagnosed
  std::vector<std::string> leave_out;  ///< kinds that the diagnosis does not know
};

/// `readings`: wanted; the grid of positions is the nearest. `attempt` draws the hidden effects anew, layout
/// and noise staying as they are; the kinds stay for kAttemptsPerKind attempts, then the next ones come.
inline constexpr int kAttemptsPerKind = 6;
PlannedCampaign plan_campaign(const std::string& row, int index, std::uint64_t seed, int readings,
                              int attempt);

}  // namespace volcal::studies
