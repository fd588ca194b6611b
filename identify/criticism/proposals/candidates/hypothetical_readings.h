#pragma once
/// Readings that were not taken: what the entries of the menu share.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/proposals/candidates/candidate_measurements.h"

namespace volcal {

/// Rows of a setup spread over its whole extent, about `count` of them: whole lines where the setup has
/// lines, in their order of measurement.
std::vector<std::size_t> spread_rows(const Setup& setup, std::size_t count);

/// Temperatures that hypothetical readings have.
enum class Temperatures {
  Last,   ///< every channel stays where it was last
  First,  ///< every channel is back where the campaign began
};

/// A further setup like `setup`: its instrument, tool, station and keys, the given rows with their positions
/// and directions, taken one after another from `start_s` on. No statement of a prior is made twice.
Setup continued_setup(const CandidateContext& context, const Setup& setup,
                      const std::vector<std::size_t>& rows, const std::string& name, double start_s,
                      Temperatures temperatures);

/// First setup of every station (instruments that have stations), else of every setup.
std::vector<const Setup*> one_setup_per_station(const Campaign& campaign);
/// "P1", or the setup's name where there is no station.
std::string place_name(const Setup& setup);
/// "P1 with tool short"
std::string place_and_tool(const Campaign& campaign, const Setup& setup);
/// Last time of the campaign, s; 0 without times.
double end_of(const Campaign& campaign);
/// Its multiples, modulo one, spread evenly and on no grid.
inline constexpr double kGoldenShare = 0.6180339887498949;
inline constexpr double kPause = 600.0;  ///< s, between setups

/// Fills times, temperatures and the nominal reading columns of a setup whose positions are set.
void complete_readings(const CandidateContext& context, double start_s, double seconds_per_reading,
                       Temperatures temperatures, std::size_t channels, Readings& readings);

}  // namespace volcal
