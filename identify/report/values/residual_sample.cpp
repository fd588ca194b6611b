#include "volcal/identify/report/values/residual_sample.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "volcal/identify/statistics/even_sample.h"

namespace volcal::report {
namespace {

constexpr std::size_t kWorst = 300;  ///< largest |w| that are always shown

}  // namespace

bool is_suspect(const ResidualRecord& record) { return record.flagged || record.removed; }

std::vector<std::size_t> residual_sample(const std::vector<ResidualRecord>& residuals, std::size_t limit) {
  std::vector<std::size_t> order(residuals.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (residuals.size() <= limit) return order;

  const auto marked = [&](std::size_t i) { return is_suspect(residuals[i]); };
  const auto flagged = static_cast<std::size_t>(std::ranges::count_if(order, marked));
  const std::size_t kept = std::min(limit / 2, flagged + kWorst);
  const auto worse = [&](std::size_t a, std::size_t b) {
    if (marked(a) != marked(b)) return marked(a);
    const double wa = std::abs(residuals[a].w);
    const double wb = std::abs(residuals[b].w);
    return wa != wb ? wa > wb : a < b;
  };
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(kept), worse);
  std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(kept),
                   order.begin() + static_cast<std::ptrdiff_t>(limit), order.end(),
                   [](std::size_t a, std::size_t b) { return scrambled(a) < scrambled(b); });
  order.resize(limit);
  std::ranges::sort(order);
  return order;
}

}  // namespace volcal::report
