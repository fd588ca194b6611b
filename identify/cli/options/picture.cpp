#include "volcal/identify/cli/options/picture.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>
#include <thread>
#include <vector>

#include "volcal/identify/text/temporary_paths.h"
#include "volcal/model/description/errors.h"

extern char** environ;

namespace volcal::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBrowsers[] = {"chromium", "chromium-browser", "google-chrome", "chrome"};
constexpr std::chrono::seconds kBrowserPatience{60};
constexpr int kDrawingAttempts =
    3;  // the software graphics driver stalls now and then; another run goes through

std::optional<std::string> browser() {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return std::nullopt;
  for (const char* name : kBrowsers) {
    std::istringstream folders(path);
    for (std::string folder; std::getline(folders, folder, ':');) {
      const std::string program = (fs::path(folder.empty() ? "." : folder) / name).string();
      if (::access(program.c_str(), X_OK) == 0 && !fs::is_directory(program)) return program;
    }
  }
  return std::nullopt;
}

/// A folder that is gone when the object is.
class WorkFolder {
 public:
  WorkFolder() : path_(made()), temporary_(path_) {}
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  std::string path(const char* name) const { return (fs::path(path_) / name).string(); }

 private:
  static std::string made() {
    std::string pattern = (fs::temp_directory_path() / "volcal-picture-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw InputError({pattern, 0}, "the folder cannot be made",
                       "set TMPDIR to a folder that can be written");
    return pattern;
  }

  std::string path_;
  TemporaryPath temporary_;
};

/// True when the program ended by itself; one that hangs is ended.
bool run_to_end(const std::vector<std::string>& arguments) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, words.front(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  const auto end = std::chrono::steady_clock::now() + kBrowserPatience;
  while (::waitpid(child, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

bool has_content(const std::string& file) {
  std::error_code failed;
  return fs::file_size(file, failed) > 0 && !failed;
}

}  // namespace

void require_picture(const std::string& option, const std::string& file) {
  if (!file.ends_with(".png"))
    throw InputError({file, 0}, option + " takes the name of a PNG file", "end it in .png");
  const fs::path folder = fs::path(file).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
    throw InputError({file, 0}, "its folder does not exist", "make " + folder.string() + " first");
  if (!report_available())
    throw InputError({file, 0}, option + " draws a page of the report, which this program lacks",
                     std::string(how_to_get_report()));
  if (!browser())
    throw InputError({file, 0}, option + " needs Chromium, which is not installed",
                     "install it (apt-get install chromium), or open the report.html of -o in a browser");
}

void write_picture(const std::string& option, const ReportPicture& picture, const std::string& file) {
  const std::string program = browser().value_or(kBrowsers[0]);
  const WorkFolder folder;
  const std::string page = folder.path("page.html"), drawn = folder.path("page.png");
  std::ofstream(page, std::ios::binary) << picture.html;
  const std::vector<std::string> arguments = {
      program,
      "--headless",
      "--no-sandbox",
      "--disable-gpu",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--disable-breakpad",
      "--disable-crash-reporter",
      "--hide-scrollbars",
      "--force-device-scale-factor=2",
      "--user-data-dir=" + folder.path("profile"),
      fmt::format("--window-size={},{}", picture.width, picture.height),
      "--virtual-time-budget=20000",
      "--screenshot=" + drawn,
      "file://" + page};
  for (int attempt = 0; attempt < kDrawingAttempts && !has_content(drawn); ++attempt) run_to_end(arguments);
  if (!has_content(drawn))
    throw InputError({file, 0}, option + ": " + program + " drew no picture",
                     "see whether it starts (" + program + " --version), or open the report.html of -o");
  const std::string beside = file + ".part";
  const TemporaryPath temporary(beside);
  std::error_code failed;
  fs::copy_file(drawn, beside, fs::copy_options::overwrite_existing, failed);
  if (!failed) fs::rename(beside, file, failed);
  if (failed) throw InputError({file, 0}, "cannot be written: " + failed.message(), "choose another place");
}

}  // namespace volcal::cli
