#pragma once
/// Processes that share the draws of a study. Every rank fits the campaign itself and makes a share of the
/// batches of each block; after each block all of them hold the same sums, to the bit those of one process.

#include <cstddef>
#include <string>
#include <vector>

namespace volcal {

class DrawTeam {
 public:
  virtual ~DrawTeam() = default;
  virtual std::size_t rank() const = 0;
  virtual std::size_t size() const = 0;
  /// What every rank gives, by rank, on every rank; all ranks call it equally often.
  virtual std::vector<std::string> gather(const std::string& own) = 0;
};

}  // namespace volcal
