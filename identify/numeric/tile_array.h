#pragma once
/// Memory for the numbers that vector loops read and write.

#include <cstddef>
#include <vector>

#include "volcal/identify/numeric/tile_kernel.h"

namespace volcal {

/// The least multiple of kTileAlignment that holds `size` numbers.
inline std::ptrdiff_t whole_lines(std::ptrdiff_t size) {
  return (size + kTileAlignment - 1) / kTileAlignment * kTileAlignment;
}

/// Array of doubles that starts at a cache line.
class TileArray {
 public:
  /// Sets all to zero.
  void resize(std::ptrdiff_t size) {
    lines_.assign(static_cast<std::size_t>(whole_lines(size)) / kTileAlignment, {});
  }
  double* data() { return lines_.data()->values; }
  const double* data() const { return lines_.data()->values; }
  /// Filled up to whole lines.
  std::size_t size() const { return lines_.size() * kTileAlignment; }

 private:
  struct alignas(kTileAlignment * sizeof(double)) Line {
    double values[kTileAlignment];
  };
  std::vector<Line> lines_;
};

}  // namespace volcal
