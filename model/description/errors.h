#pragma once
/// Errors that a user can mend. Everything a file or a command line can get wrong ends in an `InputError`
/// (exit code 2), which names the place, what was expected and what to do.

#include <stdexcept>
#include <string>

namespace volcal {

/// Where in a file something stands; `line` is 1-based, 0 when the whole file is meant.
struct SourcePlace {
  std::string file;
  int line = 0;
};

/// Bad input: `what()` reads "file:line: problem (remedy)".
class InputError : public std::runtime_error {
 public:
  InputError(SourcePlace place, std::string problem, std::string remedy);

  const SourcePlace& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }

 private:
  SourcePlace place_;
  std::string problem_;
  std::string remedy_;
};

}  // namespace volcal
