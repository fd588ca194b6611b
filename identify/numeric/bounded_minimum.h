#pragma once
/// Minimum of a smooth function of a few variables inside a box, from values alone: quasi-Newton (BFGS,
/// damped as in Nocedal and Wright 2006, Numerical Optimization, procedure 18.2) with differences as
/// gradient, one-sided at first and central in the end, and variables at a bound held while the descent
/// points outwards.

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace volcal {

struct Box {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;  ///< equal to lower = held
};

struct Minimum {
  Eigen::VectorXd at;
  double value = 0.0;
};

/// Variables should be of size one (logarithms): differences are 1e-4, no step exceeds 2. Ends when a step
/// promises less than `tolerance`. A local minimum: the start decides which.
Minimum bounded_minimum(const std::function<double(const Eigen::VectorXd&)>& function,
                        const Eigen::VectorXd& start, const Box& box, double tolerance,
                        int most_iterations = 40);

/// A function of which several values together take less than one by one.
using ValuesAt = std::function<std::vector<double>(const std::vector<Eigen::VectorXd>& places)>;
Minimum bounded_minimum(const ValuesAt& function, const Eigen::VectorXd& start, const Box& box,
                        double tolerance, int most_iterations = 40);

}  // namespace volcal
