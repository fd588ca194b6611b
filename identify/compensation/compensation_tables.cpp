#include "volcal/identify/compensation/compensation_tables.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace volcal {
namespace {

/// Piece of `nodes` that q lies in and the share of its upper end; beyond the ends outside 0..1.
struct Piece {
  std::size_t lower = 0;
  double share = 0.0;
};

Piece piece_of(const std::vector<double>& nodes, double q) {
  if (nodes.size() < 2) return {};
  const auto above = std::upper_bound(nodes.begin(), nodes.end(), q);
  const auto place =
      std::clamp<std::ptrdiff_t>(above - nodes.begin(), 1, static_cast<std::ptrdiff_t>(nodes.size()) - 1);
  const auto lower = static_cast<std::size_t>(place - 1);
  return {lower, (q - nodes[lower]) / (nodes[lower + 1] - nodes[lower])};
}

double interpolated(const std::vector<double>& values, const Piece& piece) {
  if (values.size() < 2) return values.empty() ? 0.0 : values.front();
  return values[piece.lower] + piece.share * (values[piece.lower + 1] - values[piece.lower]);
}

}  // namespace

double AxisTable::value(const AxisPosition& at, const ApproachDirection& direction) const {
  double q = at[index_of(input)];
  if (beyond == BeyondEnds::Repeat && position.size() > 1) {
    const double period = position.back() - position.front();
    q -= period * std::floor((q - position.front()) / period);
  }
  Piece piece = piece_of(position, q);
  if (beyond == BeyondEnds::Hold) piece.share = std::clamp(piece.share, 0.0, 1.0);
  const std::int8_t approach = direction[index_of(input)];
  if (approach > 0) return interpolated(forward, piece);
  if (approach < 0) return interpolated(backward, piece);
  return 0.5 * (interpolated(forward, piece) + interpolated(backward, piece));
}

Eigen::Vector3d CorrectionGrid::value(const AxisPosition& at, const ApproachDirection& direction) const {
  std::array<Piece, 3> pieces;
  for (std::size_t i = 0; i < 3; ++i) {
    pieces[i] = piece_of(nodes[i], at[i]);
    pieces[i].share = std::clamp(pieces[i].share, 0.0, 1.0);
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (unsigned corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::size_t index = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool upper = ((corner >> i) & 1U) != 0;
      weight *= upper ? pieces[i].share : 1.0 - pieces[i].share;
      index = index * nodes[i].size() + std::min(pieces[i].lower + (upper ? 1 : 0), nodes[i].size() - 1);
    }
    if (weight == 0.0) continue;
    sum += weight * mean[index];
    for (std::size_t i = 0; i < 3; ++i) {
      if (!half_reversal[i].empty()) sum += weight * direction[i] * half_reversal[i][index];
    }
  }
  return sum;
}

namespace {

Correction moved(AxisName output, double value) {
  Correction correction;
  (is_rotary(output) ? correction.rotary : correction.linear)[direction_of(output)] = value;
  return correction;
}

}  // namespace

CorrectionTerm axis_term(AxisName output, AxisTable table) {
  return [output, table = std::move(table)](const AxisPosition& at, const ApproachDirection& direction) {
    return moved(output, table.value(at, direction));
  };
}

CorrectionTerm product_term(AxisName output, AxisTable table, AxisTable factor) {
  return [output, table = std::move(table), factor = std::move(factor)](const AxisPosition& at,
                                                                        const ApproachDirection& direction) {
    return moved(output, table.value(at, direction) * factor.value(at, direction));
  };
}

CorrectionTerm grid_term(CorrectionGrid grid) {
  return [grid = std::move(grid)](const AxisPosition& at, const ApproachDirection& direction) {
    return Correction{grid.value(at, direction), {0.0, 0.0, 0.0}};
  };
}

Correction CompensationTables::correction(const AxisPosition& position,
                                          const ApproachDirection& direction) const {
  Correction sum;
  for (const CorrectionTerm& term : terms) sum += term(position, direction);
  if (least_increment > 0.0) {
    for (double& component : sum.linear)
      component = std::round(component / least_increment) * least_increment;
  }
  return sum;
}

}  // namespace volcal
