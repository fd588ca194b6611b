#pragma once
/// Checks of options that say what is wrong in words: "--threads: -1 must not be negative".

#include <CLI/App.hpp>
#include <span>
#include <string_view>

namespace volcal::cli {

/// Finite, and at most `most`; without it below any bound that a campaign could need.
CLI::Validator not_negative();
CLI::Validator not_negative(double most);
CLI::Validator positive();
CLI::Validator positive(double most);
/// 0 to as many as thread_count() gives.
CLI::Validator number_of_threads();
/// One of these words.
CLI::Validator one_of(std::span<const std::string_view> words);

}  // namespace volcal::cli
