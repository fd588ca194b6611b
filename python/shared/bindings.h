#pragma once
/// The Python module: each file defines a subject's part of it.

#include <pybind11/pybind11.h>

namespace volcal::python {

namespace py = pybind11;

void define_errors(py::module_& module);
void define_findings(py::module_& module);
void define_machine(py::module_& module);
void define_model(py::module_& module);
void define_campaign(py::module_& module);
void define_effects(py::module_& module);
void define_result(py::module_& module);
void define_fit(py::module_& module);
void define_diagnosis(py::module_& module);
void define_montecarlo(py::module_& module);
void define_tables(py::module_& module);
void define_compensation(py::module_& module);
void define_plan(py::module_& module);
void define_session(py::module_& module);
void define_alignment(py::module_& module);
void define_budget(py::module_& module);
void define_comparison(py::module_& module);
void define_trial(py::module_& module);

}  // namespace volcal::python
