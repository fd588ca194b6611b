#pragma once
/// Uncertainty study of a fitted campaign by Monte Carlo, after GUM Supplement 1 (JCGM 101:2008): what a draw
/// is stands in repeated_campaign.h.
///
/// Three paths to the same estimate: `Linear`, equation (2) drawn among the parameters, one matrix product;
/// `Chord`, readings drawn and (1) solved by steps with an exact gradient (chord_solver.h); `Refit`, readings
/// drawn and the adjustment run again (campaign_refit.h). Every run holds the first two to the third, draw by
/// draw, on a sample.
///
/// Draws are numbered. Their random numbers depend on seed and number alone, and blocks of draws enter the
/// sums in their order, so that the same seed gives the same bits for any number of threads and ranks, and
/// for a run that was interrupted and resumed. A block has 40 batches: that many threads, over all ranks,
/// have work.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/montecarlo/draw_sums.h"
#include "volcal/identify/montecarlo/draw_team.h"
#include "volcal/identify/montecarlo/quantities.h"
#include "volcal/identify/montecarlo/repeated_campaign.h"
#include "volcal/identify/montecarlo/uncertainty_budget.h"

namespace volcal {

enum class DrawPath { Automatic, Linear, Chord, Refit };
std::string_view to_string(DrawPath path);
/// "auto", "linear", "chord", "refit"; "drawn", "fixed". Throw InputError for another word.
DrawPath draw_path(const std::string& word);
FunctionRoughness function_roughness(const std::string& word);

struct MonteCarloOptions {
  DrawPath path = DrawPath::Automatic;  ///< the fastest that the sample of refits supports
  std::uint64_t draws = 0;              ///< 0: as many as the tolerance asks for (7.9)
  int digits = 2;                       ///< significant digits of u that shall be right: 1 or 2
  std::uint64_t most_draws = 10000000;  ///< of an adaptive study
  std::uint64_t seed = 1;
  int threads = 0;        ///< 0 = as many as the machine has
  int refits = 20;        ///< sample on which the paths are compared
  int grid_per_axis = 3;  ///< points of the volume whose errors are listed; 0 = nothing of the volume
  DrawnSources sources;
  std::optional<Conditions> conditions =
      {};                    ///< of table values and the volume; default_conditions() when absent
  DrawTeam* team = nullptr;  ///< that shares the draws; must outlive the study; none = this process alone
};

/// What differs by less is the same in practice, m or rad: a twentieth of the finest increment of
/// controllers.
inline constexpr double kPracticalTolerance = 5e-9;

/// Share of its numerical tolerance by which a value of a path may differ from refits: as 8.2 asks of Monte
/// Carlo.
inline constexpr double kShareOfTolerance = 0.2;

/// How far a path is from refits of the same draws.
struct PathCheck {
  int draws = 0;
  double largest_length = 0.0;  ///< m, over all quantities in m
  double largest_angle = 0.0;   ///< rad, over those in rad
  double largest_share = 0.0;   ///< of the numerical tolerance of a quantity, a fifth of which is allowed and
                                ///< is at least kPracticalTolerance
  std::string where;            ///< the quantity of largest_share
  double seconds = 0.0;         ///< per draw
};

struct RefitCheck {
  PathCheck linear;
  PathCheck chord;
  int not_converged = 0;  ///< refits
};

/// Clause 8: linear propagation is validated when the ends of its interval are within the numerical tolerance
/// of u of those of Monte Carlo. Undecided: the difference exceeds the tolerance by less than the scatter of
/// the ends can explain (kScatter of their standard errors, which allows for thousands of values), or that
/// fewer than kFewestForEnds draws were made; more draws decide.
enum class LinearVerdict { Validated, Undecided, NotValidated };
inline constexpr double kScatter = 4.0;
/// Of fewer draws none is expected beyond an end of a 95 % interval.
inline constexpr std::uint64_t kFewestForEnds = 40;
std::string_view to_string(LinearVerdict verdict);

/// SI.
struct QuantityResult {
  Quantity quantity;
  double u_linear = 0.0;
  double bias_linear = 0.0;
  double u = 0.0;           ///< of the draws; NaN of a single one
  double bias = 0.0;        ///< mean of the draws minus the estimate of the fit
  double bias_error = 0.0;  ///< standard error of the bias
  CoverageInterval linear;  ///< estimate + bias_linear -+ k u_linear
  CoverageInterval symmetric;
  CoverageInterval shortest;
  double tolerance = 0.0;   ///< delta of u for the digits asked for, at least kPracticalTolerance
  double difference = 0.0;  ///< larger of d_low and d_high (8.1)
  double end_error = 0.0;   ///< larger standard error of the two ends
  double scatter = 0.0;     ///< 2 s of the least settled of mean, u and ends (7.9.4)
  LinearVerdict verdict = LinearVerdict::Undecided;
};

struct MonteCarloResult {
  DrawPath path = DrawPath::Linear;
  FunctionRoughness functions = FunctionRoughness::Drawn;
  std::vector<std::string> disturbances;  ///< in words
  std::uint64_t draws = 0;
  std::uint64_t seed = 0;
  int digits = 2;
  bool adaptive = false;
  bool settled = false;            ///< 2 s < delta for all quantities
  std::uint64_t would_settle = 0;  ///< draws that would settle all of them, as far as is known
  std::uint64_t most_draws = 0;    ///< that an adaptive study was allowed
  RefitCheck check;
  std::uint64_t steps = 0;          ///< of the chord path or iterations of refits
  std::uint64_t refitted = 0;       ///< draws that chord steps did not solve
  std::uint64_t not_converged = 0;  ///< draws; they are in the sums
  double to_come = 0.0;  ///< largest bound on what further chord steps would change, standard deviations
  std::vector<QuantityResult> quantities;
  UncertaintyBudget budget;                 ///< rows as `quantities`
  std::vector<StatedCondition> conditions;  ///< that table values and the volume depend on
  std::vector<Finding> condition_findings;  ///< stated in vain or beyond the readings
  std::vector<Finding> contradicted;        ///< of the fit (contradictions(), result.h)
  std::vector<Finding> notes;               ///< on the campaign's files (Campaign::notes)
};

/// One study: made, run block by block, read out.
class MonteCarloStudy {
 public:
  /// `result` must come from fit() of the campaign, without a robust loss; both must outlive the object. The
  /// sample of refits is made here. Throws InputError (repeated_campaign.h), and where ranks of the team do
  /// not compute the same numbers.
  MonteCarloStudy(const Campaign& campaign, const FitResult& result, MonteCarloOptions options);
  ~MonteCarloStudy();

  DrawPath path() const;
  std::uint64_t draws() const;
  /// Draws that the study will take: given; or by the scatter so far, of the first by normal theory, as many
  /// as it may take.
  std::uint64_t expected_draws() const;
  bool done() const;
  void run_block();
  MonteCarloResult result() const;

  /// Of everything that the draws depend on, threads and number of draws left out.
  std::uint64_t fingerprint() const;
  /// State after whole blocks.
  std::string save() const;
  /// Throws std::invalid_argument for a state of another size.
  void restore(const std::string& state);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace volcal
