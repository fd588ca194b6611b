#pragma once
/// What the benchmarks share: a clock, the machine, and options as pairs `--name value`.

#include <cstddef>
#include <functional>
#include <map>
#include <string>

namespace volcal::bench {

/// Wall-clock time of the work, s.
double seconds(const std::function<void()>& work);
/// Processor time of this process so far, all threads together, s.
double processor_seconds();
/// Largest resident size of this process so far, bytes.
std::size_t peak_memory();

using OptionTable = std::map<std::string, std::function<void(const std::string& value)>>;

inline auto into(int& target) {
  return [&target](const std::string& value) { target = std::stoi(value); };
}
inline auto into(double& target) {
  return [&target](const std::string& value) { target = std::stod(value); };
}
inline auto into(std::string& target) {
  return [&target](const std::string& value) { target = value; };
}

/// Reads the arguments from `first` on. Throws std::invalid_argument for an option that is not in the table
/// or has no value.
void read_options(int count, char** values, int first, const OptionTable& table);

/// What main() of a benchmark returns: 0, or 1 with the error said.
int run_program(const char* program, const std::function<void()>& work);

}  // namespace volcal::bench
