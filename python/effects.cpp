#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/written_target.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"

namespace volcal::python {
namespace {

constexpr double kLargestValue = 1e12;  // of a driver: squares of larger ones leave no digits to others

/// A parameter of the shape, in its edge unit.
struct OwnParameter {
  std::string key;  ///< with unit: "depth_mm"
  double start = 0.0, least = 0.0, most = 0.0;

  std::string stem() const { return std::string(stem_of_key(key)); }
  std::string unit() const { return std::string(unit_of_key(key).suffix); }
  double si_per_unit() const { return unit_of_key(key).si_per_unit; }
};

/// An effect as a user registers it. Never freed: effects refer to it from any thread until the process ends,
/// when there is no interpreter left to free what is Python's.
struct OwnEffect {
  EffectSchema schema;
  std::vector<std::string> targets;
  std::vector<Variable> variables;
  std::string shape;
  std::vector<OwnParameter> parameters;
  PyObject* driver = nullptr;

  std::string what() const { return "effect " + schema.kind; }
};

/// The readings of a setup while a driver is called.
class ReadingsView {
 public:
  ReadingsView(const SetupView& view, const OwnEffect& effect) : view_(&view), effect_(effect) {}

  void close() { view_ = nullptr; }
  const SetupView& view() const {
    if (view_ == nullptr)
      throw std::runtime_error("readings are there while the driver is called, not later");
    return *view_;
  }
  py::array_t<double> values(const std::string& name) const {
    const auto variable = std::ranges::find(effect_.variables, name, &Variable::written);
    if (variable == effect_.variables.end())
      throw py::key_error(name + " is not among the variables of " + effect_.what() + ": " +
                          listed_names(variables()));
    return array_of(*recorded_variable(view(), *variable));
  }
  std::vector<std::string> variables() const { return written_names(effect_.variables); }

 private:
  const SetupView* view_;
  const OwnEffect& effect_;
};

[[noreturn]] void refuse_driver(const OwnEffect& effect, const SetupView& view, const std::string& problem,
                                const std::string& remedy) {
  throw InputError({}, effect.what() + ": its driver " + problem + " for setup " + view.setup.name, remedy);
}

Eigen::VectorXd checked_values(const OwnEffect& effect, const SetupView& view, const py::object& returned) {
  if (is_complex(returned)) refuse_driver(effect, view, "returned complex numbers", "return real numbers");
  const Doubles array = Doubles::ensure(returned);
  const auto rows = static_cast<py::ssize_t>(view.rows());
  if (!array || array.ndim() != 1 || array.size() != rows) {
    PyErr_Clear();
    refuse_driver(effect, view, "returned no array of shape (" + std::to_string(rows) + ",)",
                  "return one number per reading");
  }
  if (const auto row = first_masked(returned))
    refuse_driver(effect, view, "masks reading " + std::to_string(*row + 1), "return one number per reading");
  Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(array.data(), rows);
  if (!values.allFinite()) {
    refuse_driver(effect, view, "returned a value that is not finite",
                  "write it so that it has a value at every reading, as in numpy.sqrt(numpy.maximum(0, z))");
  }
  if (rows > 0 && values.cwiseAbs().maxCoeff() > kLargestValue) {
    refuse_driver(effect, view, fmt::format("returned a value beyond {:g}", kLargestValue),
                  "scale it, so that its values are about 1: the amplitude has the size");
  }
  return values;
}

/// Readings, which are gone when the driver has ended, whether it returned or raised.
class OpenReadings {
 public:
  OpenReadings(const SetupView& view, const OwnEffect& effect)
      : readings_(std::make_shared<ReadingsView>(view, effect)) {}
  ~OpenReadings() { readings_->close(); }
  OpenReadings(const OpenReadings&) = delete;
  OpenReadings& operator=(const OpenReadings&) = delete;
  const std::shared_ptr<ReadingsView>& get() const { return readings_; }

 private:
  std::shared_ptr<ReadingsView> readings_;
};

Eigen::VectorXd called_driver(const OwnEffect& effect, const SetupView& view, const Eigen::VectorXd& shape) {
  const py::gil_scoped_acquire lock;
  const OpenReadings readings(view, effect);
  py::dict parameters;
  for (std::size_t k = 0; k < effect.parameters.size(); ++k) {
    const OwnParameter& each = effect.parameters[k];
    parameters[py::str(each.key)] = shape[static_cast<Eigen::Index>(k)] / each.si_per_unit();
  }
  const py::object returned =
      py::reinterpret_borrow<py::function>(effect.driver)(readings.get(), **parameters);
  return checked_values(effect, view, returned);
}

/// An own effect with its target.
struct OwnFormula {
  const OwnEffect* own;
  WrittenTarget target;

  bool all_recorded(const Setup& setup) const {
    return std::ranges::all_of(own->variables,
                               [&](const Variable& each) { return has_variable(setup, each); });
  }
  Eigen::MatrixXd values(const SetupView& view, const Eigen::VectorXd& shape) const {
    const auto rows = static_cast<Eigen::Index>(view.rows());
    const bool uses_length =
        std::ranges::find(own->variables, Variable::Kind::Length, &Variable::kind) != own->variables.end();
    const bool measured = view.length.size() == rows || !uses_length;
    if (rows == 0 || !target.acts_on(view.campaign, view.setup) || !all_recorded(view.setup) || !measured)
      return Eigen::VectorXd::Zero(rows);
    return called_driver(*own, view, shape);
  }
  std::size_t unrecorded(const SetupView& view) const {
    return target.acts_on(view.campaign, view.setup) && !all_recorded(view.setup) ? view.rows() : 0;
  }
  void check(const Campaign& campaign, const SourcePlace& place) const {
    target.check(campaign, own->what(), place);
    for (const Variable& variable : own->variables) {
      check_variable(
          campaign, variable, [&](const Setup& setup) { return target.acts_on(campaign, setup); },
          own->what(), "its driver uses " + variable.written(), place);
    }
  }
};

class OwnKind final : public EffectKind {
 public:
  explicit OwnKind(const OwnEffect* own) : own_(own) {}

  /// Registered anew, as when a cell of a notebook is run again; nullptr: no more looked for.
  void become(const OwnEffect* own) const {
    if (own != nullptr) own_ = own;
    is_there_ = own != nullptr;
  }

  const EffectSchema& schema() const override { return own_.load()->schema; }

  std::unique_ptr<Effect> make(const EffectSpec& spec, const std::string& model_file) const override {
    const OwnEffect* own = own_;
    const EffectTable table(spec, model_file);
    if (!is_there_) table.fail("its kind was taken back", "register it again: volcal.register_effect");
    const OwnFormula formula{own, written_target(table)};
    const std::string label = own->schema.kind + " " + formula.target.text;
    auto effect = std::make_unique<FormulaEffect>(
        EffectName{own->schema.kind, formula.target.name(), EffectDriver::written(own->variables),
                   own->shape},
        std::vector<EffectAmplitude>{{.label = label,
                                      .target = formula.target.target(),
                                      .key = formula.target.amplitude_key("amplitude"),
                                      .guess = table.number("amplitude", 0.0)}},
        [formula](const SetupView& view, const Eigen::VectorXd& shape) {
          return formula.values(view, shape);
        },
        [formula](const Campaign& campaign, const SourcePlace& place) { formula.check(campaign, place); });
    effect->be_expression();
    effect->count_unrecorded([formula](const SetupView& view) { return formula.unrecorded(view); });
    for (const OwnParameter& each : own->parameters) {
      effect->add_shape(shape_parameter(table, label + ": " + each.stem(), each.stem(), each.unit(),
                                        each.start * each.si_per_unit(), each.least * each.si_per_unit(),
                                        each.most * each.si_per_unit()));
    }
    return effect;
  }

  /// Of the targets those that the campaign has, and what drives them recorded.
  std::vector<EffectSpec> candidates(const Campaign& campaign) const override {
    std::vector<EffectSpec> specs;
    if (!is_there_) return specs;
    const OwnEffect* own = own_;
    for (const std::string& target : own->targets) {
      EffectSpec spec = effect_spec(own->schema.kind, {{"target", target}});
      try {
        make(spec, {})->check(campaign, {});
      } catch (const InputError&) {
        continue;
      }
      specs.push_back(std::move(spec));
    }
    return specs;
  }

 private:
  mutable std::atomic<const OwnEffect*> own_;
  mutable std::atomic<bool> is_there_ = true;
};

/// Kinds that were registered from Python; changed with the interpreter's lock held.
std::map<std::string, const OwnKind*>& own_kinds() {
  static std::map<std::string, const OwnKind*> kinds;
  return kinds;
}

OwnParameter parameter_of(const std::string& kind, const std::string& key,
                          const std::vector<double>& values) {
  if (values.size() != 3 || !(values[1] < values[2]) || values[0] < values[1] || values[0] > values[2]) {
    throw InputError({}, "effect " + kind + ": parameter " + key + " has no start within a range",
                     "give {\"" + key + "\": (start, least, most)} in the unit that the name ends with");
  }
  return {key, values[0], values[1], values[2]};
}

EffectSchema schema_of(const std::string& kind, const std::string& summary,
                       const std::vector<OwnParameter>& parameters) {
  std::vector<KeySchema> keys = motion_amplitude_keys({""}, "what is added where the driver is 1");
  for (KeySchema& key : keys) {
    key.plausible_min = 1e-18;
    key.plausible_max = 1e9;
  }
  keys.insert(keys.begin(), written_target_key());
  for (const OwnParameter& each : parameters)
    keys = joined({keys, shape_keys(each.stem(), each.unit(), each.stem() + " of the driver")});
  return {.kind = kind, .summary = summary, .source = "the user, in Python", .keys = std::move(keys)};
}

std::vector<Variable> checked_variables(const std::string& what, const std::vector<std::string>& names) {
  if (names.empty())
    throw InputError({}, what + " depends on nothing", "name what its driver uses: variables=[\"x\"]");
  std::vector<Variable> variables;
  for (const std::string& name : names) {
    const auto variable = Variable::parse_written(name);
    if (!variable)
      throw InputError({}, what + ": " + name + " is not a variable", "variables are " + listed_variables());
    variables.push_back(*variable);
  }
  return variables;
}

/// Effects are addressed KIND:TARGET:DRIVER:SHAPE.
void require_kind(const std::string& kind) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  if (kind.empty() || !std::ranges::all_of(kind, fits))
    throw InputError({}, "\"" + kind + "\" cannot be the name of a kind of effects",
                     "name it with letters, digits, - and _ alone");
}

void register_own_effect(const std::string& kind, const py::object& target, const py::function& driver,
                         const std::vector<std::string>& variables, const std::string& summary,
                         const std::map<std::string, std::vector<double>>& parameters) {
  require_kind(kind);
  auto own = std::make_unique<OwnEffect>();
  own->targets = py::isinstance<py::str>(target) ? std::vector{target.cast<std::string>()}
                                                 : target.cast<std::vector<std::string>>();
  own->shape = py::str(py::getattr(driver, "__name__", py::str("driver"))).cast<std::string>();
  for (const auto& [key, values] : parameters) own->parameters.push_back(parameter_of(kind, key, values));
  own->schema = schema_of(kind, summary, own->parameters);
  own->variables = checked_variables(own->what(), variables);
  for (const std::string& each : own->targets)
    written_target(EffectTable(effect_spec(kind, {{"target", each}}), own->what()));
  const auto known = own_kinds().find(kind);
  if (known == own_kinds().end() && find_effect(kind) != nullptr)
    throw InputError({}, own->what() + " is one of the library's", "choose another name");
  own->driver = py::object(driver).release().ptr();
  const OwnEffect* for_ever = own.release();
  if (known != own_kinds().end()) return known->second->become(for_ever);
  auto made = std::make_unique<OwnKind>(for_ever);
  own_kinds()[kind] = made.get();
  register_effect(std::move(made));
}

void unregister_own_effect(const std::string& kind) {
  const auto known = own_kinds().find(kind);
  if (known == own_kinds().end())
    throw InputError({}, "effect " + kind + " is none of your own",
                     "name one that register_effect registered");
  known->second->become(nullptr);
}

py::dict summaries() {
  py::dict kinds;
  for (const EffectKind* kind : effect_kinds())
    kinds[text_of(kind->schema().kind)] = text_of(kind->schema().summary);
  return kinds;
}

py::array_t<double> points_of(const ReadingsView& readings) {
  const auto& points = readings.view().nominal_point_w;
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const Eigen::Vector3d& point : points) {
    for (const double component : point) *to++ = component / kMetrePerMillimetre;
  }
  return array;
}

void define_readings(py::module_& module) {
  py::class_<ReadingsView, std::shared_ptr<ReadingsView>>(
      module, "Readings",
      "The n readings of one setup, as the driver of an own effect sees them while it is called.")
      .def("__getitem__", &ReadingsView::values, py::arg("variable"),
           "A variable: float array of shape (n,). x y z (mm) and a b c (deg) as commanded, dir_x ... dir_c "
           "(-1, 0 = unknown, 1), since_x ... since_c (mm, deg since the axis turned round), t (s since the "
           "first reading), T_<channel> (degC), length (mm to the station), feed "
           "(mm/min), tool_length tool_x tool_y tool_z (mm). Raises KeyError for one that the effect does "
           "not name.")
      .def("__len__", [](const ReadingsView& readings) { return readings.view().rows(); })
      .def(
          "__contains__",
          [](const ReadingsView& readings, const py::object& variable) {
            return py::list(py::cast(readings.variables())).contains(variable);
          },
          py::arg("variable"), "Whether the effect uses a variable.")
      .def(
          "__iter__", [](const ReadingsView& readings) { return py::iter(py::cast(readings.variables())); },
          "Names of the variables.")
      .def_property_readonly("variables", &ReadingsView::variables,
                             "Names of the variables that the effect uses.")
      .def_property_readonly(
          "setup", [](const ReadingsView& readings) { return text_of(readings.view().setup.name); },
          "Name of the setup.")
      .def_property_readonly(
          "instrument", [](const ReadingsView& readings) { return readings.view().setup.instrument; },
          "Kind of instrument: \"laser-tracer\".")
      .def_property_readonly(
          "tool",
          [](const ReadingsView& readings) {
            const SetupView& view = readings.view();
            return text_of(view.campaign.machine.tools[view.setup.tool].name);
          },
          "Name of the tool.")
      .def_property_readonly(
          "points_mm", &points_of,
          "Nominal functional points in workpiece coordinates: float array of shape (n, 3), mm.");
}

}  // namespace

void define_effects(py::module_& module) {
  define_readings(module);
  module.def("register_effect", &register_own_effect, py::arg("kind"), py::kw_only(), py::arg("target"),
             py::arg("driver"), py::arg("variables"), py::arg("summary") = "registered from Python",
             py::arg("parameters") = std::map<std::string, std::vector<double>>(),
             "Adds an effect of your own, which models, fits and diagnoses then know like those of the "
             "library: amplitude "
             "times driver, added to a target. kind: its name, of letters, digits, - and _.\n\n"
             "target: an error motion (\"EAY\"), \"tool x\", \"tool NAME x\", \"station NAME x\" or a column "
             "of readings "
             "(\"length_mm of SETUP\"); or a list of them, of which a diagnosis tests each that the campaign "
             "has. Amplitudes "
             "are in um, of rotations in urad.\n"
             "driver: called with the Readings of a setup, and the parameters by name; returns a float array "
             "of shape (n,), one "
             "value per reading, real and at most 1e12, the same for the same readings. It is called from "
             "threads of the library, "
             "one call at a "
             "time.\n"
             "variables: what the driver uses of the readings (Readings.__getitem__). In setups that did not "
             "record all of "
             "them the effect is zero, and the fit counts their readings.\n"
             "parameters: of the driver's shape, {\"depth_mm\": (start, least, most)} in the unit that the "
             "name ends with; a "
             "diagnosis looks for the best value in that range.\n"
             "Registered again, a kind is replaced. Raises InputError for a kind of the library, and for a "
             "kind, a target or a variable that cannot be one.");
  module.def("unregister_effect", &unregister_own_effect, py::arg("kind"),
             "Takes an effect of your own back: diagnoses no longer look for it, and models with it are "
             "refused. Raises "
             "InputError for a kind that register_effect did not register.");
  module.def("effect_kinds", &summaries, "Kinds of effects with a summary each, the library's and your own.");
}

}  // namespace volcal::python
