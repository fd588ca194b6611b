#pragma once
/// Runs the renderers of a report under Node, without a browser (identify/report/web/test).

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/scratch_folder.h"

namespace volcal::test {

struct Drawing {
  bool possible = true;  ///< false: no Node here
  int exit_code = -1;
  std::string output;  ///< "11 sections, 26 plots" and lines "opens on Time", or what is wrong
};

inline Drawing draw_report(const std::string& json) {
  constexpr int kNoNode = 77;
  const testing::ScratchFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  const std::string output = (folder.path() / "output").string();
  std::ofstream(report, std::ios::binary) << json;
  const auto script = std::filesystem::path(VOLCAL_SOURCE_DIR) / "identify/report/web/test/draw.mjs";
  const std::string command = "node=$(command -v node || command -v nodejs) || exit " +
                              std::to_string(kNoNode) + "; \"$node\" '" + script.string() + "' '" + report +
                              "' >'" + output + "' 2>&1 </dev/null";
  const int status = std::system(command.c_str());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::ifstream file(output, std::ios::binary);
  return {code != kNoNode, code, {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}};
}

}  // namespace volcal::test
