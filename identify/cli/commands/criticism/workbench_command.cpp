#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/workbench/server.h"
#include "volcal/identify/workbench/workbench.h"

namespace volcal::cli {
namespace {

struct WorkbenchArguments {
  std::string campaign;
  std::string model;
  std::string output;
  int port = 0;
  int threads = 0;
  bool no_browser = false;
  bool read_only = false;
  bool keep = false;
  bool no_confirmation = false;
};

std::atomic<int> end_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);
void note_end(int signal) { end_signal = signal; }

/// SIGINT, SIGTERM and SIGHUP end the program as the page does.
void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = &note_end;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
}

/// The folder of a campaign, held while the object lives.
class FolderLock {
 public:
  explicit FolderLock(const std::string& campaign) {
    const std::string folder = std::filesystem::absolute(campaign).parent_path().string();
    descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    ::close(descriptor_);
    throw InputError({folder, 0}, "another workbench is open on this folder",
                     "use its page, or end it first; --read-only opens a second one");
  }
  ~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

void open_browser(const std::string& address) {
  const char* arguments[] = {"xdg-open", address.c_str(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, arguments[0], &quiet, nullptr, const_cast<char**>(arguments), environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (failed != 0) fmt::print("no browser was found to open it: open the address yourself\n");
}

std::string output_of(const WorkbenchArguments& arguments) {
  if (!arguments.output.empty()) return arguments.output;
  return (std::filesystem::path(arguments.campaign).parent_path() / "workbench").string();
}

int run_workbench(const WorkbenchArguments& arguments) {
  if (!workbench::page_available())
    throw InputError({}, "this program was built without its pages", std::string(how_to_get_report()));
  require_file(arguments.campaign);
  if (!arguments.model.empty() && !std::filesystem::exists(arguments.model)) require_file(arguments.model);
  const auto lock = arguments.read_only ? nullptr : std::make_unique<FolderLock>(arguments.campaign);
  workbench::Workbench bench({.campaign = arguments.campaign,
                              .model = arguments.model,
                              .output = output_of(arguments),
                              .threads = arguments.threads,
                              .read_only = arguments.read_only,
                              .confirm_behind = !arguments.no_confirmation,
                              .provenance = provenance()});
  workbench::Server server(bench, {.port = arguments.port, .keep = arguments.keep});
  end_on_signals();
  fmt::print("workbench: {}\nIt ends when its page is closed, or by Ctrl-C.\n", server.address());
  std::fflush(stdout);
  if (!arguments.no_browser) open_browser(server.address());
  server.serve([] { return end_signal != 0; });
  return kDone;
}

std::function<int()> define_workbench(CLI::App& app) {
  auto arguments = std::make_shared<WorkbenchArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml")->required();
  app.add_option("-m,--model", arguments->model,
                 "model.toml, or result of volcal fit, to begin with; default: all 21 errors");
  app.add_option("-o,--output", arguments->output,
                 "folder that exports are written to; default: workbench beside the campaign");
  app.add_option("--port", arguments->port, "of 127.0.0.1; default: a free one")->check(CLI::Range(1, 65535));
  app.add_option("--threads", arguments->threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_flag("--no-browser", arguments->no_browser, "print the address and open no browser");
  app.add_flag("--read-only", arguments->read_only, "write no file");
  app.add_flag("--keep", arguments->keep, "go on when the page is closed");
  app.add_flag("--no-confirmation", arguments->no_confirmation,
               "no full fit behind every linear preview; it is made when asked for");
  return [arguments] { return run_workbench(*arguments); };
}

}  // namespace

const Command& workbench_command() {
  static const Command command = {
      "workbench", "look, try, add and watch the error fall: a page in the browser, on this machine alone",
      "  volcal workbench campaign.toml\n"
      "  volcal workbench campaign.toml --model model.toml --no-browser --port 8137\n",
      define_workbench};
  return command;
}

}  // namespace volcal::cli
