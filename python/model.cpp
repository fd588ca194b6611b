#include "volcal/python/model.h"

#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>

#include "volcal/identify/criticism/catalogue/named_effect.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/effects/registry.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

Model extended_by(const Model& model, const py::handle& effect, const Campaign* campaign) {
  Model extended = model;
  if (campaign != nullptr) spec_for(&model, campaign->machine);
  const EffectSpec spec = effect_spec_of(effect, model.machine, campaign);
  const std::string label = effect_text(effect);
  without_lock([&] {
    extend_model({extended.spec, extended.machine, campaign}, spec,
                 {.label = label,
                  .place = {},
                  .remedy_if_known = "leave it out, or extend a model without it",
                  .remedy_if_absent = "name an error motion of one of the machine's axes"});
  });
  return extended;
}

py::list effect_tables(const Model& model) {
  py::list tables;
  for (const EffectSpec& effect : model.spec.effects) tables.append(text_of(effect_toml(effect)));
  return tables;
}

std::string written_model(const Model& model) {
  return model_toml(model.spec, model.machine.file.empty() ? "machine.toml" : model.machine.file);
}

void write_model(const Model& model, const std::filesystem::path& path) {
  const std::filesystem::path machine = model.machine.file;
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  std::string named = "machine.toml";
  if (machine.empty()) {
    write_text_file((folder / named).string(), machine_toml(model.machine));
  } else {
    named = std::filesystem::proximate(std::filesystem::absolute(machine), folder).generic_string();
  }
  write_text_file(path.string(), model_toml(model.spec, named));
}

}  // namespace

ModelSpec spec_for(const Model* model, const Machine& machine) {
  if (model == nullptr) return {};
  require_machine_of_model(model->machine, machine, {model->spec.file, 0});
  return model->spec;
}

EffectSpec effect_spec_of(const py::handle& effect, const Machine& machine, const Campaign* campaign) {
  if (py::isinstance<EffectFinding>(effect)) return effect.cast<const EffectFinding&>().spec;
  if (py::isinstance<py::str>(effect)) {
    Campaign of_machine_alone;
    of_machine_alone.machine = machine;
    return named_effect("effect", effect.cast<std::string>(),
                        campaign != nullptr ? *campaign : of_machine_alone);
  }
  require_mapping(
      effect, "an effect",
      "give \"KIND:TARGET\", a mapping with the keys of an [[effects]] table, or an EffectFinding");
  const std::string text =
      "format = \"" + std::string(kModelFormat) + "\"\n[[effects]]\n" + toml_lines(effect);
  return parse_model(text, "effect", machine).effects.front();
}

std::string effect_text(const py::handle& effect) {
  return py::isinstance<EffectFinding>(effect) ? effect.cast<const EffectFinding&>().label
                                               : py::str(effect).cast<std::string>();
}

void define_model(py::module_& module) {
  py::class_<Model>(
      module, "Model",
      "What is assumed of a machine: bases of the error functions, effects beyond the rigid body, known "
      "values (model.toml). Model(machine): all 21 errors, cubic B-splines, automatic knots. It can be "
      "pickled, as "
      "the text of to_toml().")
      .def(py::init([](const Machine& machine) {
             return Model{{}, machine};
           }),
           py::arg("machine"))
      .def_static(
          "read",
          [](const std::filesystem::path& path, const Machine& machine) {
            return Model{read_model(path.string(), machine), machine};
          },
          py::arg("path"), py::arg("machine"), "Model of a model.toml, for a machine. Raises InputError.")
      .def_static(
          "parse",
          [](const std::string& text, const Machine& machine, const std::string& name) {
            return Model{parse_model(text, name, machine), machine};
          },
          py::arg("text"), py::arg("machine"), py::arg("name") = "model",
          "Model of the text of a model.toml; `name` stands for the file in messages. Raises InputError.")
      .def_property_readonly("effects", &effect_tables,
                             "The effects, each as the text of its [[effects]] table.")
      .def(
          "extend",
          [](const Model& model, const py::object& effect, const std::shared_ptr<Campaign>& campaign) {
            return extended_by(model, effect, campaign.get());
          },
          py::arg("effect"), py::arg("campaign") = py::none(),
          "The model with one effect more, or with an error given back that it leaves out.\n\n"
          "effect: \"KIND:TARGET[:DRIVER[:SHAPE]]\", as \"reversal:EXX\"; a mapping with the keys of an "
          "[[effects]] "
          "table, as {\"kind\": \"custom\", \"target\": \"EZX\", \"expression\": \"abs(x) / 400 * dir_x\"}; "
          "or an "
          "EffectFinding of a diagnosis.\n"
          "campaign: where it has to act; effects of temperatures, stations, setups and tools need it.\n"
          "Raises InputError where the model has it already, nothing recorded drives it, or the campaign is "
          "of "
          "another machine.")
      .def(py::pickle(
          [](const Model& model) {
            return py::make_tuple(written_model(model), model.spec.file, model.machine);
          },
          [](const py::tuple& state) {
            const auto& machine = state[2].cast<const Machine&>();
            return Model{parse_model(state[0].cast<std::string>(), state[1].cast<std::string>(), machine),
                         machine};
          }))
      .def("to_toml", &written_model, "The model as the text of a model.toml.")
      .def("write", &write_model, py::arg("path"),
           "Writes a model.toml, and machine.toml beside it where the machine is of no file. Raises "
           "InputError.")
      .def("__repr__", [](const Model& model) {
        return text_of("<volcal.Model of " + model.machine.name + ", " +
                       std::to_string(model.spec.effects.size()) + " effects>");
      });
}

}  // namespace volcal::python
