#pragma once
/// Readings that were not taken: what the candidates share.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/proposals/candidates/candidate_measurements.h"

namespace volcal {

/// Its multiples, modulo one, spread evenly and on no grid.
inline constexpr double kGoldenShare = 0.6180339887498949;
inline constexpr double kPause = 600.0;  ///< s, between setups

/// Rows of a setup spread over its whole extent, about `count` of them: whole lines where the setup has
/// lines, in their order of measurement.
std::vector<std::size_t> spread_rows(const Setup& setup, std::size_t count);

/// Temperatures that hypothetical readings have.
enum class Temperatures {
  Last,   ///< every channel stays where it was last
  First,  ///< every channel is back where the campaign began
};

/// A further setup like `setup`, `later_s` after the end of the campaign: its instrument, tool, station and
/// keys, spread_rows() of it with their positions and directions, taken one after another. No statement of a
/// prior is made twice.
ExtraMeasurement taken_again(const CandidateContext& context, const Setup& setup, const std::string& name,
                             std::string words = {}, double later_s = kPause,
                             Temperatures temperatures = Temperatures::Last);

/// The setups of all stations taken again with other readings of the axes. `alter` changes those of an axis,
/// and says how; empty: it does not. `words`: of a place and what was changed there.
std::vector<ExtraMeasurement> altered_again(
    const CandidateContext& context, const std::string& suffix,
    const std::function<std::string(const Setup& measured, const Axis& axis, Readings& again)>& alter,
    const std::function<std::string(const std::string& place, const std::string& changes)>& words);

/// First setup of every station (instruments that have stations), else of every setup.
std::vector<const Setup*> one_setup_per_station(const Campaign& campaign);
/// "P1", or the setup's name where there is no station.
std::string place_name(const Setup& setup);
/// "P1 with tool short"
std::string place_and_tool(const Campaign& campaign, const Setup& setup);
/// Last time of the campaign, s; 0 without times.
double end_of(const Campaign& campaign);
/// Fills times, temperatures and the nominal reading columns of a setup whose positions are set.
void complete_readings(const CandidateContext& context, double start_s, double seconds_per_reading,
                       Temperatures temperatures, std::size_t channels, Readings& readings);

}  // namespace volcal
