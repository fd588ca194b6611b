#include "volcal/python/shared/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "volcal/identify/numeric/threads.h"
#include "volcal/model/description/units.h"

namespace volcal::python {
namespace {

constexpr std::string_view kKindsOfNumbers = "biufOUS";  // of numpy; objects and texts are converted

std::string type_name(const py::handle& value) {
  return py::str(py::type::of(value).attr("__name__")).cast<std::string>();
}

std::string shown(double value) { return fmt::format("{:g}", value); }

[[noreturn]] void refuse_value(const std::string& argument, double value, const std::string& remedy) {
  throw InputError({}, argument + " is " + shown(value), remedy);
}

}  // namespace

std::optional<py::ssize_t> first_masked(const py::handle& values) {
  const py::object masked = py::module_::import("numpy").attr("ma");
  if (!py::isinstance(values, masked.attr("MaskedArray"))) return std::nullopt;
  const py::object mask = masked.attr("getmaskarray")(values);
  if (!mask.attr("any")().cast<bool>()) return std::nullopt;
  return mask.attr("argmax")().cast<py::ssize_t>();
}

bool is_complex(const py::handle& values) {
  const py::array given = py::array::ensure(values);
  if (given) return given.dtype().kind() == 'c';
  PyErr_Clear();
  return false;
}

Doubles numbers_of(const py::handle& values, const std::string& file, const std::string& what,
                   const std::string& remedy) {
  const py::array given = py::array::ensure(values);
  const char kind = given ? given.dtype().kind() : ' ';
  if (kind == 'c') throw InputError({file, 0}, what + " is complex", "give real numbers");
  const bool of_numbers = kKindsOfNumbers.find(kind) != std::string_view::npos;
  Doubles array = of_numbers ? Doubles::ensure(given) : Doubles();
  if (!of_numbers || !array || array.ndim() != 1) {
    PyErr_Clear();
    throw InputError({file, 0}, what + " is not an array of numbers of one dimension", remedy);
  }
  if (const auto row = first_masked(values)) {
    const int number = static_cast<int>(*row) + 1;
    throw InputError({file, file.empty() ? 0 : number}, fmt::format("row {} of {} is masked", number, what),
                     "leave out rows without a reading");
  }
  return array;
}

double number_of(const py::handle& value, const std::string& argument) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw InputError({}, argument + " is a " + type_name(value), "give a number");
  }
  require_finite(argument, number);
  return number;
}

void require_finite(const std::string& argument, double value) {
  if (!std::isfinite(value)) refuse_value(argument, value, "give a finite number");
}

void require_positive(const std::string& argument, double value) {
  if (!std::isfinite(value) || value <= 0.0) refuse_value(argument, value, "give a positive number");
}

void require_not_negative(const std::string& argument, double value) {
  if (!std::isfinite(value) || value < 0.0) refuse_value(argument, value, "give 0 or a positive number");
}

void require_range(const std::string& argument, long long value, long long least, long long most) {
  if (value >= least && value <= most) return;
  throw InputError({}, fmt::format("{} is {}", argument, value), fmt::format("give {} to {}", least, most));
}

void require_threads(int threads) { require_range("threads", threads, 0, kMostThreads); }

AxisPosition position_of(const Machine& machine, const py::dict& given, const std::string& argument) {
  AxisPosition position{};
  for (const Axis& axis : machine.axes) position[index_of(axis.name)] = axis.home;
  for (const auto& [name, value] : given) {
    const std::string key = py::str(name).cast<std::string>();
    const auto axis = std::ranges::find_if(
        machine.axes, [&](const Axis& each) { return position_column(each.name) == key; });
    if (axis == machine.axes.end())
      throw InputError({}, argument + ": " + key + " is not a position of an axis of the machine",
                       "give x_mm, y_mm, z_mm ...");
    position[index_of(axis->name)] =
        number_of(value, argument + " " + key) * position_unit(axis->name).si_per_unit;
  }
  return position;
}

std::string text_key(const py::handle& key, const std::string& of) {
  if (py::isinstance<py::str>(key)) return key.cast<std::string>();
  throw InputError({}, of + ": the key " + py::repr(key).cast<std::string>() + " is not a text",
                   "give names as texts");
}

void require_mapping(const py::handle& value, const std::string& what, const std::string& remedy) {
  if (!py::hasattr(value, "items")) throw InputError({}, what + " is a " + type_name(value), remedy);
}

}  // namespace volcal::python
