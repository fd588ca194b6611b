#pragma once
/// Checks of numeric options that say what is wrong in words: "--threads: -1 must not be negative".

#include <CLI/App.hpp>

namespace volcal::cli {

CLI::Validator not_negative();
CLI::Validator positive();

}  // namespace volcal::cli
