#include "volcal/model/description/errors.h"

#include <exception>
#include <filesystem>

#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/bindings.h"
#include "volcal/python/shared/option_words.h"

namespace volcal::python {
namespace {

/// volcal.InputError, which is defined in Python.
void raise_input_error(const InputError& thrown) {
  const InputError worded = thrown.in_words_of(argument_of_setting);
  const InputError error(worded.place(), with_arguments(worded.problem()), with_arguments(worded.remedy()));
  const py::object type = py::module_::import("volcal").attr("InputError");
  const py::object value = type(text_of(error.problem()), text_of(error.remedy()),
                                text_of(error.place().file), error.place().line, text_of(error.what()));
  PyErr_SetObject(type.ptr(), value.ptr());
}

}  // namespace

void define_errors(py::module_& /*module*/) {
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      raise_input_error(error);
    } catch (const std::filesystem::filesystem_error& error) {
      PyErr_SetObject(PyExc_OSError, text_of(error.what()).ptr());
    }
  });
}

}  // namespace volcal::python
