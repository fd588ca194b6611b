#pragma once
/// The closed loop counted: simulated machines whose error functions lie outside every fitted basis, measured
/// by the tracer campaign of sim/measurement/measurements.h, identified with automatic resolution and judged
/// on fresh points and on the truth in the datum of the tables. Campaign i has structure i mod 4 of
/// sim::reference_machines() and seed `seed` + i.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace volcal::studies {

struct ClosedLoopOptions {
  int campaigns = 20;
  std::uint64_t seed = 1;
  std::array<int, 3> grid{9, 7, 6};  ///< positions of a run per axis; 9 x 7 x 6 gives 6,048 readings
  bool fixed_knots = false;          ///< fit five fixed sets of knot intervals as well
  /// Besides independent noise, readings drift slowly (0.4 um, 600 s) and lines have offsets (0.2
  /// um); white weights are fitted as well.
  bool correlated_noise = false;
  /// The laser's scale (0.3 um/m) and the tools' offsets (3 um) are wrong by what the campaign states, drawn
  /// anew for every campaign.
  bool shared_sources = false;
  int threads = 0;  ///< 0 = all; results do not depend on it
  std::function<void(int done, int all)> progress;
};

/// Knot intervals of X, Y, Z of the five fixed sets.
inline constexpr std::array<std::array<int, 3>, 5> kFixedKnotSets = {
    {{5, 4, 3}, {7, 5, 4}, {8, 6, 5}, {9, 7, 6}, {12, 9, 8}}};

struct ClosedLoopCampaign {
  std::string structure;
  double longest_travel = 0.0;  ///< m
  std::uint64_t seed = 0;
  double rms_before = 0.0;  ///< m, sqrt(mean |e|^2) at 400 fresh points after rigid alignment
  double rms_after = 0.0;
  double reduced_chi2 = 0.0;                              ///< of the readings, with the stated sigma
  std::array<double, kFixedKnotSets.size()> rms_fixed{};  ///< NaN when not asked for
  std::map<std::string, double> coverage;  ///< per symbol: share of table values whose U95 holds the truth
  std::map<std::string, double> white_coverage;  ///< of a fit with white weights; empty when not asked for
  double white_rms_after = 0.0;                  ///< m; NaN when not asked for

  double best_fixed() const;
};

/// Mean over the symbols.
double mean_coverage(const std::map<std::string, double>& coverage);

/// In the order of the campaigns. Repeatable to the bit.
std::vector<ClosedLoopCampaign> closed_loop(const ClosedLoopOptions& options);

}  // namespace volcal::studies
