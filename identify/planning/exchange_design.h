#pragma once
/// Exact designs by exchange: of a pool of candidates, the given number that makes a criterion smallest.
///
/// The candidates that help least are exchanged for those outside that help most, many pairs at once as long
/// as that lowers the criterion, then fewer, down to single pairs (Fedorov 1972, Theory of Optimal
/// Experiments, 3.3; several at once: Cook and Nachtsheim 1980, Technometrics 22, 315). A candidate may be
/// taken up to `capacity` times; with capacity 1 these are designs of bounded density, whose optimum
/// separates candidates by their rate of gain (Wynn 1982, in Statistical Decision Theory and Related Topics
/// III, 471): none outside gains more than any inside.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "volcal/identify/planning/design_criterion.h"

namespace volcal {

/// Readings that can be taken. Candidate i is the observations first[i] ... first[i + 1].
struct DesignPool {
  Eigen::MatrixXd rows;  ///< observations x parameters, each divided by its standard deviation
  std::vector<Eigen::Index> first;
  int capacity = 1;

  std::size_t candidates() const { return first.size() - 1; }
};

struct ExchangeResult {
  std::vector<int> taken;  ///< per candidate, 0 ... capacity
  double value = 0.0;      ///< of the criterion
  int exchanges = 0;       ///< pairs
  bool converged = false;  ///< no exchange of the most promising pairs helps
};

struct ExchangeOptions {
  std::vector<int> kept;  ///< per candidate, how often it is taken in any case; empty = none
  int threads = 1;        ///< the result does not depend on it
  int most_rounds = 200;
  std::function<void(double done)> progress;
};

/// `base`: precision of what is known without the pool; together with any design it must be positive
/// definite. Throws std::invalid_argument when the pool cannot give `count` candidates or a size does not
/// agree.
ExchangeResult exchange_design(const DesignPool& pool, const Eigen::MatrixXd& base,
                               const DesignCriterion& criterion, std::size_t count,
                               const ExchangeOptions& options = {});

}  // namespace volcal
