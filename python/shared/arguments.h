#pragma once
/// Arguments that cannot be meant, refused by name.

#include <pybind11/numpy.h>

#include <optional>
#include <string>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/python/shared/bindings.h"

namespace volcal::python {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// First element that an array of numpy.ma masks, from 0; nothing where there is none.
std::optional<py::ssize_t> first_masked(const py::handle& values);

/// Whether numpy makes complex numbers of it.
bool is_complex(const py::handle& values);

/// An array of real numbers of one dimension, without a copy where it is one of float64 in one piece. Throws
/// InputError, which calls it `what`; `remedy` says what another dimension should be, `file` and the row,
/// from 1, are its place.
Doubles numbers_of(const py::handle& values, const std::string& file, const std::string& what,
                   const std::string& remedy);

/// A finite number. Throws InputError naming the argument.
double number_of(const py::handle& value, const std::string& argument);

/// Throw InputError naming the argument.
void require_finite(const std::string& argument, double value);
void require_positive(const std::string& argument, double value);
void require_not_negative(const std::string& argument, double value);
void require_range(const std::string& argument, long long value, long long least, long long most);
/// `threads`: 0 = all.
void require_threads(int threads);

/// {"x_mm": 500.0}: axes that are not named stand at home. Throws InputError naming the argument.
AxisPosition position_of(const Machine& machine, const py::dict& given, const std::string& argument);

/// A key that is a text. Throws InputError, which says what the keys are of: "readings of L".
std::string text_key(const py::handle& key, const std::string& of);

/// Throws InputError unless `value` is a mapping; `remedy` says which.
void require_mapping(const py::handle& value, const std::string& what, const std::string& remedy);

}  // namespace volcal::python
