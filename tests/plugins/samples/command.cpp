// A sample: prints one line.
#include "volcal/identify/cli/command.h"

#include <fmt/format.h>

#include <CLI/App.hpp>

namespace volcal::cli {
namespace {

std::function<int()> define_sample(CLI::App& /*app*/) {
  return [] {
    fmt::print("a sample\n");
    return kDone;
  };
}

}  // namespace

const Command& sample_command() {
  static const Command command = {"sample", "prints one line", "  volcal sample\n", define_sample};
  return command;
}

}  // namespace volcal::cli
