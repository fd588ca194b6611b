#pragma once
/// Files that a command writes one by one.

#include <string>
#include <vector>

namespace volcal::cli {

/// Throws InputError where `output` is one of the files that are read and would be overwritten; empty names
/// do not count.
void require_no_input(const std::string& output, const std::vector<std::string>& inputs,
                      const std::string& remedy);

}  // namespace volcal::cli
