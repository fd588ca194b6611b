#include "volcal/identify/session/session.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/session/session_command.h"
#include "volcal/python/model.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

SessionProgress session_progress(const py::handle& callback) {
  return [tell = progress_to(callback)](const std::string& stage, double done) {
    tell(stage, done);
    return true;
  };
}

std::unique_ptr<Session> open_session(const std::shared_ptr<Campaign>& campaign, const Model* model,
                                      double heldout_share, int threads, const py::object& progress) {
  const SessionOptions options{
      .threads = threads, .heldout_share = heldout_share, .progress = session_progress(progress)};
  return without_lock([&] {
    return std::make_unique<Session>(*campaign, model != nullptr ? model->spec : ModelSpec{}, options);
  });
}

/// "KIND:TARGET:DRIVER:SHAPE", or an effect that was found.
std::string name_text(const py::handle& effect) {
  if (py::isinstance<EffectFinding>(effect)) return full_name(effect.cast<const EffectFinding&>().name);
  return effect.cast<std::string>();
}

const SessionModel& do_line(Session& session, const std::string& line, const py::object& progress) {
  const SessionCommand command = session_command_from(line);
  const SessionProgress tell = session_progress(progress);
  without_lock([&] {
    if (const auto work = begin(session, command)) session.take(*work, tell);
    return true;
  });
  return session.current();
}

py::dict preview_of(Session& session, const EffectName& name) {
  EffectPreview preview;
  without_lock([&] {
    preview = session.preview(name);
    return true;
  });
  py::dict told;
  told["effect"] = preview.effect;
  told["residual"] = array_of(preview.residual);
  told["rms_heldout"] = preview.rms_heldout;
  return told;
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
  py::class_<Session>(
      module, "Session",
      "A campaign under somebody's hands: look, try, add, watch the error fall. What the workbench and "
      "`volcal session` do, with the same numbers to the last bit.")
      .def(py::init(&open_session), py::arg("campaign").none(false), py::arg("model") = py::none(),
           py::kw_only(), py::arg("heldout_share") = SessionOptions{}.heldout_share, py::arg("threads") = 0,
           py::arg("progress") = py::none(),
           "Fits the model. heldout_share: of the lines, which judge and choose nothing. progress: as for "
           "fit(). Raises InputError.")
      .def_property_readonly(
          "models", [](const Session& session) { return session.models(); },
          "All models, SessionModel each, in the order in which they were made.")
      .def_property_readonly(
          "current", [](const Session& session) { return session.current(); }, "The current model.")
      .def(
          "residual",
          [](const Session& session, std::optional<std::size_t> model) {
            const std::size_t number = model.value_or(session.current().number);
            if (number >= session.models().size()) throw py::index_error("no such model");
            return array_of(session.residual(number));
          },
          py::arg("model") = py::none(),
          "Reading minus prediction of a model (None: the current one), m or rad, one per observation: "
          "setup, "
          "row, channel order. A copy.")
      .def(
          "rank", [](Session& session) { return without_lock([&] { return session.rank(); }); },
          "Effects that are not in the current model, EffectFinding each, best first.")
      .def(
          "preview",
          [](Session& session, const py::object& effect) {
            return preview_of(session, effect_name_from(name_text(effect)));
          },
          py::arg("effect"),
          "What an effect would be in the current model: a dict of effect, residual (m or rad, one per "
          "observation) and rms_heldout (SI). Raises ValueError where it cannot be added.")
      .def(
          "do",
          [](Session& session, const std::string& line, const py::object& progress) {
            return do_line(session, line, progress);
          },
          py::arg("line"), py::arg("progress") = py::none(),
          "Does what a line of `volcal session --do` says, and returns the current model: \"add "
          "KIND:TARGET:DRIVER:SHAPE\", \"remove ...\", \"formula TARGET += EXPRESSION\", \"refit\", "
          "\"confirm\", \"climb\", \"draw N\", \"leave-out OBSERVATIONS REASON\", \"undo\", \"redo\", \"go "
          "N\". "
          "progress: as for fit(). Raises InputError.")
      .def(
          "add",
          [](Session& session, const py::object& effect) {
            return do_line(session, "add " + name_text(effect), py::none());
          },
          py::arg("effect"),
          "A linear preview with a further effect becomes the current model. Raises InputError.")
      .def(
          "refit",
          [](Session& session, const py::object& progress) { return do_line(session, "refit", progress); },
          py::arg("progress") = py::none(),
          "The current linear preview with its noise and smoothing found again, derivatives kept. progress: "
          "as for fit().")
      .def(
          "confirm",
          [](Session& session, const py::object& progress) { return do_line(session, "confirm", progress); },
          py::arg("progress") = py::none(),
          "The current model by a full fit, noise and smoothing found anew. progress: as for fit().")
      .def(
          "undo", [](Session& session) { return session.undo(); },
          "To the model before. False: there is none.")
      .def(
          "redo", [](Session& session) { return session.redo(); }, "Back again. False: there is none.")
      .def(
          "model",
          [](const Session& session) {
            return Model{session.model(), session.campaign().machine};
          },
          "The given model with the effects of the current one, for fit() and for files.")
      .def("__repr__", [](const Session& session) {
        return text_of("<volcal.Session " + std::to_string(session.models().size()) + " models, at " +
                       std::to_string(session.current().number) + ">");
      });
}

}  // namespace volcal::python
