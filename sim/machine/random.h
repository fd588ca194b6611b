#pragma once
/// Random numbers that repeat to the bit for a seed, on every platform and in any order of use: each purpose
/// has its own stream, named by a label, and the normal transform is our own (Box and Muller 1958).

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string_view>

namespace volcal::sim {

class RandomStream {
 public:
  /// Streams of different labels are independent; `label` names the purpose, e.g. "noise of S1".
  RandomStream(std::uint64_t seed, std::string_view label);

  double uniform();                         ///< in [0, 1)
  double uniform(double low, double high);  ///< in [low, high)
  double normal();                          ///< mean 0, standard deviation 1
  double sign();                            ///< -1 or +1, equally likely
  Eigen::Vector3d normal_vector();          ///< independent components

 private:
  std::mt19937_64 engine_;
};

}  // namespace volcal::sim
