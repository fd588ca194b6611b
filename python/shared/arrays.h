#pragma once
/// Numbers and texts between the library and Python.

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "volcal/python/shared/bindings.h"

namespace volcal::python {

/// An array without a copy and without the right to write, of memory that `owner` keeps alive.
py::array read_only_view(const py::dtype& type, std::vector<py::ssize_t> shape,
                         std::vector<py::ssize_t> strides, const void* data, const py::handle& owner);
py::array read_only_view(const Eigen::VectorXd& values, const py::handle& owner);
py::array read_only_view(const Eigen::MatrixXd& values, const py::handle& owner);

/// A copy.
template <class Range>
py::array_t<double> array_of(const Range& values) {
  py::array_t<double> array(static_cast<py::ssize_t>(values.size()));
  double* to = array.mutable_data();
  for (const auto value : values) *to++ = static_cast<double>(value);
  return array;
}

/// A Python text; bytes that are not UTF-8, as names of files may hold, become U+FFFD.
py::str text_of(const std::string& text);
/// Of a document: json.loads.
py::object from_json(const std::string& text);
/// pandas.DataFrame of columns; ImportError where there is no pandas.
py::object frame_of(const py::dict& columns);

/// A value in TOML: text, number, boolean, list, array, table. Throws InputError naming `key` for another,
/// and for one that is nested too deeply or holds itself.
std::string toml_value(const std::string& key, const py::handle& value);
/// "key = value" lines of a mapping but for the keys in `without`.
std::string toml_lines(const py::handle& mapping, const std::vector<std::string>& without = {});

/// "NAME=VALUE" of keyword arguments, values as text.
std::map<std::string, std::string> named_texts(const py::dict& values);

}  // namespace volcal::python
