#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/workbench/job.h"
#include "volcal/identify/workbench/looking.h"
#include "volcal/identify/workbench/requests.h"
#include "volcal/identify/workbench/session_json.h"
#include "volcal/identify/workbench/watched_files.h"

namespace volcal::workbench {
namespace {

constexpr std::chrono::milliseconds kLook{400};        // between looks at files that are to be mended
constexpr std::chrono::milliseconds kLookAgain{2000};  // and at files that were loaded
const std::string kRefit = "refit";                    // awaited: short, and not behind other programs
const std::string kScan = "scan";
const std::string kPrepare = "prepare";
const std::string kConfirm = "confirm";

/// What went wrong, in the words of the page; nothing where the work was stopped.
Json failure_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const SessionStopped&) {
  } catch (const InputError& error) {
    return error_json(error.problem(), error.remedy());
  } catch (const std::exception& error) {
    return error_json(error.what(), "the model before stands");
  }
  return nullptr;
}

/// What `work` gives, made in a thread that the system prefers others to, with those that it begins: hovering
/// and ranking are answered meanwhile.
template <class Work>
auto behind(const Work& work) {
  decltype(work()) made;
  std::exception_ptr failure;
  std::thread([&] {
#ifdef __linux__
    constexpr int kBehind = 10;
    static_cast<void>(nice(kBehind));  // of this thread alone; the program goes on where it may not
#endif
    try {
      made = work();
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) std::rethrow_exception(failure);
  return made;
}

}  // namespace

void Workbench::start(Job job) {
  waiting_ = std::make_unique<Job>(std::move(job));
  woken_.notify_all();
}

/// Behind, as long as the user does nothing else: a refit of a preview, then a full fit.
void Workbench::confirm_what_is_linear() {
  const SessionModel& current = session_->current();
  if (!options_.confirm_behind || !awaits_full_fit(current.standing)) return;
  const bool linear = current.standing == ModelStanding::Preview;
  const std::string what = linear ? kRefit : kConfirm;
  start({what, what + " " + std::to_string(current.number), true,
         [this, work = linear ? session_->refit() : session_->confirmation()](const SessionProgress& progress)
             -> std::function<void()> { return [this, change = work(progress)] { change(*session_); }; }});
}

/// Behind as well, once nothing else is under way; event "unknown" tells what was found. Then what is likely
/// to be asked next.
void Workbench::look_for_unknown() {
  if (waiting_ || (busy_ && !cancelled_)) return;
  if (session().is_scanned()) return prepare_refits();
  start({kScan, "", true,
         [this, scan = session_->scan()](const SessionProgress& progress) -> std::function<void()> {
           return [this, change = scan(progress)] {
             change(*session_);
             hub_.publish("unknown", json_text(unknown_json(*session_), -1));
           };
         },
         session_->testing()});
}

void Workbench::prepare_refits() {
  if (!options_.confirm_behind || session().is_prepared()) return;
  start({kPrepare, "", true,
         [this, work = session_->preparation()](const SessionProgress& progress) -> std::function<void()> {
           return [this, change = work(progress)] { change(*session_); };
         }});
}

/// False once the work is to stop. Told a few times a second.
SessionProgress Workbench::progress() {
  return [this, last = EventHub::Clock::time_point()](const std::string& stage, double done) mutable {
    const Lock lock(mutex_);
    if (cancelled_) return false;
    constexpr std::chrono::milliseconds kBetween{150};
    const auto now = EventHub::Clock::now();
    if (!busy_ || now - last < kBetween) return true;
    last = now;
    busy_->stage = stage;
    busy_->share = std::max(busy_->share, std::min(1.0, done));
    hub_.publish("progress", json_text(state(writer_)["busy"], -1));
    return true;
  };
}

void Workbench::work() {
  Lock lock(mutex_);
  load_until_ready(lock);
  while (!ends_) {
    woken_.wait_for(lock, kLookAgain, [this] { return ends_ || waiting_ || load_again_; });
    if (ends_) break;
    if (load_again_) {
      load_until_ready(lock);
    } else if (waiting_) {
      const std::unique_ptr<Job> job = std::move(waiting_);
      run(*job, lock);
      woken_.notify_all();
    } else {
      look_for_changed_files();
    }
  }
}

void Workbench::load_until_ready(Lock& lock) {
  load_again_ = false;
  phase_ = Phase::Loading;
  while (!ends_ && phase_ != Phase::Ready) {
    load(lock);
    if (phase_ == Phase::BadInput) wait_for_mended_files(lock);
  }
}

/// The campaign, the model and what they name; of wrong files as far as they can be read.
std::vector<std::string> Workbench::read_files() const {
  std::vector<std::string> files{options_.campaign, options_.model};
  if (input_error_) files.push_back(input_error_->place().file);
  return with_named_files(files);
}

void Workbench::look_for_changed_files() {
  std::vector<std::string> files = changed_since(loaded_);
  if (files == changed_) return;
  changed_ = std::move(files);
  publish_state();
}

void Workbench::run(Job& job, Lock& lock) {
  cancelled_ = false;
  busy_.emplace();
  busy_->what = job.what;
  busy_->behind = job.behind;
  publish_state();
  lock.unlock();
  std::function<void()> take;
  Json failed = failure_of([&] {
    if (job.first) job.first();
    const bool patient = job.behind && job.what != kRefit;
    take = patient ? behind([&] { return job.run(progress()); }) : job.run(progress());
  });
  lock.lock();
  bool taken = take && !cancelled_;
  busy_.reset();
  cancelled_ = false;
  if (taken) {
    failed = failure_of([&] { take_found(job, take); });
    taken = failed.is_null();
  }
  const Json failed_after = failure_of([&] { begin_after(job, taken); });
  if (failed.is_null()) failed = failed_after;
  if (!failed.is_null()) {
    failed["what"] = job.what;
    hub_.publish("failed", json_text(failed, -1));
  }
  publish_state();
}

void Workbench::take_found(const Job& job, const std::function<void()>& take) {
  take();
  if (!job.command.empty()) commands_.push_back(job.command);
  if (job.what == "draw" && !session_->drawn().empty())
    hub_.publish("surface", json_text(surface_json(session_->drawn().back()), -1));
}

/// What goes on behind.
void Workbench::begin_after(const Job& job, bool taken) {
  if (load_again_) return;
  const bool further = !job.behind || (job.what == kRefit && taken);
  if (further && !waiting_) confirm_what_is_linear();
  if (job.what == kScan ? taken : job.what != kPrepare) look_for_unknown();
}

/// A session, or what is wrong with the files.
void Workbench::load(Lock& lock) {
  phase_ = Phase::Loading;
  input_error_.reset();
  session_.reset();
  commands_.clear();
  changed_.clear();
  loaded_ = stamp_of(read_files());
  busy_.emplace();
  busy_->what = "load";
  publish_state();
  lock.unlock();
  std::unique_ptr<Session> opened;
  std::optional<InputError> error;
  try {
    Campaign campaign = read_campaign(options_.campaign);
    ModelSpec model = read_starting_model(options_.model, campaign.machine);
    opened = std::make_unique<Session>(std::move(campaign), std::move(model),
                                       SessionOptions{.threads = options_.threads, .progress = progress()});
  } catch (const SessionStopped&) {
    error = InputError({options_.campaign, 0}, "loading was stopped", "save the file again to load it anew");
  } catch (const InputError& wrong) {
    error = wrong;
  } catch (const std::exception& other) {
    error = InputError({options_.campaign, 0}, other.what(), "run volcal fit on it, which says more");
  }
  lock.lock();
  busy_.reset();
  cancelled_ = false;
  session_ = std::move(opened);
  input_error_ = std::move(error);
  phase_ = session_ ? Phase::Ready : Phase::BadInput;
  if (session_) campaign_json_ = campaign_json(*session_);
  publish_state();
  woken_.notify_all();
}

void Workbench::wait_for_mended_files(Lock& lock) {
  const std::vector<std::string> files = read_files();
  const FileStamps before = stamp_of(files);
  while (!ends_ && stamp_of(files) == before) woken_.wait_for(lock, kLook);
}

}  // namespace volcal::workbench
