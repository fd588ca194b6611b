#pragma once
/// Search for the noise of one instrument, the others held (noise_estimate.h says how).

#include <array>
#include <optional>
#include <vector>

#include "volcal/identify/noise/noise_estimate.h"
#include "volcal/identify/numeric/bounded_minimum.h"

namespace volcal {

class NoiseSearch {
 public:
  /// `rest`: prior and the shares of all other instruments. `white`: factor that explains the residuals of
  /// `solution` alone; `taken`: observations that the linear model takes.
  NoiseSearch(RestrictedLikelihood& likelihood, std::size_t group, const NoiseOptions& options,
              Eigen::MatrixXd rest, const Eigen::VectorXd& solution, double white, double taken);

  /// The likelihood holds no columns of a model about which the noise was found before: its log information
  /// is linear from there.
  void hold(const NoiseStart& held);
  /// Parameters, evidence and uncertainties; counts its exact evaluations. `previous`: of nearly the same
  /// problem, or without a start.
  void run(InstrumentNoise& result, const InstrumentNoise& previous);
  /// The maximum next to the end of an earlier search, with the terms that stood there.
  struct NearbyMaximum {
    NoiseParameters parameters;
    double gain = 0.0;  ///< of 2 l, by the best of the terms that did not
  };
  NearbyMaximum nearby_maximum(const InstrumentNoise& previous);
  int evaluations() const { return evaluations_; }

 private:
  static constexpr int kTerms = 3;  ///< correlated drift, line, per_metre
  using Active = std::array<bool, kTerms>;

  /// A point of the search with what the next step needs.
  struct Point {
    Eigen::VectorXd at;  ///< log white, log tau; log1p of the scaled variances of the other terms
    Active active{};
    double value = 0.0;            ///< -2 l up to a constant
    double log_information = 0.0;  ///< log|J^T Sigma^-1 J + P|
    Eigen::VectorXd slope;         ///< of log_information
    Eigen::VectorXd residual;      ///< at its solution
  };

  void set_limits(double white, const Eigen::VectorXd& residual);
  void set_moments(const Eigen::VectorXd& residual);
  static double coordinate(double deviation, double scale);
  double coordinate(double deviation) const { return coordinate(deviation, total_); }
  double deviation(double coordinate) const;
  NoiseParameters parameters(const Eigen::VectorXd& at, const Active& active) const;
  Box box(const Active& active) const;
  void evaluate(Point& point);
  void find_slope(Point& point);
  std::vector<double> surrogates(const Point& from, const std::vector<Eigen::VectorXd>& places,
                                 const Active& active);
  ValuesAt surrogate(const Point& from, const Active& active);
  std::vector<Eigen::VectorXd> starts(const Active& active) const;
  Point best_start(const Point& from, const Active& active);
  void refine(Point& point);
  void settle(Point& point);
  Point end_of(const InstrumentNoise& previous);
  Point without(const Point& point, int term);
  Point with(const Point& point, int term);
  Point search(InstrumentNoise& result);
  std::optional<Point> resume(InstrumentNoise& result, const InstrumentNoise& previous);
  double held_information(const Eigen::VectorXd& at, const Active& active) const;
  Eigen::VectorXd held_slope(const Point& point) const;
  Eigen::VectorXd moved(const Eigen::VectorXd& at, Eigen::Index parameter, double shift) const;
  void find_uncertainty(const Point& point, InstrumentNoise& result);

  RestrictedLikelihood& likelihood_;
  std::size_t group_;
  const NoiseOptions& options_;
  Eigen::MatrixXd rest_;
  std::optional<NoiseStart> held_;
  Eigen::VectorXd lower_, upper_;
  Active possible_{};
  Point white_;            ///< where the search begins
  double total_ = 0.0;     ///< standard deviation of the residuals
  double correlated_ = 0;  ///< share of their variance
  double mean_length_ = 0.0;
  int evaluations_ = 0;
};

}  // namespace volcal
