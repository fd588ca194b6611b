#pragma once
/// Campaigns of simulated correlated noise, and the dense formulas that the fast ones are held to.

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "volcal/identify/noise/restricted_likelihood.h"

namespace volcal::test {

/// Sigma, entry by entry.
inline Eigen::MatrixXd dense_covariance(const NoiseData& data, const std::vector<NoiseParameters>& noise) {
  const auto n = static_cast<Eigen::Index>(data.sigma.size());
  Eigen::MatrixXd sigma = Eigen::MatrixXd::Zero(n, n);
  for (const NoiseSequence& sequence : data.sequences) {
    const NoiseParameters& own = noise[sequence.group];
    for (std::size_t a = 0; a < sequence.observation.size(); ++a) {
      const auto i = static_cast<Eigen::Index>(sequence.observation[a]);
      sigma(i, i) = std::pow(own.white * data.sigma[sequence.observation[a]], 2);
      if (!data.length.empty())
        sigma(i, i) += std::pow(own.per_metre * data.length[sequence.observation[a]], 2);
      for (std::size_t b = 0; b < sequence.observation.size(); ++b) {
        double& entry = sigma(i, static_cast<Eigen::Index>(sequence.observation[b]));
        if (!sequence.time.empty() && own.drift > 0.0)
          entry += own.drift * own.drift * std::exp(-std::abs(sequence.time[a] - sequence.time[b]) / own.tau);
        if (!sequence.line.empty() && sequence.line[a] == sequence.line[b]) entry += own.line * own.line;
      }
    }
  }
  return sigma;
}

/// -1/2 [ log|S| + log|J^T S^-1 J + P| - log|P|_+ + quadratic + (N - p + rank P) log 2 pi ] for a regular P
/// or none and no observation missing; by plain matrix algebra.
inline double dense_log_likelihood(const NoiseProblem& problem, const std::vector<NoiseParameters>& noise) {
  const auto log_det = [](const Eigen::MatrixXd& m) {
    return m.size() > 0 ? 2.0 * Eigen::MatrixXd(m.llt().matrixL()).diagonal().array().log().sum() : 0.0;
  };
  const Eigen::Index n = problem.jacobian.rows(), p = problem.jacobian.cols();
  const Eigen::MatrixXd sigma = dense_covariance(problem.data, noise);
  const Eigen::LLT<Eigen::MatrixXd> factor(sigma);
  const Eigen::MatrixXd weighted = factor.solve(problem.jacobian);
  Eigen::MatrixXd information = problem.jacobian.transpose() * weighted;
  Eigen::VectorXd right = weighted.transpose() * problem.residual;
  double value = log_det(sigma) + problem.residual.dot(factor.solve(problem.residual));
  auto freedom = static_cast<double>(n - p);
  if (problem.prior_precision.size() > 0) {
    information += problem.prior_precision;
    right += problem.prior_precision * problem.prior_mean;
    value += problem.prior_mean.dot(problem.prior_precision * problem.prior_mean);
    value -= log_det(problem.prior_precision);
    freedom += static_cast<double>(p);
  }
  value += log_det(information) - right.dot(information.llt().solve(right));
  return -0.5 * (value + freedom * std::log(2.0 * std::numbers::pi));
}

/// A grid of points measured from several stations, lines along x back and forth: offsets per station and
/// cosines of every coordinate along the beam, `terms` per coordinate and direction.
struct GridPlan {
  int stations = 3;
  Eigen::Vector3i points{12, 5, 5};
  int terms = 3;
  double gap = 3.0;        ///< s between points
  double line_gap = 12.0;  ///< s between lines
  double sigma = 0.4e-6;
  std::size_t group = 0;
};

inline Eigen::Vector3d grid_station(int s) {
  return {-0.3 - 0.2 * (s % 3), 1.6 * (s % 2) - 0.3, -0.4 + 0.5 * (s % 5)};
}

/// Point k of a line, in a unit cube.
inline Eigen::Vector3d grid_point(const GridPlan& plan, int line, int k) {
  const int x = line % 2 == 0 ? k : plan.points(0) - 1 - k;
  const int y = line % plan.points(1);
  const int z = line / plan.points(1);
  return {(x + 0.5) / plan.points(0), (y + 0.5) / plan.points(1), (z + 0.5) / plan.points(2)};
}

inline Eigen::RowVectorXd grid_derivatives(const GridPlan& plan, int s, const Eigen::Vector3d& at,
                                           const Eigen::Vector3d& beam) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(plan.stations + 9 * plan.terms);
  row(s) = 1.0;
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) {
      for (int t = 0; t < plan.terms; ++t) {
        row(plan.stations + (3 * c + d) * plan.terms + t) =
            std::cos(std::numbers::pi * (t + 1) * at(c)) * beam(d) / beam.norm();
      }
    }
  }
  return row;
}

inline void add_grid(const GridPlan& plan, std::mt19937_64& generator, NoiseProblem& problem) {
  std::uniform_real_distribution<double> jitter(0.8, 1.2);
  const Eigen::Index readings = Eigen::Index{plan.stations} * plan.points.prod();
  const int p = plan.stations + 9 * plan.terms;
  const Eigen::Index first = problem.jacobian.rows();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(first + readings, p);
  if (first > 0) rows.topRows(first) = problem.jacobian;
  Eigen::Index i = first;
  for (int s = 0; s < plan.stations; ++s) {
    const Eigen::Vector3d station = grid_station(s);
    NoiseSequence sequence;
    sequence.group = plan.group;
    double time = 1e4 * s;
    for (int line = 0; line < plan.points(1) * plan.points(2); ++line) {
      time += plan.line_gap * jitter(generator);
      for (int k = 0; k < plan.points(0); ++k, ++i) {
        time += plan.gap * jitter(generator);
        const Eigen::Vector3d at = grid_point(plan, line, k);
        const Eigen::Vector3d beam = at - station;
        sequence.observation.push_back(static_cast<std::size_t>(i));
        sequence.time.push_back(time);
        sequence.line.push_back(line);
        problem.data.sigma.push_back(plan.sigma * jitter(generator));
        problem.data.length.push_back(beam.norm());
        rows.row(i) = grid_derivatives(plan, s, at, beam);
      }
    }
    problem.data.sequences.push_back(std::move(sequence));
  }
  problem.jacobian = std::move(rows);
}

/// A draw of the noise of the covariance above, by its definition. Sequences in time order.
inline Eigen::VectorXd draw_noise(const NoiseData& data, const std::vector<NoiseParameters>& noise,
                                  std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd draw = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.sigma.size()));
  for (const NoiseSequence& sequence : data.sequences) {
    const NoiseParameters& own = noise[sequence.group];
    double drift = own.drift * normal(generator);
    std::vector<std::pair<std::int32_t, double>> offsets;
    for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
      const std::size_t i = sequence.observation[k];
      if (k > 0 && !sequence.time.empty()) {
        const double decay = std::exp(-(sequence.time[k] - sequence.time[k - 1]) / own.tau);
        drift = decay * drift + own.drift * std::sqrt(1.0 - decay * decay) * normal(generator);
      }
      double value = own.white * data.sigma[i] * normal(generator) + drift;
      if (!data.length.empty()) value += own.per_metre * data.length[i] * normal(generator);
      if (!sequence.line.empty()) {
        auto found = std::find_if(offsets.begin(), offsets.end(),
                                  [&](const auto& offset) { return offset.first == sequence.line[k]; });
        if (found == offsets.end())
          found = offsets.insert(offsets.end(), {sequence.line[k], own.line * normal(generator)});
        value += found->second;
      }
      draw(static_cast<Eigen::Index>(i)) = value;
    }
  }
  return draw;
}

}  // namespace volcal::test
