#include "volcal/python/shared/arrays.h"

#include <algorithm>
#include <utility>

#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/model/description/errors.h"
#include "volcal/python/shared/arguments.h"

namespace volcal::python {
namespace {

constexpr int kDeepest = 100;  // as in files

std::string toml_value_at(const std::string& key, const py::handle& value, int depth);

std::string joined_values(const std::string& key, const py::handle& sequence, int depth) {
  std::string text;
  for (const py::handle item : sequence) text += (text.empty() ? "" : ", ") + toml_value_at(key, item, depth);
  return text;
}

std::string toml_table(const std::string& key, const py::handle& mapping, int depth) {
  std::string text;
  for (const py::handle item : mapping.attr("items")()) {
    const auto [given, value] = item.cast<std::pair<py::object, py::object>>();
    const std::string name = text_key(given, key);
    text +=
        (text.empty() ? "" : ", ") + toml_text(name) + " = " + toml_value_at(key + "." + name, value, depth);
  }
  return "{ " + text + " }";
}

std::string toml_value_at(const std::string& key, const py::handle& value, int depth) {
  if (depth > kDeepest)
    throw InputError({}, key.substr(0, key.find('.')) + " is nested too deeply, or holds itself",
                     "give a list or a mapping of texts and numbers");
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return toml_text(value.cast<std::string>());
  if (py::isinstance<py::int_>(value)) return py::str(value).cast<std::string>();
  if (PyFloat_Check(value.ptr()) != 0) return py::repr(py::float_(value.cast<double>())).cast<std::string>();
  if (py::hasattr(value, "items")) return toml_table(key, value, depth + 1);
  if (py::hasattr(value, "tolist")) return toml_value_at(key, value.attr("tolist")(), depth + 1);
  if (py::isinstance<py::sequence>(value)) return "[" + joined_values(key, value, depth + 1) + "]";
  throw InputError({}, key + " is a " + py::str(py::type::of(value).attr("__name__")).cast<std::string>(),
                   "give a text, a number, a boolean, a list or a mapping");
}

}  // namespace

py::array read_only_view(const py::dtype& type, std::vector<py::ssize_t> shape,
                         std::vector<py::ssize_t> strides, const void* data, const py::handle& owner) {
  py::array view(type, std::move(shape), std::move(strides), data, owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

py::array read_only_view(const Eigen::VectorXd& values, const py::handle& owner) {
  constexpr py::ssize_t kStep = sizeof(double);
  return read_only_view(py::dtype::of<double>(), {values.size()}, {kStep}, values.data(), owner);
}

py::array read_only_view(const Eigen::MatrixXd& values, const py::handle& owner) {
  constexpr py::ssize_t kStep = sizeof(double);
  return read_only_view(py::dtype::of<double>(), {values.rows(), values.cols()},
                        {kStep, kStep * values.rows()}, values.data(), owner);
}

py::str text_of(const std::string& text) {
  PyObject* decoded = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

py::object from_json(const std::string& text) {
  return py::module_::import("json").attr("loads")(text_of(text));
}

py::object frame_of(const py::dict& columns) {
  return py::module_::import("pandas").attr("DataFrame")(columns);
}

std::string toml_value(const std::string& key, const py::handle& value) {
  return toml_value_at(key, value, 0);
}

std::string toml_lines(const py::handle& mapping, const std::vector<std::string>& without) {
  std::string text;
  for (const py::handle item : mapping.attr("items")()) {
    const auto [given, value] = item.cast<std::pair<py::object, py::object>>();
    const std::string key = text_key(given, "a mapping");
    if (std::ranges::find(without, key) == without.end() && !value.is_none())
      text += toml_text(key) + " = " + toml_value(key, value) + "\n";
  }
  return text;
}

std::map<std::string, std::string> named_texts(const py::dict& values) {
  std::map<std::string, std::string> texts;
  for (const auto& [name, value] : values)
    texts[py::str(name).cast<std::string>()] = py::str(value).cast<std::string>();
  return texts;
}

}  // namespace volcal::python
