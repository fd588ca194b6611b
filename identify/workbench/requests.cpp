#include "volcal/identify/workbench/requests.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/workbench/columns.h"
#include "volcal/identify/workbench/looking.h"
#include "volcal/identify/workbench/workbench.h"

namespace volcal::workbench {

Refusal::Refusal(int code, const std::string& problem, std::string what_to_do)
    : std::runtime_error(problem), status(code), remedy(std::move(what_to_do)) {}

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
    throw Refusal(400, std::string("\"") + key + "\" is not a list", "load the page again");
  for (const Json& each : body[key]) {
    if (!each.is_string())
      throw Refusal(400, std::string("\"") + key + "\" holds something that is not a text",
                    "load the page again");
    texts.push_back(each.get<std::string>());
  }
  return texts;
}

Json error_json(const std::string& problem, const std::string& remedy) {
  return {{"error", problem}, {"remedy", remedy}};
}

namespace {

using Verb = SessionCommand::Verb;

constexpr std::size_t kMostColumns = 64;

SessionCommand with_effect(Verb verb, const Json& body) {
  return {.verb = verb, .effect = effect_name_from(text_of(body, "effect"))};
}

SessionCommand with_number(Verb verb, std::size_t number) { return {.verb = verb, .number = number}; }

std::vector<std::size_t> marked_observations(const Json& body) {
  if (!body.contains("observations") || !body["observations"].is_array() || body["observations"].empty())
    throw Refusal(400, "no readings are marked", "mark some in a picture");
  std::vector<std::size_t> observations;
  for (const Json& each : body["observations"]) {
    if (!each.is_number_unsigned())
      throw Refusal(400, "an observation is not a number", "load the page again");
    observations.push_back(each.get<std::size_t>());
  }
  std::ranges::sort(observations);
  return observations;
}

SessionCommand leaving_out(const Json& body) {
  SessionCommand command{.verb = Verb::LeaveOut, .observations = marked_observations(body)};
  command.reason = text_of(body, "reason");
  if (command.reason.find_first_not_of(' ') == std::string::npos)
    throw Refusal(400, "the reason for leaving out the readings is missing", "give a reason");
  std::ranges::replace(command.reason, '\n', ' ');
  return command;
}

Answer json_answer(const Json& json, int status = 200) {
  return {status, "application/json", json_text(json, -1)};
}

Answer framed_answer(std::string framed) { return {200, "application/octet-stream", std::move(framed)}; }

Answer columns_answer(const Session& session, const Json& body) {
  const std::vector<std::string> names = texts_of(body, "names");
  if (names.size() > kMostColumns) throw Refusal(400, "too many columns at once", "ask for fewer");
  std::vector<Eigen::VectorXd> columns;
  for (const std::string& name : names) columns.push_back(column(session, name));
  return framed_answer(frame({{"observations", session.linear().size()}}, names, columns));
}

}  // namespace

/// What the page may ask. Under the lock, but for tests.
struct Workbench::Request {
  enum class From {
    AnyPage,
    Writer,       ///< the page that writes
    WriterAtRest  ///< that, while nothing that the user began is under way
  };
  using Handler = std::function<Answer(Workbench&, const Json& body, const std::string& tab)>;

  std::string name;
  From from;
  bool needs_tests;  ///< it stands on tests of all effects
  Handler handler;

  static Request look(const std::string& name, const std::function<Json(Session&, const Json& body)>& shown);
  static Request look_at_tests(const std::string& name, Json (*shown)(Session&));
  static Request step(const std::string& name,
                      const std::function<void(Workbench&, const Json& body)>& taken);
  static Request command(const std::string& name,
                         const std::function<SessionCommand(const Json& body)>& given);
  static Request command(const std::string& name, Verb verb);
  static const std::vector<Request>& all();
  static const Request& of(const std::string& name);
};

/// Changes nothing.
Workbench::Request Workbench::Request::look(const std::string& name,
                                            const std::function<Json(Session&, const Json& body)>& shown) {
  return {name, From::AnyPage, false,
          [shown](Workbench& workbench, const Json& body, const std::string& /*tab*/) {
            return json_answer(shown(workbench.session(), body));
          }};
}

Workbench::Request Workbench::Request::look_at_tests(const std::string& name, Json (*shown)(Session&)) {
  Request request = look(name, [shown](Session& session, const Json& /*body*/) { return shown(session); });
  request.needs_tests = true;
  return request;
}

/// All pages are told of the new state.
Workbench::Request Workbench::Request::step(const std::string& name,
                                            const std::function<void(Workbench&, const Json& body)>& taken) {
  return {name, From::WriterAtRest, false,
          [taken](Workbench& workbench, const Json& body, const std::string& tab) {
            taken(workbench, body);
            workbench.publish_state();
            return json_answer(workbench.state(tab));
          }};
}

Workbench::Request Workbench::Request::command(const std::string& name,
                                               const std::function<SessionCommand(const Json& body)>& given) {
  return step(name, [given](Workbench& workbench, const Json& body) { workbench.do_command(given(body)); });
}

Workbench::Request Workbench::Request::command(const std::string& name, Verb verb) {
  return command(name, [verb](const Json& /*body*/) { return SessionCommand{.verb = verb}; });
}

const std::vector<Workbench::Request>& Workbench::Request::all() {
  using Text = std::string;
  static const std::vector<Request> requests = [] {
    Request add = command("add", [](const Json& body) { return with_effect(Verb::Add, body); });
    add.needs_tests = true;
    return std::vector<Request>{
        {"state", From::AnyPage, false,
         [](Workbench& workbench, const Json&, const Text& tab) {
           return json_answer(workbench.state(tab));
         }},
        look_at_tests("rank", rank_json),
        look_at_tests("meaning", meaning_json),
        {"unknown", From::AnyPage, false,
         [](Workbench& workbench, const Json&, const Text&) {
           workbench.look_for_unknown();
           return json_answer(unknown_json(workbench.session()));
         }},
        look("complete",
             [](Session& session, const Json& body) {
               return completion_json(session, text_of(body, "text"), number_of(body, "at"));
             }),
        look("periodogram",
             [](Session& session, const Json& body) {
               return periodogram_json(session, text_of(body, "variable"));
             }),
        look("polar", [](Session& session, const Json&) { return polar_json(session); }),
        look("rotary", [](Session& session, const Json&) { return rotary_axes_json(session); }),
        {"columns", From::AnyPage, false,
         [](Workbench& workbench, const Json& body, const Text&) {
           return columns_answer(workbench.session(), body);
         }},
        {"preview", From::AnyPage, true,
         [](Workbench& workbench, const Json& body, const Text&) {
           return framed_answer(preview_frame(workbench.session(), text_of(body, "effect")));
         }},
        // it counts as a test and is kept as a command
        {"formula", From::WriterAtRest, true,
         [](Workbench& workbench, const Json& body, const Text&) {
           const std::string text = text_of(body, "text");
           return framed_answer(workbench.try_formula(text, texts_of(body, "parameters")));
         }},
        {"cancel", From::AnyPage, false,
         [](Workbench& workbench, const Json&, const Text& tab) {
           workbench.cancel();
           return json_answer(workbench.state(tab));
         }},
        {"take", From::AnyPage, false,
         [](Workbench& workbench, const Json&, const Text& tab) {
           workbench.writer_ = tab;
           workbench.publish_state();
           return json_answer(workbench.state(tab));
         }},
        {"quit", From::Writer, false,
         [](Workbench& workbench, const Json&, const Text&) {
           workbench.hub_.publish("bye", "{}");
           workbench.ends_ = true;
           return json_answer(Json::object());
         }},
        step("reload", [](Workbench& workbench, const Json&) { workbench.load_again(); }),
        step("export",
             [](Workbench& workbench, const Json& body) { workbench.export_now(text_of(body, "what")); }),
        std::move(add),
        command("remove", [](const Json& body) { return with_effect(Verb::Remove, body); }),
        command("go", [](const Json& body) { return with_number(Verb::Go, number_of(body, "model")); }),
        command("draw", [](const Json& body) { return with_number(Verb::Draw, number_of(body, "unknown")); }),
        command("leave-out", leaving_out),
        command("undo", Verb::Undo),
        command("redo", Verb::Redo),
        command("climb", Verb::Climb),
        command("confirm", Verb::Confirm),
        command("refit", Verb::Refit)};
  }();
  return requests;
}

/// Throws Refusal where there is none of the name.
const Workbench::Request& Workbench::Request::of(const std::string& name) {
  const auto known = std::ranges::find(all(), name, &Request::name);
  if (known == all().end())
    throw Refusal(404, "\"" + name + "\" is not a request of the workbench", "load the page again");
  return *known;
}

Answer Workbench::answer(const std::string& name, const std::string& body, const std::string& tab) {
  const auto refused = [](int status, const Json& json) { return json_answer(json, status); };
  try {
    const Json json = body.empty() ? Json::object() : Json::parse(body);
    const Request& request = Request::of(name);
    if (request.needs_tests) make_tests();
    const Lock lock(mutex_);
    if (request.from != Request::From::AnyPage) require_writer(tab);
    if (request.from == Request::From::WriterAtRest) require_no_work();
    return request.handler(*this, json, tab);
  } catch (const WrittenEffectError& error) {
    Json json = error_json(error.told(), error.remedy());
    json["column"] = error.column();
    return refused(422, json);
  } catch (const InputError& error) {
    return refused(422, error_json(error.problem(), error.remedy()));
  } catch (const Refusal& refusal) {
    return refused(refusal.status, error_json(refusal.what(), refusal.remedy));
  } catch (const std::invalid_argument& error) {
    return refused(422, error_json(error.what(), "choose what the current model lets you choose"));
  } catch (const Json::exception&) {
    return refused(400, error_json("the request is not JSON of the expected form", "load the page again"));
  } catch (const std::exception& error) {
    return refused(500, error_json(error.what(), "undo the last step, or start the program again"));
  }
}

}  // namespace volcal::workbench
