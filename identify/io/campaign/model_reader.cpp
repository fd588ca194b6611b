#include "volcal/identify/io/campaign/model_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/text/toml_document.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr std::int64_t kMostIntervals = 500;
constexpr const char* kToolErrorKey = "offset_error_um";
constexpr double kLargestToolError = 0.01;  // m
constexpr const char* kExpansionKey = "expansion_um_per_m_K";
constexpr double kSamePosition = 1e-9;  // m or rad

std::string coefficient_key(ErrorSymbol symbol) {
  return "coefficients_" + std::string(edge_unit(symbol.component));
}

std::vector<std::string> function_names(const Machine& machine) {
  std::vector<std::string> names = {"default"};
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents)
      names.push_back(ErrorSymbol{component, axis.name}.name());
  }
  return names;
}

class ModelReader {
 public:
  ModelReader(TomlTable root, const std::string& file, const Machine& machine)
      : root_(std::move(root)), machine_(machine) {
    spec_.file = file;
  }

  ModelSpec read(const TomlDocument& document) {
    document.require_format(kModelFormat);
    root_.know("machine");
    root_.text("name");
    read_functions();
    read_locations();
    read_priors();
    read_measured();
    read_axes();
    read_tools();
    read_effects();
    document.reject_unknown();
    check_default();
    return std::move(spec_);
  }

  /// The table [functions] alone.
  std::map<ErrorSymbol, FunctionSpec> functions() {
    read_functions();
    return std::move(spec_.functions);
  }

 private:
  void read_functions() {
    const auto functions = root_.table("functions");
    if (!functions) return;
    if (const auto table = functions->table("default")) spec_.default_function = read_default(*table);
    for (const std::string& name : functions->keys()) {
      if (name == "default") continue;
      const auto symbol = ErrorSymbol::parse(name);
      if (!symbol || !machine_.has_axis(symbol->axis)) {
        reject_location_as_function(*functions, name);
        functions->fail(name, "functions." + printable(name) + " is not an error motion of this machine",
                        suggest_name(name, function_names(machine_), "functions"));
      }
      spec_.functions[*symbol] = read_function(functions->required_table(name), *symbol);
    }
  }

  /// A squareness or another location error is one number and stands in a table of its own.
  void reject_location_as_function(const TomlTable& functions, const std::string& name) const {
    const auto location = LocationSymbol::parse(std::string(stem_of_key(name)));
    if (!location) return;
    const auto known = possible_locations(machine_);
    const std::string symbol = location->name();
    if (std::ranges::find(known, *location) != known.end()) {
      functions.fail(name, "functions." + printable(name) + " is a location error, not an error motion",
                     "write it below [locations]: " + symbol + " = \"zero\" switches it off, " + symbol +
                         "_" + std::string(edge_unit(location->component)) + " = NUMBER states it");
    }
    functions.fail(name,
                   "functions." + printable(name) + " is a location error that this machine does not have",
                   "remove the line; " + location_remedy(known));
  }

  FunctionSpec read_default(const TomlTable& table) {
    for (const char* key : {"knots_mm", "knots_deg", "coefficients_um", "coefficients_urad"}) {
      if (table.has(key)) {
        table.fail(key, "functions.default." + std::string(key) + " cannot hold for every function",
                   "give it to one function, as in EXX = { " + std::string(key) + " = [...] }");
      }
    }
    return read_basis(table, FunctionSpec{});
  }

  FunctionSpec read_function(const TomlTable& table, ErrorSymbol symbol) {
    FunctionSpec spec = read_basis(table, spec_.default_function);
    const Axis& axis = machine_.axis(symbol.axis);
    const BasisKind& kind = *find_basis(spec.basis);
    if (is_rotary(symbol.axis) ? !kind.rotary_axes : !kind.linear_axes) {
      table.fail("basis",
                 table.path() + ": the basis \"" + spec.basis + "\" does not fit " +
                     (is_rotary(symbol.axis) ? "a rotary axis" : "a linear axis"),
                 "choose one of " + bases_for(symbol));
    }
    read_breakpoints(table, axis, kind, spec);
    read_coefficients(table, symbol, axis, kind, spec);
    read_smoothed(table, kind, spec);
    return spec;
  }

  FunctionSpec read_basis(const TomlTable& table, const FunctionSpec& inherited) {
    FunctionSpec spec = inherited;
    if (const auto basis = table.choice("basis", basis_names()); basis && *basis != inherited.basis) {
      spec = FunctionSpec{};
      spec.basis = *basis;
    }
    const BasisKind& kind = *find_basis(spec.basis);
    if (table.has("degree")) {
      if (kind.degree_max == 0) {
        table.fail("degree", table.path() + ": the basis \"" + spec.basis + "\" has no degree",
                   "remove degree");
      }
      read_degree(table, kind, spec);
    }
    if (table.has("knots")) read_knots(table, kind, spec);
    return spec;
  }

  /// "auto": as many harmonics as the readings tell apart, smoothed by evidence.
  static void read_degree(const TomlTable& table, const BasisKind& kind, FunctionSpec& spec) {
    spec.automatic_degree = kind.has_automatic_degree && table.kind("degree") == TomlKind::Text;
    if (spec.automatic_degree) {
      table.choice("degree", {"auto"});
      return;
    }
    spec.degree = static_cast<int>(*table.integer("degree", kind.degree_min, kind.degree_max));
  }

  static void require_knots(const TomlTable& table, const std::string& key, const BasisKind& kind) {
    if (kind.uses_knots) return;
    table.fail(key, table.path() + ": the basis \"" + std::string(kind.name) + "\" has no knots",
               "remove " + key + " or choose basis = \"bspline\"");
  }

  static void read_knots(const TomlTable& table, const BasisKind& kind, FunctionSpec& spec) {
    require_knots(table, "knots", kind);
    const std::string path = table.path() + ".knots";
    switch (table.kind("knots")) {
      case TomlKind::Text:
        table.choice("knots", {"auto"});
        spec.knots = KnotChoice::Automatic;
        return;
      case TomlKind::Integer:
        spec.knots = KnotChoice::IntervalCount;
        spec.intervals = static_cast<int>(*table.integer("knots", 1, kMostIntervals));
        return;
      default:
        table.fail("knots", path + " is neither \"auto\" nor a number of intervals",
                   "write knots = \"auto\", knots = 8, or breakpoints as knots_mm = [...] (knots_deg on a "
                   "rotary axis)");
    }
  }

  void read_breakpoints(const TomlTable& table, const Axis& axis, const BasisKind& kind, FunctionSpec& spec) {
    const bool rotary = is_rotary(axis.name);
    const std::string key = rotary ? "knots_deg" : "knots_mm";
    const std::string other = rotary ? "knots_mm" : "knots_deg";
    if (!table.has(key)) {
      if (table.has(other)) table.fail(other, "unknown key " + table.path() + "." + other, "write " + key);
      return;
    }
    require_knots(table, key, kind);
    if (table.has("knots")) {
      table.fail("knots", table.path() + " has both knots and " + key, "keep one of the two");
    }
    spec.knots = KnotChoice::Explicit;
    spec.breakpoints = *table.numbers(key);
    const std::string name = table.path() + "." + key;
    if (spec.breakpoints.size() < 2)
      table.fail(key, name + " needs at least two breakpoints", "both ends included");
    if (!std::ranges::is_sorted(spec.breakpoints, std::less_equal{})) {
      table.fail(key, name + " is not strictly ascending", "sort the breakpoints, each once");
    }
    const bool ends_fit = std::abs(spec.breakpoints.front() - axis.travel_min) <= kSamePosition &&
                          std::abs(spec.breakpoints.back() - axis.travel_max) <= kSamePosition;
    if (!ends_fit) {
      table.fail(key, name + " does not begin and end at the travel of " + letter_of(axis.name),
                 std::string("first and last breakpoint are the ends of travel_") + (rotary ? "deg" : "mm"));
    }
  }

  void read_coefficients(const TomlTable& table, ErrorSymbol symbol, const Axis& axis, const BasisKind& kind,
                         FunctionSpec& spec) {
    const std::string key = coefficient_key(symbol);
    if (!table.has(key)) return;
    spec.coefficients = *table.numbers(key);
    const std::string name = table.path() + "." + key;
    if (spec.automatic_degree)
      table.fail(key, name + " needs a fixed degree", "write the highest harmonic, as degree = 6");
    if (kind.uses_knots && spec.knots == KnotChoice::Automatic) {
      table.fail(key, name + " needs fixed knots", "add knots_mm (knots_deg), or knots = INTERVALS");
    }
    const bool may_be_smoothed = table.has("smoothed");
    if (!may_be_smoothed) table.reject_unknown();  // a key without effect may be why the number is another
    if (spec.knots == KnotChoice::IntervalCount) spec.breakpoints = uniform_breakpoints(axis, spec.intervals);
    const std::size_t expected = basis_size(table, axis, kind, spec);
    if (spec.coefficients.size() != expected) {
      table.fail(key, name + " has " + std::to_string(spec.coefficients.size()) + " values",
                 "this basis has " + std::to_string(expected) + " coefficients");
    }
  }

  static void read_smoothed(const TomlTable& table, const BasisKind& kind, FunctionSpec& spec) {
    spec.smoothed = table.boolean("smoothed").value_or(false);
    if (!spec.smoothed) return;
    if (!kind.uses_knots && !kind.has_automatic_degree)
      table.fail("smoothed", table.path() + ": the basis \"" + std::string(kind.name) + "\" is not smoothed",
                 "remove smoothed, or choose basis = \"bspline\"");
    if (spec.coefficients.empty())
      table.fail("smoothed", table.path() + ".smoothed is about identified coefficients",
                 "remove it: functions with knots = \"auto\" or degree = \"auto\" are smoothed");
  }

  static std::size_t basis_size(const TomlTable& table, const Axis& axis, const BasisKind& kind,
                                const FunctionSpec& spec) {
    try {
      return static_cast<std::size_t>(kind.make(spec, axis)->size());
    } catch (const std::invalid_argument& error) {
      table.fail("basis", table.path() + ": " + error.what(), "see the documentation of the basis");
    }
  }

  static std::string bases_for(ErrorSymbol symbol) {
    std::vector<std::string> names;
    for (const BasisKind* kind : basis_kinds()) {
      if (is_rotary(symbol.axis) ? kind->rotary_axes : kind->linear_axes) names.emplace_back(kind->name);
    }
    return join_names(names);
  }

  /// The default basis must fit every axis of which a function is left to it.
  void check_default() const {
    const BasisKind& kind = *find_basis(spec_.default_function.basis);
    for (const ErrorSymbol symbol : modelled_motions(machine_, spec_)) {
      const bool fits = is_rotary(symbol.axis) ? kind.rotary_axes : kind.linear_axes;
      if (fits || spec_.functions.contains(symbol)) continue;
      root_.fail("functions",
                 "the default basis \"" + spec_.default_function.basis + "\" does not fit " + symbol.name(),
                 "give " + symbol.name() + " its own basis, one of " + bases_for(symbol));
    }
  }

  void read_locations() {
    const auto table = root_.table("locations");
    if (!table) return;
    for (const std::string& key : table->keys()) {
      const std::string stem(stem_of_key(key));
      const auto symbol = LocationSymbol::parse(stem);
      const auto known = possible_locations(machine_);
      if (!symbol || std::ranges::find(known, *symbol) == known.end()) fail_location(*table, key, known);
      if (table->kind(stem) == TomlKind::Text) {
        table->choice(stem, {"zero"});
        spec_.locations_off.push_back(*symbol);
        continue;
      }
      const std::string wanted = stem + "_" + std::string(edge_unit(symbol->component));
      if (key != wanted) {
        table->fail(key, "unknown key locations." + key,
                    "write " + wanted + " = NUMBER, or " + stem + " = \"zero\"");
      }
      spec_.locations[*symbol] = *table->number(key);
    }
  }

  void read_priors() {
    const auto table = root_.table("priors");
    if (!table) return;
    const auto width = [&](const char* key) {
      const auto value = table->number(key);
      if (value && *value <= 0.0) {
        table->fail(key, "priors." + std::string(key) + " is a standard deviation and must be positive",
                    "leave it out for the program's own");
      }
      return value;
    };
    spec_.priors = {width("displacement_um"), width("rotation_urad"), width("squareness_mrad")};
  }

  /// "X_mm = [-20, 20]", "C_deg = [0, 270]".
  void read_measured() {
    const auto table = root_.table("measured");
    if (!table) return;
    for (const Axis& axis : machine_.axes) {
      const std::string key = letter_of(axis.name) + std::string(is_rotary(axis.name) ? "_deg" : "_mm");
      const auto ends = table->numbers(key);
      if (!ends) continue;
      if (ends->size() != 2 || !(ends->front() <= ends->back()))
        table->fail(key, "measured." + key + " is not the first and the last position",
                    "write [FIRST, LAST]");
      spec_.measured[axis.name] = {ends->front(), ends->back()};
    }
    for (const std::string& key : table->keys()) read_condition(*table, key);
  }

  /// "T_column_degC = [18.9, 21.4, 24.1]"
  void read_condition(const TomlTable& table, const std::string& key) {
    const auto variable = Variable::parse_column(key);
    if (!variable || !variable->changes_at_rest()) return;
    const std::vector<double> values = table.required_numbers(key);
    if (values.size() != 3 || !(values[0] <= values[1] && values[1] <= values[2]))
      table.fail(key, "measured." + printable(key) + " is not the least, mean and greatest value",
                 "write [LEAST, MEAN, GREATEST]");
    const RecordedRange range{values[0], values[1], values[2]};
    if (variable->kind == Variable::Kind::Temperature)
      spec_.conditions.temperature_degC[variable->subject] = range;
    if (variable->kind == Variable::Kind::Time) spec_.conditions.time = range;
    if (variable->kind == Variable::Kind::Feed) spec_.conditions.feed = range;
  }

  /// "[axes.X] expansion_um_per_m_K = 10.05"
  void read_axes() {
    const auto axes = root_.table("axes");
    if (!axes) return;
    for (const std::string& name : axes->keys()) {
      const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
      if (!axis || !machine_.has_axis(*axis))
        axes->fail(name, "axes." + printable(name) + " is not an axis of this machine",
                   "write [axes.X] with the letter of an axis of the machine file");
      const TomlTable table = axes->required_table(name);
      spec_.expansions[*axis] =
          table.required_number(kExpansionKey, {-kLargestExpansion_um_per_m_K, kLargestExpansion_um_per_m_K});
      if (!machine_.axis(*axis).expansion)
        table.fail(kExpansionKey,
                   table.path() + "." + kExpansionKey + ": the machine file has no temperature of this scale",
                   std::string("give the machine file ") + kExpansionKey +
                       " and temperature of this axis, or remove the line");
    }
  }

  /// "[tools.long] offset_error_um = [1.2, -3.4, 0.5]"
  void read_tools() {
    const auto tools = root_.table("tools");
    if (!tools) return;
    for (const std::string& name : tools->keys()) {
      if (!machine_.tool_index(name))
        tools->fail(name, "tools." + printable(name) + " is not a tool of this machine",
                    suggest_name(name, tool_names(machine_), "tools"));
      const TomlTable table = tools->required_table(name);
      const Eigen::Vector3d error = table.required_vector3(kToolErrorKey);
      if (error.cwiseAbs().maxCoeff() > kLargestToolError)
        table.fail(
            kToolErrorKey, table.path() + "." + kToolErrorKey + " is beyond 10 mm",
            "write it in um; an offset that is wrong by more belongs into offset_mm of the machine file");
      spec_.tool_errors[name] = error;
    }
  }

  void fail_location(const TomlTable& table, const std::string& key,
                     const std::vector<LocationSymbol>& known) const {
    table.fail(key, "locations." + printable(key) + " is not a location error of this machine",
               location_remedy(known));
  }

  std::string location_remedy(const std::vector<LocationSymbol>& known) const {
    if (known.empty()) return "a machine with one linear axis has no squareness";
    std::vector<std::string> names;
    names.reserve(known.size());
    for (const LocationSymbol& symbol : known) names.push_back(symbol.name());
    return std::string("with primary ") + letter_of(machine_.datum.primary) + " and secondary " +
           letter_of(machine_.datum.secondary) + " the location errors are " + join_names(names);
  }

  /// An effect states its amplitude in one unit, that of what it acts on; the schema has all of them.
  void check_units(const TomlTable& table, const EffectKind& kind, const EffectSpec& effect) const {
    const std::unique_ptr<Effect> made = kind.make(effect, table.place().file);
    for (const EffectAmplitude& amplitude : made->amplitudes()) {
      for (const KeySchema& key : kind.schema().keys) {
        if (key.key == amplitude.key || stem_of_key(key.key) != stem_of_key(amplitude.key)) continue;
        if (!table.has(key.key)) continue;
        table.fail(key.key, table.path() + ": " + amplitude.label + " is stated in " + amplitude.unit(),
                   "write " + amplitude.key + " = ...");
      }
    }
  }

  void read_effects() {
    std::vector<std::string> kinds;
    for (const EffectKind* effect : effect_kinds()) kinds.push_back(effect->schema().kind);
    for (const TomlTable& table : root_.tables("effects")) {
      EffectSpec effect;
      effect.kind = table.required_text("kind");
      const EffectKind* kind = find_effect(effect.kind);
      if (!kind) {
        table.fail("kind", table.path() + ": effect kind \"" + printable(effect.kind) + "\" is not known",
                   suggest_name(effect.kind, kinds, "kinds"));
      }
      effect.source_line = table.place().line;
      effect.options = table.options(kind->schema().keys);
      check_units(table, *kind, effect);
      spec_.effects.push_back(std::move(effect));
    }
  }

  TomlTable root_;
  const Machine& machine_;
  ModelSpec spec_;
};

void check_machine(const TomlDocument& document, const std::string& file, const Machine& machine) {
  const TomlTable root = document.root();
  const auto named = root.text("machine");
  if (!named) return;
  const std::string path = resolve_path(file, *named);
  if (!machine.file.empty() && same_file(path, machine.file)) return;
  require_machine_of_model(read_machine(path, root.place("machine")), machine, root.place("machine"));
}

/// A folder is no model; what to give in its place.
void require_no_folder(const std::string& path, const SourcePlace& named_at) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error)) return;
  const SourcePlace place = named_at.file.empty() ? SourcePlace{path, 0} : named_at;
  if (fs::exists(fs::path(path) / "identified.toml", error))
    throw InputError(place, path + " is a result, a model file is expected",
                     "give " + (fs::path(path) / "identified.toml").string());
  if (fs::exists(fs::path(path) / "error_tables.csv", error))
    throw InputError(
        place, path + " is a folder of tables, a model file is expected",
        "tables state errors and no bases: write a model.toml, or give the result they were made of");
}

}  // namespace

ModelSpec read_model(const std::string& path, const Machine& machine, const SourcePlace& named_at) {
  require_no_folder(path, named_at);
  const TomlDocument document = TomlDocument::read(path, named_at);
  document.require_format(kModelFormat);
  check_machine(document, path, machine);
  return ModelReader(document.root(), path, machine).read(document);
}

ModelSpec parse_model(const std::string& text, const std::string& file, const Machine& machine) {
  const TomlDocument document = TomlDocument::parse(text, file);
  return ModelReader(document.root(), file, machine).read(document);
}

std::map<ErrorSymbol, FunctionSpec> read_function_specs(const TomlTable& parent, const Machine& machine) {
  return ModelReader(parent, parent.place().file, machine).functions();
}

ModelFile read_model_with_machine(const std::string& path, const SourcePlace& named_at,
                                  const Machine* otherwise) {
  require_no_folder(path, named_at);
  const TomlDocument document = TomlDocument::read(path, named_at);
  document.require_format(kModelFormat);
  const TomlTable root = document.root();
  ModelFile file;
  file.machine = otherwise && !root.has("machine")
                     ? *otherwise
                     : read_machine(resolve_path(path, root.required_text("machine")), root.place("machine"));
  file.spec = ModelReader(root, path, file.machine).read(document);
  return file;
}

}  // namespace volcal
