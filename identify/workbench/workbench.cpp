#include "volcal/identify/workbench/workbench.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/identify/workbench/columns.h"
#include "volcal/identify/workbench/exports.h"
#include "volcal/identify/workbench/looking.h"
#include "volcal/identify/workbench/session_json.h"

namespace volcal::workbench {
namespace {

constexpr std::chrono::milliseconds kLook{400};        // between looks at files that are to be mended
constexpr std::chrono::milliseconds kLookAgain{2000};  // and at files that were loaded
constexpr std::size_t kLinesShown = 5;                 // on either side of a wrong line
constexpr std::size_t kMostColumns = 64;
const std::string kRefit = "refit";  // awaited: short, and not behind other programs
const std::string kScan = "scan";
const std::string kPrepare = "prepare";
const std::string kConfirm = "confirm";

/// What cannot be done now.
struct Refusal : std::runtime_error {
  int status;
  std::string remedy;
  Refusal(int code, const std::string& problem, std::string what_to_do)
      : std::runtime_error(problem), status(code), remedy(std::move(what_to_do)) {}
};

std::string text_of(const Json& body, const char* key) {
  if (!body.is_object() || !body.contains(key) || !body[key].is_string())
    throw Refusal(400, std::string("the request lacks the text \"") + key + "\"", "load the page again");
  return body[key].get<std::string>();
}

std::size_t number_of(const Json& body, const char* key) {
  if (!body.is_object() || !body.contains(key) || !body[key].is_number_unsigned())
    throw Refusal(400, std::string("the request lacks the number \"") + key + "\"", "load the page again");
  return body[key].get<std::size_t>();
}

std::vector<std::string> texts_of(const Json& body, const char* key) {
  std::vector<std::string> texts;
  if (!body.contains(key)) return texts;
  if (!body[key].is_array())
    throw Refusal(400, std::string("\"") + key + "\" is no list", "load the page again");
  for (const Json& each : body[key]) {
    if (!each.is_string())
      throw Refusal(400, std::string("\"") + key + "\" holds no texts", "load the page again");
    texts.push_back(each.get<std::string>());
  }
  return texts;
}

Json error_json(const std::string& problem, const std::string& remedy) {
  return {{"error", problem}, {"remedy", remedy}};
}

/// Lines about a place that is wrong.
Json lines_about(const SourcePlace& place) {
  Json lines = Json::array();
  std::ifstream file(place.file);
  std::string text;
  const auto wanted = static_cast<std::size_t>(std::max(place.line, 1));
  for (std::size_t line = 1; std::getline(file, text) && line <= wanted + kLinesShown; ++line) {
    if (line + kLinesShown >= wanted) lines.push_back({{"line", line}, {"text", text}});
  }
  return lines;
}

Json input_error_json(const InputError& error) {
  return {{"file", error.place().file},
          {"line", error.place().line},
          {"problem", error.problem()},
          {"remedy", error.remedy()},
          {"text", lines_about(error.place())}};
}

FileStamps stamp_of(const std::vector<std::string>& files) {
  FileStamps stamp;
  for (const std::string& file : files) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    const auto size = error ? 0 : std::filesystem::file_size(file, error);
    if (!error) stamp[file] = {time, size};
  }
  return stamp;
}

/// What stands in quotes, as far as it looks like a name of a file.
std::vector<std::string> quoted_names(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = text.find_first_of("\"'\n"); at != std::string::npos;) {
    const std::size_t end = text[at] == '\n' ? at : text.find_first_of(std::string{text[at], '\n'}, at + 1);
    if (end == std::string::npos) break;
    if (end > at + 1 && text[end] != '\n') {
      std::string name = text.substr(at + 1, end - at - 1);
      if (std::filesystem::path(name).has_extension()) names.push_back(std::move(name));
    }
    at = text.find_first_of("\"'\n", end + 1);
  }
  return names;
}

/// A file and those that it names, there or not: its text need not be right.
void add_with_named(const std::filesystem::path& file, std::set<std::string>& files) {
  if (file.empty() || !files.insert(file.string()).second || file.extension() != ".toml") return;
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const std::string& name : quoted_names(text)) add_with_named(file.parent_path() / name, files);
}

SessionCommand command_of(const std::string& request, const Json& body) {
  if (request == "add" || request == "remove")
    return session_command_from(request + " " + text_of(body, "effect"));
  if (request == "go") return session_command_from("go " + std::to_string(number_of(body, "model")));
  if (request == "draw")
    return session_command_from("draw " + std::to_string(number_of(body, "unknown") + 1));
  if (request == "leave-out") {
    SessionCommand command;
    command.verb = SessionCommand::Verb::LeaveOut;
    if (!body.contains("observations") || !body["observations"].is_array() || body["observations"].empty())
      throw Refusal(400, "no readings are marked", "mark some in a picture");
    for (const Json& each : body["observations"]) {
      if (!each.is_number_unsigned())
        throw Refusal(400, "an observation is no number", "load the page again");
      command.observations.push_back(each.get<std::size_t>());
    }
    std::ranges::sort(command.observations);
    command.reason = text_of(body, "reason");
    if (command.reason.find_first_not_of(' ') == std::string::npos)
      throw Refusal(400, "it is not said why readings are left out", "give a reason");
    std::ranges::replace(command.reason, '\n', ' ');
    return command;
  }
  return session_command_from(request);
}

constexpr std::array kCommands = {"add",  "remove", "go",    "draw",    "leave-out",
                                  "undo", "redo",   "climb", "confirm", "refit"};

/// Requests that stand on tests of all effects.
constexpr std::array kOnTests = {"rank", "preview", "formula", "meaning", "add"};

bool is_command(const std::string& request) {
  return std::ranges::find(kCommands, request) != kCommands.end();
}

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

std::string command_line_of(const SessionCommand& command, std::size_t current) {
  if (command.verb != SessionCommand::Verb::Confirm || command.number) return to_string(command);
  return "confirm " + std::to_string(current);
}

}  // namespace

/// Work in the thread of its own: what it finds is taken under the lock.
struct Workbench::Job {
  std::string what;
  std::string command;  ///< as it is kept; empty: it changes no model
  bool behind = false;
  std::function<std::function<void()>(const SessionProgress&)> run;
  std::function<void()> first = {};  ///< what others wait for as well, never behind other programs
};

Workbench::Workbench(WorkbenchOptions options) : options_(std::move(options)) {
  worker_ = std::thread([this] { work(); });
}

Workbench::~Workbench() {
  {
    const Lock lock(mutex_);
    ends_ = cancelled_ = true;
    woken_.notify_all();
  }
  worker_.join();
  hub_.close();
}

bool Workbench::wants_to_end() const {
  const Lock lock(mutex_);
  return ends_;
}

void Workbench::wait_until_idle() {
  Lock lock(mutex_);
  woken_.wait(lock, [this] { return phase_ != Phase::Loading && !busy_ && !waiting_; });
}

Session& Workbench::session() {
  if (phase_ != Phase::Ready)
    throw Refusal(409, phase_ == Phase::Loading ? "the campaign is still being loaded" : "the input is wrong",
                  "wait until it is there");
  return *session_;
}

Answer Workbench::answer(const std::string& request, const std::string& body, const std::string& tab) {
  const auto refused = [](int status, Json json) {
    return Answer{status, "application/json", json_text(json, -1)};
  };
  try {
    const Json json = body.empty() ? Json::object() : Json::parse(body);
    if (std::ranges::find(kOnTests, request) != kOnTests.end()) make_tests();
    const Lock lock(mutex_);
    if (auto framed = look_framed(request, json, tab))
      return {200, "application/octet-stream", *std::move(framed)};
    const bool looks = request != "cancel" && request != "take" && request != "quit" && request != "export" &&
                       request != "reload" && !is_command(request);
    const Json told =
        looks ? look(request, request == "state" ? Json{{"tab", tab}} : json) : act(request, json, tab);
    return {200, "application/json", json_text(told, -1)};
  } catch (const WrittenEffectError& error) {
    Json json = error_json(error.told(), error.remedy());
    json["column"] = error.column();
    return refused(422, std::move(json));
  } catch (const InputError& error) {
    return refused(422, error_json(error.problem(), error.remedy()));
  } catch (const Refusal& refusal) {
    return refused(refusal.status, error_json(refusal.what(), refusal.remedy));
  } catch (const std::invalid_argument& error) {
    return refused(422, error_json(error.what(), "choose what the current model lets you choose"));
  } catch (const Json::exception&) {
    return refused(400, error_json("the request is no JSON of its kind", "load the page again"));
  } catch (const std::exception& error) {
    return refused(500, error_json(error.what(), "undo the last step, or start the program again"));
  }
}

/// Without the lock: they take seconds of 10^5 readings, and pictures are answered meanwhile.
void Workbench::make_tests() const {
  std::function<void()> testing;
  {
    const Lock lock(mutex_);
    if (phase_ != Phase::Ready) return;
    testing = session_->testing();
  }
  testing();
}

Json Workbench::look(const std::string& request, const Json& body) {
  if (request == "state") return state(text_of(body, "tab"));
  if (request == "rank") return rank_json(session());
  if (request == "unknown") {
    look_for_unknown();
    return unknown_json(session());
  }
  if (request == "complete") return completion_json(session(), text_of(body, "text"), number_of(body, "at"));
  if (request == "periodogram") return periodogram_json(session(), text_of(body, "variable"));
  if (request == "polar") return polar_json(session());
  if (request == "rotary") return rotary_axes_json(session());
  if (request == "meaning") return meaning_json(session());
  throw Refusal(404, "\"" + request + "\" is no request of the workbench", "load the page again");
}

std::optional<std::string> Workbench::look_framed(const std::string& request, const Json& body,
                                                  const std::string& tab) {
  if (request == "columns") {
    const std::vector<std::string> names = texts_of(body, "names");
    if (names.size() > kMostColumns) throw Refusal(400, "too many columns at once", "ask for fewer");
    std::vector<Eigen::VectorXd> columns;
    for (const std::string& name : names) columns.push_back(column(session(), name));
    return frame({{"observations", session().linear().size()}}, names, columns);
  }
  if (request == "preview") return preview_frame(session(), text_of(body, "effect"));
  if (request != "formula") return std::nullopt;
  require_writer(tab);  // it counts as a test and is kept as a command
  require_no_work();
  SessionCommand command;
  command.verb = SessionCommand::Verb::Formula;
  command.formula = text_of(body, "text");
  command.parameters = texts_of(body, "parameters");
  const std::size_t before = session().tried();
  std::string framed = formula_frame(session(), command.formula, command.parameters);
  if (session().tried() > before) commands_.push_back(to_string(command));
  return framed;
}

Json Workbench::act(const std::string& request, const Json& body, const std::string& tab) {
  if (request == "cancel") {
    cancelled_ = busy_.has_value();
    waiting_.reset();
    return state(tab);
  }
  if (request == "take") {
    writer_ = tab;
    publish_state();
    return state(tab);
  }
  require_writer(tab);
  if (request == "quit") {
    hub_.publish("bye", "{}");
    ends_ = true;
    return Json::object();
  }
  require_no_work();
  if (request == "reload") {
    load_again();
  } else if (request == "export") {
    export_now(text_of(body, "what"));
  } else {
    do_command(command_of(request, body));
  }
  publish_state();
  return state(tab);
}

void Workbench::require_writer(const std::string& tab) {
  if (writer_.empty()) writer_ = tab;
  if (tab != writer_) throw Refusal(409, "another page writes", "press \"write here\" to take over");
}

void Workbench::require_no_work() const {
  if (const auto what = work_of_the_user())
    throw Refusal(409, "the program is at work: " + *what, "wait for it, or cancel it");
}

/// The session ends, and another one begins with the files as they are now.
void Workbench::load_again() {
  if (phase_ != Phase::Ready) throw Refusal(409, "the campaign is not loaded yet", "wait until it is there");
  phase_ = Phase::Loading;
  load_again_ = true;
  cancelled_ = busy_.has_value();
  waiting_.reset();
  woken_.notify_all();
}

/// What is under way and may not be stopped by the way.
std::optional<std::string> Workbench::work_of_the_user() const {
  if (waiting_ && !waiting_->behind) return waiting_->what;
  if (busy_ && !busy_->behind) return busy_->what;
  return std::nullopt;
}

/// At once, or started.
void Workbench::do_command(const SessionCommand& command) {
  const std::string line = command_line_of(command, session().current().number);
  std::optional<SessionWork> long_work = begin(session(), command);
  if (busy_ && busy_->behind) cancelled_ = true;
  if (!long_work) {
    commands_.push_back(line);
    waiting_.reset();
    confirm_what_is_linear();
    return look_for_unknown();
  }
  start({line.substr(0, line.find(' ')), line, false,
         [this, long_work = *std::move(long_work)](const SessionProgress& progress) -> std::function<void()> {
           return [this, change = long_work(progress)] { change(*session_); };
         }});
}

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

void Workbench::export_now(const std::string& what) {
  if (options_.read_only) throw Refusal(403, "this workbench only reads", "start it without --read-only");
  const ExportPlace place{options_.output, options_.campaign, options_.model, options_.provenance};
  const auto tell = [this, what](const std::vector<std::string>& files) {
    hub_.publish("exported", json_text(Json{{"what", what}, {"files", files}}, -1));
  };
  if (what == "model") return tell({export_model(session(), place)});
  if (what == "commands") return tell({export_commands(commands_, place)});
  const ExportWork make = export_work(what, session(), place, options_.threads);
  if (busy_ && busy_->behind) cancelled_ = true;
  start({"export", "", false, [make, tell](const SessionProgress& progress) -> std::function<void()> {
           return [files = make(progress), tell] { tell(files); };
         }});
}

Json Workbench::state(const std::string& tab) const {
  Json busy = nullptr;
  if (waiting_ && !waiting_->behind) {
    busy = {{"what", waiting_->what}, {"behind", false}, {"stage", ""}, {"share", 0.0}, {"left_s", nullptr}};
  } else if (busy_) {
    const double seconds = std::chrono::duration<double>(EventHub::Clock::now() - busy_->begun).count();
    constexpr double kToBeJudged = 0.03, kLongEnough = 0.5;
    busy = {{"what", busy_->what},
            {"behind", busy_->behind},
            {"stage", busy_->stage},
            {"share", busy_->share},
            {"left_s", busy_->share > kToBeJudged && seconds > kLongEnough
                           ? Json(seconds * (1.0 - busy_->share) / busy_->share)
                           : Json()}};
  }
  Json json = {{"version", options_.provenance.version},
               {"revision", revision_},
               {"read_only", options_.read_only},
               {"writer", writer_.empty() || writer_ == tab},
               {"writer_tab", writer_},
               {"phase", phase_ == Phase::Ready     ? "ready"
                         : phase_ == Phase::Loading ? "loading"
                                                    : "bad-input"},
               {"input_error", input_error_ ? input_error_json(*input_error_) : Json()},
               {"busy", std::move(busy)},
               {"campaign", campaign_json_},
               {"confirm_behind", options_.confirm_behind},
               {"output", options_.output},
               {"stale", changed_},
               {"commands", commands_}};
  if (phase_ != Phase::Ready) return json;
  json.update(models_json(*session_));
  json["notes"] = sentences(session_->campaign().notes);
  json["can_undo"] = session_->can_undo();
  json["can_redo"] = session_->can_redo();
  json["tried"] = session_->tried();
  json["left_out"] = left_out_json(session_->campaign());
  return json;
}

void Workbench::publish_state() {
  ++revision_;
  hub_.publish("state", json_text(state(writer_), -1));
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
  std::set<std::string> files;
  add_with_named(options_.campaign, files);
  add_with_named(options_.model, files);
  if (input_error_) add_with_named(input_error_->place().file, files);
  return {files.begin(), files.end()};
}

void Workbench::look_for_changed_files() {
  std::vector<std::string> files;
  for (const auto& [file, stamp] : loaded_) files.push_back(file);
  const FileStamps now = stamp_of(files);
  std::erase_if(files, [&](const std::string& file) {
    const auto found = now.find(file);
    return found != now.end() && found->second == loaded_.at(file);
  });
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
