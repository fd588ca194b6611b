#pragma once
/// Committed files against files made anew.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace volcal::testing {

inline constexpr double kLastDigits = 2.5e-7;  // two of the seventh decimal, with which lengths are written

inline std::set<std::string> files_below(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename() != ".volcal") {
      names.insert(std::filesystem::relative(entry.path(), folder).string());
    }
  }
  return names;
}

inline std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> all;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of(", \n[]", begin), text.size());
    all.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return all;
}

inline bool same_word(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char* end_a = nullptr;
  char* end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a);
  const double y = std::strtod(b.c_str(), &end_b);
  return !a.empty() && !b.empty() && *end_a == '\0' && *end_b == '\0' &&
         std::abs(x - y) <= kLastDigits * std::max(1.0, std::abs(x) * 1e-3);
}

/// Word by word; numbers may differ in their last digits.
inline void expect_same_numbers(const std::string& name, const std::string& committed,
                                const std::string& made) {
  const auto expected = words(committed);
  const auto found = words(made);
  ASSERT_EQ(expected.size(), found.size()) << name;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_TRUE(same_word(expected[i], found[i])) << name << ": " << expected[i] << " became " << found[i];
  }
}

}  // namespace volcal::testing
