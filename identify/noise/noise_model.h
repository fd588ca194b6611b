#pragma once
/// Correlated noise of measurements, and the filter that makes it white.
///
/// A sequence holds the observations of one setup, run and channel in time order; different sequences are
/// independent. Within a sequence
///
///   Sigma_ij = delta_ij (white^2 sigma_i^2 + per_metre^2 L_i^2) + drift^2 exp(-|t_i - t_j| / tau)
///            + line^2 [i and j belong to the same line]
///
/// The exponential is an Ornstein-Uhlenbeck process, hence Markovian (Rasmussen and Williams 2006, Gaussian
/// Processes for Machine Learning, appendix B), and the offset of a line is constant while the line lasts. A
/// Kalman filter with these states therefore gives the innovations of Sigma exactly: divided by their
/// standard deviations they are L^-1 v with Sigma = L L^T in the order of the filter, and log|Sigma| is the
/// sum of log F_i (Harvey 1989, Forecasting, Structural Time Series Models and the Kalman Filter, 3.4).
///
/// Two states suffice while lines follow one another. A line that is resumed after another began keeps its
/// state until its last observation: exact as well, with cost growing with the number m of lines open at
/// once, O(N m^2) for the gains and O(N m) per column. A sequence without times has no correlated drift and
/// is taken line by line.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "volcal/identify/noise/filter_rows.h"

namespace volcal {

/// Of one instrument. SI: lengths in m (angles in rad), tau in s.
struct NoiseParameters {
  double white = 1.0;      ///< factor on the stated sigma
  double drift = 0.0;      ///< standard deviation; 0 = off
  double tau = 600.0;      ///< correlation time of the drift, s
  double line = 0.0;       ///< standard deviation of the offset that the readings of a line share; 0 = off
  double per_metre = 0.0;  ///< m/m, independent per reading

  bool operator==(const NoiseParameters&) const = default;
};

/// Observations of one setup, run and channel. Need not be sorted.
struct NoiseSequence {
  std::vector<std::size_t> observation;  ///< rows of the columns to whiten
  std::vector<double> time;              ///< s, per observation; empty = not known: no correlated drift
  std::vector<std::int32_t> line;        ///< per observation; empty = not known: no line offsets
  std::size_t group = 0;                 ///< instrument: index of its parameters
};

/// What the noise model knows about N observations.
struct NoiseData {
  std::vector<NoiseSequence> sequences;  ///< every observation in exactly one
  std::vector<double> sigma;   ///< stated standard deviation, m or rad; infinite = left out (missing)
  std::vector<double> length;  ///< m, for the part proportional to length; empty = none
};

/// Columns that are whitened side by side.
inline constexpr Eigen::Index kColumnBlock = 64;

/// L^-1 of a noise model. Errors: std::invalid_argument for sizes that do not agree, an observation in no or
/// in two sequences, a sigma that is not positive, negative parameters, tau <= 0 with correlated drift.
class Whitener {
 public:
  Whitener(const NoiseData& data, std::span<const NoiseParameters> parameters);

  /// New parameters for the same observations: O(N).
  void set_parameters(std::span<const NoiseParameters> parameters);

  /// whitened = L^-1 columns, rows = observations; rows of missing observations become 0. Exact to rounding,
  /// O(N) per column, the same for any number of threads. Both may be the same matrix.
  void whiten(const Eigen::MatrixXd& columns, Eigen::MatrixXd& whitened, int threads) const;
  Eigen::VectorXd whiten(const Eigen::VectorXd& column) const;
  /// Sigma^-1 column: L^-T of what whiten() gives; O(N).
  Eigen::VectorXd weigh(const Eigen::VectorXd& column) const;
  /// L^-T column, by the filter's adjoint, run backwards; O(N). Of missing observations it is what `column`
  /// is.
  Eigen::VectorXd whiten_transposed(Eigen::VectorXd column) const;
  /// Rows [first, first + columns.rows()) alone, which hold whole sequences: their observations that are not
  /// missing, sequence by sequence, in the order of the filters. On the caller's thread.
  Eigen::MatrixXd whiten_part(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// The same into `whitened`, which has the size.
  void whiten_part(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                   Eigen::Ref<Eigen::MatrixXd> whitened) const;
  /// whiten_part() into `whitened`, which has the size, and Sigma^-1 of the columns, observation by
  /// observation: `weighed` becomes whole_lines(columns) x (observations in use), 0 beyond the columns. At
  /// most kColumnBlock columns.
  void weigh_part(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                  Eigen::Ref<Eigen::MatrixXd> whitened, Eigen::MatrixXd& weighed) const;
  /// Observations in the order of what whiten_part() and weigh_part() give.
  std::vector<std::size_t> order_of_part(std::size_t first, Eigen::Index rows) const;

  /// rows Sigma^-1 rows^T, full symmetric, for `rows` (columns x observations, the transpose of what whiten()
  /// takes), without storing the whitened matrix.
  Eigen::MatrixXd gram(const Eigen::Ref<const Eigen::MatrixXd>& rows, int threads) const;

  /// Makes the columns (as those of `rows`) of observations as the filter comes to them; called from several
  /// threads at once.
  using MakeColumns =
      std::function<void(const std::vector<std::size_t>& observations, Eigen::Ref<Eigen::MatrixXd> columns)>;
  struct GroupGram {
    Eigen::MatrixXd gram;  ///< width x width, full symmetric
    std::size_t observations = 0;
  };
  /// gram() of one group's observations, with nothing of their number stored.
  GroupGram gram_of_group(std::size_t group, Eigen::Index width, const MakeColumns& make, int threads) const;

  /// log|Sigma| + |L^-1 column|^2 of several noise models of the only group, eight in the time of one or two
  /// by set_parameters() and whiten(), and equal to those to rounding; what the class holds stays. The same
  /// for any number of threads. Throws std::invalid_argument where has_open_lines(), or of several groups.
  std::vector<double> misfits(std::span<const NoiseParameters> noises, const Eigen::VectorXd& column,
                              int threads) const;
  /// Lines are resumed after others began.
  bool has_open_lines() const;

  /// log|Sigma| of the observations that are not missing.
  double log_determinant() const { return log_determinant_; }
  /// Not missing.
  std::size_t observations() const { return observations_; }

 private:
  struct Step {
    std::size_t observation;
    double gap;     ///< s since the step before; infinite at the start of a sequence
    int slot;       ///< state that holds the offset of its line, 0 = no line
    bool opens;     ///< first observation of its line
    double sigma;   ///< stated
    double length;  ///< m
  };
  /// A sequence in the order of its filter; state 0 is the correlated drift, the others offsets of open
  /// lines.
  struct Track {
    std::vector<Step> steps;
    std::size_t group = 0;
    int states = 1;
    bool timed = false;
    bool independent = false;  ///< neither correlated drift nor line offsets: whitening only divides
    std::size_t first = std::numeric_limits<std::size_t>::max();  ///< lowest and highest observation
    std::size_t last = 0;
    std::vector<double> decay;  ///< of the correlated drift since the step before
    std::vector<double> scale;  ///< 1 / sqrt(F)
    std::vector<double> gain;   ///< states x steps
  };

  static Track make_track(const NoiseData& data, const NoiseSequence& sequence);
  static void assign_slots(const NoiseSequence& sequence, const std::vector<std::size_t>& order,
                           Track& track);
  template <int kStates>
  static double compute_gains(const NoiseParameters& noise, Track& track);
  /// In place on a tile of steps [begin, end): `width` values per step.
  static void filter(const Track& track, std::size_t begin, std::size_t end, Eigen::Index width, double* tile,
                     double* state);
  /// Adjoint of filter() on whitened rows of the whole track, in place: L^-T.
  static void filter_adjoint(const Track& track, Eigen::Index width, double* rows);
  /// `models`, `misfits`: of several noise models side by side (noise_misfits.cpp).
  static void find_misfits(const Track& track, const double* models, const double* column, double* misfits);
  static FilterStep filter_step(const Track& track, std::size_t i);
  /// Offsets that are held while that of the step's own line is seen: their state and gain / scale.
  template <class Visit>
  static void visit_held_offsets(const Track& track, std::size_t i, const Visit& visit);
  /// Columns where a track finds its observations and leaves them.
  struct Place {
    const double* in;
    Eigen::Index in_stride;
    double* out;
    Eigen::Index out_stride;
    double* rows;        ///< keeps whitened rows, whole lines of the columns each; null = nowhere
    std::size_t origin;  ///< observation of the first row of `in`
    bool packed;         ///< steps leave one after another; else at their observations
  };
  /// whiten_block() of independent observations.
  static void scale_block(const Track& track, Eigen::Index width, const Place& place);
  static void whiten_block(const Track& track, Eigen::Index width, const Place& place);
  std::vector<const Track*> tracks_of_part(std::size_t first, Eigen::Index rows) const;
  template <class Fill>
  static void add_gram(const Track& track, Eigen::Index width, const Fill& fill, Eigen::MatrixXd& sum);
  /// `fill(track, begin, end, tile)` makes the columns of steps.
  template <class Fill>
  static Eigen::MatrixXd sum_of_grams(const std::vector<const Track*>& tracks, Eigen::Index width,
                                      const Fill& fill, int threads);

  std::vector<Track> tracks_;
  std::vector<std::size_t> missing_;
  std::size_t rows_ = 0;
  std::size_t observations_ = 0;
  std::size_t groups_ = 0;
  double log_determinant_ = 0.0;
};

}  // namespace volcal
