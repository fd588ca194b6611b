#include "volcal/python/shared/findings.h"

#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/python/shared/arrays.h"

namespace volcal::python {

py::list findings_of(const std::vector<Finding>& findings) {
  py::list list;
  for (const Finding& finding : findings) list.append(finding);
  return list;
}

void define_findings(py::module_& module) {
  py::class_<Finding>(
      module, "Finding",
      "What a computation noticed and somebody should know: a code with data. str() gives its sentence.")
      .def_property_readonly(
          "code", [](const Finding& finding) { return std::string(to_string(finding.code)); },
          "Code, the same in every version: \"rank.not-visible.axis-at-rest\" (docs/findings.md).")
      .def_property_readonly(
          "severity", [](const Finding& finding) { return std::string(to_string(finding.severity())); },
          "\"note\", \"warning\" or \"failure\".")
      .def_property_readonly(
          "data",
          [](const Finding& finding) -> py::object {
            return from_json(finding_json(finding).dump())["data"];
          },
          "Its values by name; numbers are {\"si\": value, \"unit\": text, \"si_per_unit\": factor}.")
      .def_property_readonly(
          "sentence", [](const Finding& finding) { return text_of(sentence(finding)); },
          "The finding in words.")
      .def("__str__", [](const Finding& finding) { return text_of(sentence(finding)); })
      .def("__repr__", [](const Finding& finding) {
        return text_of("<volcal.Finding " + std::string(to_string(finding.code)) + ": " + sentence(finding) +
                       ">");
      });
}

}  // namespace volcal::python
