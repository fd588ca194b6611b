#include "volcal/identify/cli/outcome.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/process.h"
#include "volcal/identify/text/text_encoding.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

int fail(const std::string& message, int exit_code) {
  std::fprintf(stderr, "error: %s\n", shown(message).c_str());
  return exit_code;
}

/// A fault of the program, which no file and no option should reach.
int tell_internal_error(const std::exception& error) {
  std::fprintf(stderr,
               "internal error: %s (a fault of volcal: please report it with the command and its files)\n",
               shown(error.what()).c_str());
  return kIncomplete;
}

int guarded(const std::function<int()>& work) {
  try {
    return work();
  } catch (const InputError& error) {
    return fail(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return fail(out_of_memory_message(), kIncomplete);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.path1().string() + ": " + error.code().message() +
                    " (check the path, its permissions and the free space)",
                kBadInput);
  } catch (const std::logic_error& error) {
    return tell_internal_error(error);
  } catch (const nlohmann::json::exception& error) {
    return tell_internal_error(error);
  } catch (const std::exception& error) {
    return fail(error.what(), kIncomplete);
  }
}

/// A full disk or a closed pipe shows at the end: an output that is cut off must not pass for a whole one.
int flushed(int exit_code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  std::fprintf(stderr, "error: standard output cannot be written%s%s: what was printed is not complete\n",
               errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : "");
  return exit_code == kDone ? kIncomplete : exit_code;
}

}  // namespace

std::string shown(std::string_view message) {
  std::string text;
  while (!message.empty()) {
    const std::size_t length = std::max<std::size_t>(utf8_length(message), 1);
    const std::string_view character = message.substr(0, length);
    text += character != "\n" && is_control(character) ? std::string_view("?") : character;
    message.remove_prefix(length);
  }
  return text;
}

int outcome_of(const std::function<int()>& work) {
  const int exit_code = flushed(guarded(work));
  stay_if_interrupted();
  return exit_code;
}

}  // namespace volcal::cli
