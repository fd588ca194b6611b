#include "volcal/identify/session/session.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/session/session_command.h"
#include "volcal/model/description/errors.h"
#include "volcal/python/model.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

/// A session, and who is at work with it.
struct SessionOf {
  std::unique_ptr<Session> session;
  std::recursive_timed_mutex in_use = {};  ///< recursive: progress may look at the session that works
};

/// One operation at a time: others wait for it, without the interpreter's lock, until Ctrl-C.
class InUse {
 public:
  explicit InUse(SessionOf& of) : lock_(of.in_use, std::try_to_lock) {
    while (!lock_.owns_lock()) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const py::gil_scoped_release released;
      lock_.try_lock_for(kBetweenSignals);
    }
  }

 private:
  static constexpr std::chrono::milliseconds kBetweenSignals{50};
  std::unique_lock<std::recursive_timed_mutex> lock_;
};

SessionProgress session_progress(const py::handle& callback) {
  return [tell = progress_to(callback)](const std::string& stage, double done) {
    tell(stage, done);
    return true;
  };
}

void require_share(double share) {
  constexpr double kLeast = 0.01, kMost = 0.5;
  if (share >= kLeast && share <= kMost) return;
  throw InputError({}, fmt::format("heldout_share is {:g}", share),
                   fmt::format("give {:g} to {:g}, the share of the lines that judge", kLeast, kMost));
}

std::unique_ptr<SessionOf> open_session(const std::shared_ptr<Campaign>& campaign, const Model* model,
                                        double heldout_share, int threads, const py::object& progress) {
  require_share(heldout_share);
  require_threads(threads);
  const ModelSpec spec = spec_for(model, campaign->machine);
  const SessionOptions options{
      .threads = threads, .heldout_share = heldout_share, .progress = session_progress(progress)};
  return without_lock(
      [&] { return std::make_unique<SessionOf>(std::make_unique<Session>(*campaign, spec, options)); });
}

/// "KIND:TARGET:DRIVER:SHAPE", or an effect that was found.
std::string name_text(const py::handle& effect) {
  if (py::isinstance<EffectFinding>(effect)) return full_name(effect.cast<const EffectFinding&>().name);
  return effect.cast<std::string>();
}

SessionModel do_line(SessionOf& of, const std::string& line, const py::object& progress) {
  const SessionCommand command = session_command_from(line);
  const SessionProgress tell = session_progress(progress);
  const InUse in_use(of);
  without_lock([&] {
    if (const auto work = begin(*of.session, command)) of.session->take(*work, tell);
    return true;
  });
  return of.session->current();
}

py::dict preview_of(SessionOf& of, const EffectName& name) {
  const InUse in_use(of);
  const EffectPreview preview = without_lock([&] { return of.session->preview(name); });
  py::dict told;
  told["effect"] = preview.effect;
  told["residual"] = array_of(preview.residual);
  told["rms_heldout"] = preview.rms_heldout;
  return told;
}

std::vector<EffectFinding> ranking_of(SessionOf& of) {
  const InUse in_use(of);
  return without_lock([&] { return of.session->rank(); });
}

/// Without work of its own.
template <class Answer>
auto answer_of(SessionOf& of, const Answer& answer) {
  const InUse in_use(of);
  return answer(*of.session);
}

py::array_t<double> residual_of(SessionOf& of, const std::optional<std::size_t>& model) {
  return answer_of(of, [&](const Session& session) {
    const std::size_t number = model.value_or(session.current().number);
    if (number >= session.models().size()) throw py::index_error("no such model");
    return array_of(session.residual(number));
  });
}

std::string standing_text(const SessionModel& model) {
  if (model.standing == ModelStanding::Preview) return "preview";
  if (model.standing == ModelStanding::Refitted) return "refitted";
  return model.standing == ModelStanding::Contradicted ? "contradicted" : "fitted";
}

void define_session_model(py::module_& module) {
  py::class_<SessionModel>(module, "SessionModel", "A model of a session's tree.")
      .def_readonly("number", &SessionModel::number, "Its number: 0 is the given one.")
      .def_readonly("parent", &SessionModel::parent, "Number of the model that it came of; None: as given.")
      .def_property_readonly(
          "change", [](const SessionModel& model) { return text_of(model.change); },
          "What was done: \"+ reversal EXX\"; \"\" for the first.")
      .def_property_readonly("standing", &standing_text,
                             "\"fitted\", \"preview\" (linear), \"refitted\" (its noise and smoothing found "
                             "again) or \"contradicted\": by a "
                             "full fit, which is off what stood before by more than U95/4.")
      .def_readonly(
          "figures", &SessionModel::figures,
          "Figures on fitted and on held-out readings, a LadderStep, against the least noise that a "
          "full fit of the session has found.")
      .def_readonly("effects", &SessionModel::effects,
                    "What was added to the given model, EffectFinding each.")
      .def("__repr__", [](const SessionModel& model) {
        return text_of("<volcal.SessionModel " + std::to_string(model.number) + " " + model.change + ", " +
                       standing_text(model) + ">");
      });
}

}  // namespace

void define_session(py::module_& module) {
  define_session_model(module);
  py::class_<SessionOf>(
      module, "Session",
      "A campaign under somebody's hands: look, try, add, watch the error fall. What the workbench and "
      "`volcal session` do, with the same numbers to the last bit. One operation at a time: of several "
      "threads, others wait for the one that is at work, until Ctrl-C; its progress may look at the session.")
      .def(py::init(&open_session), py::arg("campaign").none(false), py::arg("model") = py::none(),
           py::kw_only(), py::arg("heldout_share") = SessionOptions{}.heldout_share, py::arg("threads") = 0,
           py::arg("progress") = py::none(),
           "Fits the model. heldout_share: of the lines, 0.01 to 0.5, which judge and choose nothing. "
           "progress: as for fit(). Raises InputError, also for a model of another machine.")
      .def_property_readonly(
          "models",
          [](SessionOf& of) {
            return answer_of(of, [](const Session& session) { return session.models(); });
          },
          "All models, SessionModel each, in the order in which they were made.")
      .def_property_readonly(
          "current",
          [](SessionOf& of) {
            return answer_of(of, [](const Session& session) { return session.current(); });
          },
          "The current model.")
      .def("residual", &residual_of, py::arg("model") = py::none(),
           "Reading minus prediction of a model (None: the current one), m or rad, one per observation: "
           "setup, row, channel order. A copy.")
      .def("rank", &ranking_of, "Effects that are not in the current model, EffectFinding each, best first.")
      .def(
          "preview",
          [](SessionOf& of, const py::object& effect) {
            return preview_of(of, effect_name_from(name_text(effect)));
          },
          py::arg("effect"),
          "What an effect would be in the current model: a dict of effect, residual (m or rad, one per "
          "observation) and rms_heldout (SI). Raises ValueError where it cannot be added.")
      .def("do", &do_line, py::arg("line"), py::arg("progress") = py::none(),
           "Does what a line of `volcal session --do` says, and returns the current model: \"add "
           "KIND:TARGET:DRIVER:SHAPE\", \"remove ...\", \"formula TARGET += EXPRESSION with p=1800+-600\", "
           "\"refit\", "
           "\"confirm\", \"climb\", \"draw N\", \"leave-out OBSERVATIONS REASON\", \"undo\", \"redo\", \"go "
           "N\". progress: as for fit(). Raises InputError.")
      .def(
          "add",
          [](SessionOf& of, const py::object& effect) {
            return do_line(of, "add " + name_text(effect), py::none());
          },
          py::arg("effect"),
          "A linear preview with a further effect becomes the current model. Raises InputError.")
      .def(
          "refit", [](SessionOf& of, const py::object& progress) { return do_line(of, "refit", progress); },
          py::arg("progress") = py::none(),
          "The current linear preview with its noise and smoothing found again, derivatives kept. progress: "
          "as for fit().")
      .def(
          "confirm",
          [](SessionOf& of, const py::object& progress) { return do_line(of, "confirm", progress); },
          py::arg("progress") = py::none(),
          "The current model by a full fit, noise and smoothing found anew. progress: as for fit().")
      .def(
          "undo",
          [](SessionOf& of) { return answer_of(of, [](Session& session) { return session.undo(); }); },
          "To the model before. False: there is none.")
      .def(
          "redo",
          [](SessionOf& of) { return answer_of(of, [](Session& session) { return session.redo(); }); },
          "Back again. False: there is none.")
      .def(
          "model",
          [](SessionOf& of) {
            return answer_of(of, [](const Session& session) {
              return Model{session.model(), session.campaign().machine};
            });
          },
          "The given model with the effects of the current one, for fit() and for files.")
      .def("__repr__", [](SessionOf& of) {
        return answer_of(of, [](const Session& session) {
          return text_of("<volcal.Session " + std::to_string(session.models().size()) + " models, at " +
                         std::to_string(session.current().number) + ">");
        });
      });
}

}  // namespace volcal::python
