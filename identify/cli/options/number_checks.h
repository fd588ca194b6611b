#pragma once
/// Checks of numeric options that say what is wrong in words: "--threads: -1 must not be negative".

#include <CLI/App.hpp>

namespace volcal::cli {

/// Finite, and at most `most`; without it below any bound that a campaign could need.
CLI::Validator not_negative();
CLI::Validator not_negative(double most);
CLI::Validator positive();
CLI::Validator positive(double most);
/// 0 to as many as thread_count() gives.
CLI::Validator number_of_threads();

}  // namespace volcal::cli
