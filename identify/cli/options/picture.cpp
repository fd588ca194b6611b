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

/// Has the browser open a page until it has left the file that `wanted` asks for, and returns which browser
/// it is.
std::string draw_page(const WorkFolder& folder, const std::string& html, const std::string& drawn,
                      const std::vector<std::string>& wanted) {
  const std::string program = browser().value_or(kBrowsers[0]);
  const std::string page = folder.path("page.html");
  std::ofstream(page, std::ios::binary) << html;
  std::vector<std::string> arguments = {program,
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
                                        "--user-data-dir=" + folder.path("profile"),
                                        "--virtual-time-budget=20000"};
  arguments.insert(arguments.end(), wanted.begin(), wanted.end());
  arguments.push_back("file://" + page);
  for (int attempt = 0; attempt < kDrawingAttempts && !has_content(drawn); ++attempt) run_to_end(arguments);
  return program;
}

/// Copies to the place wanted, whole or not at all.
void put_in_place(const std::string& drawn, const std::string& file) {
  const std::string beside = file + ".part";
  const TemporaryPath temporary(beside);
  std::error_code failed;
  fs::copy_file(drawn, beside, fs::copy_options::overwrite_existing, failed);
  if (!failed) fs::rename(beside, file, failed);
  if (failed) throw InputError({file, 0}, "cannot be written: " + failed.message(), "choose another place");
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
  require_browser(option, "open the report.html of -o in a browser");
}

void write_picture(const std::string& option, const ReportPicture& picture, const std::string& file) {
  const WorkFolder folder;
  const std::string drawn = folder.path("page.png");
  const std::string program =
      draw_page(folder, picture.html, drawn,
                {"--hide-scrollbars", "--force-device-scale-factor=2",
                 fmt::format("--window-size={},{}", picture.width, picture.height), "--screenshot=" + drawn});
  if (!has_content(drawn))
    throw InputError({file, 0}, option + ": " + program + " drew no picture",
                     "see whether it starts (" + program + " --version), or open the report.html of -o");
  put_in_place(drawn, file);
}

void require_browser(const std::string& option, const std::string& otherwise) {
  if (!browser())
    throw InputError({}, option + " needs Chromium, which is not installed",
                     "install it (apt-get install chromium), or " + otherwise);
}

void print_page(const std::string& option, const std::string& html, const std::string& file) {
  const WorkFolder folder;
  const std::string printed = folder.path("page.pdf");
  const std::string program =
      draw_page(folder, html, printed, {"--no-pdf-header-footer", "--print-to-pdf=" + printed});
  if (!has_content(printed))
    throw InputError({}, option + ": " + program + " printed nothing",
                     "see whether it starts (" + program + " --version), or print the page from a browser");
  put_in_place(printed, file);
}

}  // namespace volcal::cli
