#include "volcal/identify/text/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace volcal {
namespace {

constexpr std::size_t kLongestName = 200;

double replace_cost(char a, char b) {
  if (a == b) return 0.0;
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return lower(a) == lower(b) ? 0.25 : 1.0;
}

double edit_distance(std::string_view a, std::string_view b) {
  std::vector<double> before(b.size() + 1);
  std::vector<double> previous(b.size() + 1);
  std::vector<double> current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = static_cast<double>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = static_cast<double>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      current[j] = std::min(
          {previous[j] + 1.0, current[j - 1] + 1.0, previous[j - 1] + replace_cost(a[i - 1], b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) current[j] = std::min(current[j], before[j - 2] + 1.0);
    }
    std::swap(before, previous);
    std::swap(previous, current);
  }
  return previous[b.size()];
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates) {
  if (name.size() > kLongestName) return std::nullopt;
  std::optional<std::string> best;
  double smallest = std::max(1.0, std::floor(static_cast<double>(name.size()) / 3.0)) + 0.5;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > kLongestName || candidate == name) continue;
    const double distance = edit_distance(name, candidate);
    if (distance >= smallest) continue;
    smallest = distance;
    best = candidate;
  }
  return best;
}

std::string suggest_name(std::string_view name, std::span<const std::string> candidates,
                         std::string_view what) {
  if (const auto near = nearest_name(name, candidates)) return "did you mean \"" + *near + "\"?";
  return "known " + std::string(what) + ": " + join_names(candidates);
}

std::string join_names(std::span<const std::string> names) {
  constexpr std::size_t kMost = 12;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kMost) text += ", ...";
  return text.empty() ? "none" : text;
}

}  // namespace volcal
