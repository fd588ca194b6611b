#pragma once
/// Runs the program as a user does.

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/scratch_folder.h"

namespace volcal::testing {

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct ProgramRun {
  int exit_code = -1;
  std::string output;
  std::string errors;
};

/// `arguments` as in a shell, `before` what stands before the program: "env X=1"; standard input is empty.
inline ProgramRun run_with(const std::string& before, const std::string& arguments) {
  const ScratchFolder folder;
  const std::string output = (folder.path() / "output").string(),
                    errors = (folder.path() / "errors").string();
  const std::string command =
      before + " " + VOLCAL_PROGRAM + " " + arguments + " >" + output + " 2>" + errors + " </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(output), content(errors)};
}

inline ProgramRun run_program(const std::string& arguments) { return run_with("", arguments); }

}  // namespace volcal::testing
