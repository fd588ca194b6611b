#include "volcal/model/description/machine.h"

#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>

#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/model/description/units.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/bindings.h"

namespace volcal::python {
namespace {

py::dict travel_of(const Machine& machine) {
  py::dict travel;
  for (const Axis& axis : machine.axes) {
    const double unit = position_unit(axis.name).si_per_unit;
    travel[py::str(position_column(axis.name))] =
        py::make_tuple(axis.travel_min / unit, axis.travel_max / unit);
  }
  return travel;
}

py::list tool_names(const Machine& machine) {
  py::list names;
  for (const Tool& tool : machine.tools) names.append(text_of(tool.name));
  return names;
}

}  // namespace

void define_machine(py::module_& module) {
  py::class_<Machine, std::shared_ptr<Machine>>(module, "Machine",
                                                "A machine tool as its owner describes it: structure, axes, "
                                                "datum, tools (machine.toml). It can be pickled, as "
                                                "the text of to_toml().")
      .def_static(
          "read", [](const std::filesystem::path& path) { return read_machine(path.string()); },
          py::arg("path"), "Machine of a machine.toml. Raises InputError.")
      .def_static(
          "parse", &parse_machine, py::arg("text"), py::arg("name") = "machine",
          "Machine of the text of a machine.toml; `name` stands for the file in messages. Raises InputError.")
      .def_property_readonly(
          "name", [](const Machine& machine) { return text_of(machine.name); }, "Name of the machine.")
      .def_property_readonly(
          "structure", [](const Machine& machine) { return text_of(machine.structure.code); },
          "Structural code of ISO 10791-6, from workpiece to tool: \"w X' b Y Z t\".")
      .def_property_readonly(
          "travel", &travel_of,
          "Ends of travel of each axis by its column: {\"x_mm\": (min, max), \"c_deg\": ...}, mm and "
          "deg.")
      .def_property_readonly("tools", &tool_names, "Names of the tools.")
      .def("to_toml", &machine_toml, "The machine as the text of a machine.toml.")
      .def(py::pickle(
          [](const Machine& machine) { return py::make_tuple(machine_toml(machine), machine.file); },
          [](const py::tuple& state) {
            return parse_machine(state[0].cast<std::string>(), state[1].cast<std::string>());
          }))
      .def("__repr__", [](const Machine& machine) {
        return text_of("<volcal.Machine " + machine.name + ", " + machine.structure.code + ">");
      });
}

}  // namespace volcal::python
