#pragma once
/// The workbench without its network: a campaign that is loaded, loaded again once a file is mended, a
/// session on it, work that takes long in a thread of its own, exports, and what the page is sent
/// (docs/workbench-protocol.md). For several threads at once.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/identify/session/session.h"
#include "volcal/identify/session/session_command.h"
#include "volcal/identify/workbench/event_hub.h"
#include "volcal/identify/workbench/frame.h"
#include "volcal/identify/workbench/watched_files.h"
#include "volcal/model/description/errors.h"

namespace volcal::workbench {

struct WorkbenchOptions {
  std::string campaign;  ///< campaign.toml
  std::string model;     ///< model.toml, or a result of volcal fit; empty: all errors
  std::string output;    ///< folder of exports
  int threads = 0;
  bool read_only = false;
  bool confirm_behind = true;  ///< a full fit follows every linear preview
  Provenance provenance = {};
};

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::string body;
};

/// What is under way.
struct Busy {
  std::string what;
  std::string stage;
  double share = 0.0;
  EventHub::Clock::time_point begun = EventHub::Clock::now();
  bool behind = false;  ///< it may be stopped by whatever the user does next
};

class Workbench {
 public:
  /// Begins to load.
  explicit Workbench(WorkbenchOptions options);
  /// Stops what is under way.
  ~Workbench();
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;

  /// `name`: what stands behind /api/; `tab`: of the page's. Errors are answers.
  Answer answer(const std::string& name, const std::string& body, const std::string& tab);
  EventHub& events() { return hub_; }
  bool wants_to_end() const;
  /// Until nothing is under way; for tests.
  void wait_until_idle();

 private:
  struct Job;
  struct Request;
  enum class Phase { Loading, BadInput, Ready };
  using Lock = std::unique_lock<std::mutex>;

  void make_tests() const;
  std::optional<std::string> work_of_the_user() const;
  void require_writer(const std::string& tab);
  void require_no_work() const;
  void load_again();
  void cancel();
  void do_command(const SessionCommand& command);
  std::string try_formula(const std::string& text, const std::vector<std::string>& parameters);
  void export_now(const std::string& what);
  Json state(const std::string& tab) const;
  void publish_state();
  void require_loaded() const;  ///< throws Refusal
  Session& session();           ///< throws Refusal

  void work();
  void run(Job& job, Lock& lock);
  void take_found(const Job& job, const std::function<void()>& take);
  void begin_after(const Job& job, bool taken);
  void load_until_ready(Lock& lock);
  void load(Lock& lock);
  void wait_for_mended_files(Lock& lock);
  std::vector<std::string> read_files() const;
  void look_for_changed_files();
  void start(Job job);
  void confirm_what_is_linear();
  void look_for_unknown();
  void prepare_refits();
  SessionProgress progress();

  WorkbenchOptions options_;
  EventHub hub_;
  mutable std::mutex mutex_;
  std::condition_variable woken_;
  Phase phase_ = Phase::Loading;
  std::optional<InputError> input_error_;
  std::unique_ptr<Session> session_;
  Json campaign_json_;
  std::unique_ptr<Job> waiting_;
  std::optional<Busy> busy_;
  bool cancelled_ = false;
  bool ends_ = false;
  bool load_again_ = false;
  FileStamps loaded_;                 ///< files of the session, when it was loaded
  std::vector<std::string> changed_;  ///< of these, since then
  std::vector<std::string> commands_;
  std::string writer_;
  std::size_t revision_ = 0;
  std::thread worker_;
};

}  // namespace volcal::workbench
