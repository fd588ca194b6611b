#include "volcal/identify/workbench/workbench.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <utility>

#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/identify/workbench/exports.h"
#include "volcal/identify/workbench/job.h"
#include "volcal/identify/workbench/looking.h"
#include "volcal/identify/workbench/requests.h"
#include "volcal/identify/workbench/session_json.h"

namespace volcal::workbench {
namespace {

constexpr std::size_t kLinesShown = 5;  // on either side of a wrong line

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

std::string command_line_of(const SessionCommand& command, std::size_t current) {
  if (command.verb != SessionCommand::Verb::Confirm || command.number) return to_string(command);
  return "confirm " + std::to_string(current);
}

}  // namespace

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

void Workbench::require_loaded() const {
  if (phase_ == Phase::Ready) return;
  if (phase_ == Phase::Loading || !input_error_)
    throw Refusal(409, "the campaign is still being loaded", "wait until it is there");
  const SourcePlace& place = input_error_->place();
  const std::string line = place.line > 0 ? ":" + std::to_string(place.line) : "";
  throw Refusal(
      409,
      "the input is wrong: " + (place.file.empty() ? "" : place.file + line + ": ") + input_error_->problem(),
      (input_error_->remedy().empty() ? "mend it" : input_error_->remedy()) +
          "; once the file is saved, it is loaded by itself");
}

Session& Workbench::session() {
  require_loaded();
  return *session_;
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

void Workbench::cancel() {
  cancelled_ = busy_.has_value();
  waiting_.reset();
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
  require_loaded();
  phase_ = Phase::Loading;
  load_again_ = true;
  cancel();
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

/// Framed. Kept as a command where it is new.
std::string Workbench::try_formula(const std::string& text, const std::vector<std::string>& parameters) {
  const SessionCommand command{
      .verb = SessionCommand::Verb::Formula, .formula = text, .parameters = parameters};
  const std::size_t before = session().tried();
  std::string framed = formula_frame(session(), text, parameters);
  if (session().tried() > before) commands_.push_back(to_string(command));
  return framed;
}

void Workbench::export_now(const std::string& what) {
  if (options_.read_only) throw Refusal(403, "this workbench only reads", "start it without --read-only");
  const ExportPlace place{options_.output, options_.campaign, options_.model, options_.provenance, true,
                          commands_};
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

}  // namespace volcal::workbench
