#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "volcal/identify/errors/alignment.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

/// A result in another frame, with what it was aligned by.
struct AlignedOf {
  Result result;
  Eigen::Vector3d frame_rotation;
  Eigen::Matrix3d frame_covariance;
};

std::optional<AxisName> linear_axis_of(const std::string& option, const std::string& letter) {
  if (letter.empty()) return std::nullopt;
  const auto axis = letter.size() == 1 ? axis_from_letter(letter[0]) : std::nullopt;
  if (!axis || is_rotary(*axis))
    throw InputError({}, fmt::format("{}=\"{}\" is not a linear axis", option, letter),
                     "give \"X\", \"Y\" or \"Z\"");
  return axis;
}

Alignment wished_alignment(const Machine& machine, const std::string& primary, const std::string& secondary,
                           const py::dict& origin, const std::string& reference,
                           const std::optional<std::array<double, 2>>& spindle_tilt_urad) {
  if (reference != "axis" && reference != "spindle")
    throw InputError({}, "reference \"" + reference + "\" is not known", "choose \"axis\" or \"spindle\"");
  const bool spindle = reference == "spindle";
  if (!spindle && spindle_tilt_urad)
    throw InputError({}, "spindle_tilt_urad is given without reference=\"spindle\"",
                     "add reference=\"spindle\"");
  Alignment alignment;
  alignment.datum = wished_datum(machine.datum, linear_axis_of("primary", primary),
                                 linear_axis_of("secondary", secondary), spindle);
  if (!origin.empty()) alignment.origin = position_of(machine, origin, "origin");
  if (spindle) {
    const std::array<double, 2> tilt = spindle_tilt_urad.value_or(std::array<double, 2>{});
    for (const double angle : tilt) require_finite("spindle_tilt_urad", angle);
    alignment.spindle_tilt = Eigen::Vector2d(tilt[0] * kMicro, tilt[1] * kMicro);
  }
  return alignment;
}

AlignedOf aligned_result(const Result& of, const std::string& primary, const std::string& secondary,
                         const py::dict& origin, const std::string& reference,
                         const std::optional<std::array<double, 2>>& spindle_tilt_urad) {
  if (primary.empty() && secondary.empty() && origin.empty() && reference == "axis" && !spindle_tilt_urad)
    throw InputError({}, "nothing is to be aligned",
                     "give primary, secondary, origin, or reference=\"spindle\"");
  const Alignment alignment =
      wished_alignment(of.result.machine, primary, secondary, origin, reference, spindle_tilt_urad);
  return without_lock([&] {
    AlignedResult aligned = align_result(of.result, alignment);
    aligned.result.residuals = of.result.residuals;
    return AlignedOf{
        {std::move(aligned.result), of.campaign, of.path}, aligned.frame_rotation, aligned.frame_covariance};
  });
}

}  // namespace

void define_alignment(py::module_& module) {
  py::class_<AlignedOf>(module, "Aligned",
                        "A result in another machine coordinate system, and how the frame was turned.")
      .def_property_readonly(
          "result", [](const AlignedOf& aligned) { return aligned.result; },
          "The result in the new frame, for tables, budgets and files; its residuals are those of the fit. "
          "Parameters of "
          "set-ups, as stations, stay behind with the former frame.")
      .def_property_readonly(
          "frame_rotation", [](const AlignedOf& aligned) { return aligned.frame_rotation; },
          "Rotation of the machine frame about x, y and z: float array of shape (3,), rad.")
      .def_property_readonly(
          "frame_covariance", [](const AlignedOf& aligned) { return aligned.frame_covariance; },
          "Covariance of frame_rotation: float array of shape (3, 3), rad^2.")
      .def_property_readonly(
          "description", [](const AlignedOf& aligned) { return text_of(aligned.result.result.alignment); },
          "The new frame in words: \"primary Y, secondary X, origin X=0 Y=0 Z=0 mm\".")
      .def("__repr__", [](const AlignedOf& aligned) {
        return text_of("<volcal.Aligned " + aligned.result.result.alignment + ">");
      });
  module.def(
      "align", &aligned_result, py::arg("result"), py::kw_only(), py::arg("primary") = "",
      py::arg("secondary") = "", py::arg("origin") = py::dict(), py::arg("reference") = "axis",
      py::arg("spindle_tilt_urad") = py::none(),
      "A result in another machine coordinate system (ISO/TR 16907:2015, 7.3 and 10.2), as `volcal "
      "align`: the "
      "same numbers to the last bit. Errors are the same up to a rigid motion, and so is their "
      "covariance.\n\n"
      "primary: axis whose straight line is the frame's direction; secondary: axis that lies in a "
      "plane of the "
      "frame; \"\" = as the result has it. origin: where every error motion is zero, {\"x_mm\": 500.0}, axes "
      "not named "
      "at home. reference: what the frame's direction follows, the primary \"axis\" or the "
      "\"spindle\", with Z as "
      "primary axis. spindle_tilt_urad: with \"spindle\", its rotation against the straight line of Z "
      "about x and "
      "about y, urad; None = parallel. Raises InputError.");
}

}  // namespace volcal::python
