#include "volcal/identify/result/fitted_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <sstream>

#include "volcal/identify/numeric/content_hash.h"

namespace volcal {
namespace {

std::uint64_t hash_of_row(const Setup& setup, std::size_t row) {
  ContentHash hash;
  hash.add(std::string_view(setup.instrument));
  for (const std::vector<double>& position : setup.readings.position) {
    if (!position.empty()) hash.add(position[row] + 0.0);  // -0 is 0
  }
  for (const std::vector<double>& value : setup.readings.value) hash.add(value[row] + 0.0);
  return hash.value();
}

std::string digits(std::uint64_t number) { return fmt::format("{:016x}", number); }

/// Of a setup: its rows, and those that no fit of it saw.
struct RowHashes {
  std::uint64_t in_use = 0;  ///< their sum
  std::size_t count = 0;     ///< of rows in use
  std::vector<std::string> left_out;

  explicit RowHashes(const Setup& setup) {
    const std::vector<bool> unused = setup.rows_left_out();
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const std::uint64_t hash = hash_of_row(setup, row);
      if (unused[row]) {
        left_out.push_back(digits(hash));
      } else {
        in_use += hash;
        ++count;
      }
    }
    std::ranges::sort(left_out);
  }
};

std::uint64_t sum_of(const std::vector<std::string>& hashes) {
  std::uint64_t sum = 0;
  for (const std::string& hash : hashes) sum += std::stoull(hash, nullptr, 16);
  return sum;
}

/// What a fingerprint says.
struct FittedRows {
  std::string in_use;
  std::vector<std::string> left_out;

  explicit FittedRows(const std::string& fingerprint) {
    std::istringstream words(fingerprint);
    words >> in_use;
    for (std::string hash; words >> hash;) left_out.push_back(hash);
  }
};

bool is_hash(const std::string& text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// Rows in use that the fit left out; nothing where it was made from other readings.
std::optional<std::size_t> not_fitted_rows(const RowHashes& own, const FittedRows& fitted) {
  if (!is_hash(fitted.in_use) || !std::ranges::all_of(fitted.left_out, is_hash)) return {};
  if (digits(own.in_use) == fitted.in_use) return 0;
  const std::uint64_t whole = own.in_use + sum_of(own.left_out);
  if (whole != std::stoull(fitted.in_use, nullptr, 16) + sum_of(fitted.left_out)) return {};
  std::vector<std::string> left_out_by_the_fit_alone;
  std::ranges::set_difference(fitted.left_out, own.left_out, std::back_inserter(left_out_by_the_fit_alone));
  return left_out_by_the_fit_alone.size();
}

}  // namespace

std::string readings_fingerprint(const Setup& setup) {
  const RowHashes rows(setup);
  if (rows.count == 0) return {};
  std::string text = digits(rows.in_use);
  for (const std::string& hash : rows.left_out) text += " " + hash;
  return text;
}

FittedReadings fitted_readings(const Campaign& campaign, const FitResult& result) {
  FittedReadings fitted;
  fitted.is_known = std::ranges::any_of(result.setups,
                                        [](const SetupSummary& setup) { return !setup.fingerprint.empty(); });
  for (const Setup& setup : campaign.setups) {
    const RowHashes own(setup);
    fitted.all += own.count;
    for (const SetupSummary& summary : result.setups) {
      const auto not_fitted = not_fitted_rows(own, FittedRows(summary.fingerprint));
      if (!not_fitted || *not_fitted >= own.count) continue;
      fitted.setups.push_back(setup.name);
      fitted.readings += own.count - *not_fitted;
      fitted.left_out += *not_fitted;
      break;
    }
  }
  return fitted;
}

}  // namespace volcal
