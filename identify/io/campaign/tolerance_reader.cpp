#include "volcal/identify/io/campaign/tolerance_reader.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

constexpr double kWidestBand = 1e4;  // um or urad

bool is_positioning(ErrorSymbol symbol) { return symbol.is_positioning(); }
bool is_straight(ErrorSymbol symbol) { return symbol.is_straightness(); }
bool is_angular(ErrorSymbol symbol) { return is_rotation(symbol.component); }

/// Errors that one key sets.
struct ToleranceClass {
  const char* key;
  bool (*holds)(ErrorSymbol symbol);
};
constexpr ToleranceClass kClasses[] = {
    {"positioning_um", is_positioning}, {"straightness_um", is_straight}, {"angles_urad", is_angular}};
constexpr const char* kSquareness = "squareness_urad";

template <class Symbol>
std::string key_of(Symbol symbol) {
  return symbol.name() + "_" + std::string(edge_unit(symbol.component));
}

class ToleranceReader {
 public:
  ToleranceReader(const TomlTable& table, const std::string& file, const Machine& machine)
      : table_(table), machine_(machine) {
    tolerances_.file = file;
  }

  Tolerances read() {
    read_classes();
    for (const ErrorSymbol symbol : linear_axis_motions(machine_)) {
      if (const auto width = width_of(key_of(symbol))) tolerances_.functions[symbol] = *width;
    }
    for (const LocationSymbol symbol : squareness_errors(machine_)) {
      if (const auto width = width_of(key_of(symbol))) tolerances_.squareness[symbol] = *width;
    }
    for (const std::string& key : table_.keys()) refuse_other(key);
    if (tolerances_.functions.empty() && tolerances_.squareness.empty())
      table_.fail("", "[tolerances] states no tolerance", "add positioning_um = 10.0, or EXX_um = 10.0");
    return std::move(tolerances_);
  }

 private:
  std::optional<double> width_of(const std::string& key) const {
    return table_.number(key, {0.0, kWidestBand});
  }

  void read_classes() {
    for (const ToleranceClass& each : kClasses) {
      const auto width = width_of(each.key);
      if (!width) continue;
      for (const ErrorSymbol symbol : linear_axis_motions(machine_)) {
        if (each.holds(symbol)) tolerances_.functions[symbol] = *width;
      }
    }
    const auto width = width_of(kSquareness);
    if (!width) return;
    const auto symbols = squareness_errors(machine_);
    if (symbols.empty())
      table_.fail(kSquareness, "the machine has no squareness", "leave squareness_urad out");
    for (const LocationSymbol symbol : symbols) tolerances_.squareness[symbol] = *width;
  }

  std::vector<std::string> known_keys() const {
    std::vector<std::string> keys;
    for (const ToleranceClass& each : kClasses) keys.emplace_back(each.key);
    keys.emplace_back(kSquareness);
    for (const ErrorSymbol symbol : linear_axis_motions(machine_)) keys.push_back(key_of(symbol));
    for (const LocationSymbol symbol : squareness_errors(machine_)) keys.push_back(key_of(symbol));
    return keys;
  }

  void refuse_other(const std::string& key) const {
    const std::vector<std::string> known = known_keys();
    if (std::ranges::find(known, key) != known.end()) return;
    const std::string stem(stem_of_key(key));
    const auto motion = ErrorSymbol::parse(stem);
    const auto location = LocationSymbol::parse(stem);
    if ((motion && is_rotary(motion->axis)) || (location && is_rotary(location->axis)))
      table_.fail(
          key, stem + " is an error of a rotary axis",
          "leave it out: the budget is that of the linear axes with the rotary axes at 0, where it is "
          "constant");
    table_.fail(key, "tolerances." + printable(key) + " is not a tolerance of this machine",
                suggest_name(key, known, "tolerances"));
  }

  const TomlTable& table_;
  const Machine& machine_;
  Tolerances tolerances_;
};

std::string format_of(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored) || std::filesystem::path(path).extension() != ".toml")
    return {};
  const TomlTable root = TomlDocument::read(path).root();
  return root.kind("format") == TomlKind::Text ? *root.text("format") : std::string();
}

/// A file of tolerances; `machine`: that it is for, or null for the one that it names.
DesignedMachine read_tolerance_file(const std::string& path, const Machine* machine) {
  const TomlDocument document = TomlDocument::read(path);
  document.require_format(kTolerancesFormat);
  const TomlTable root = document.root();
  root.text("name");
  DesignedMachine design;
  if (const auto named = root.text("machine")) {
    design.machine = read_machine(resolve_path(path, *named), root.place("machine"));
    const std::string difference = machine ? machine_difference(design.machine, *machine) : std::string();
    if (!difference.empty())
      root.fail("machine", "the tolerances are for another machine: " + difference,
                "name tolerances of the same machine, or leave out the key machine");
  } else if (machine == nullptr) {
    root.fail_missing(
        "machine", "add machine = \"machine.toml\", or run volcal budget MACHINE.toml --tolerances " + path);
  }
  if (machine != nullptr) design.machine = *machine;
  design.tolerances = read_tolerances(root.required_table("tolerances"), path, design.machine);
  document.reject_unknown();
  return design;
}

Machine machine_of_model(const std::string& path) {
  ModelFile model = read_model_with_machine(path);
  if (states_errors(model.spec))
    throw InputError({path, 0}, "the model states errors, and tolerances are for a machine without",
                     "leave out --tolerances, or give the machine file");
  return std::move(model.machine);
}

}  // namespace

Tolerances read_tolerances(const TomlTable& table, const std::string& file, const Machine& machine) {
  return ToleranceReader(table, file, machine).read();
}

bool is_design(const std::string& path, const std::string& tolerances) {
  const std::string format = format_of(path);
  return !tolerances.empty() || format == kMachineFormat || format == kTolerancesFormat;
}

DesignedMachine read_design(const std::string& path, const std::string& tolerances) {
  const std::string format = format_of(path);
  if (format == kTolerancesFormat) {
    if (!tolerances.empty())
      throw InputError({path, 0}, "the file holds tolerances, and --tolerances gives others",
                       "give the machine file with --tolerances, or the tolerances alone");
    return read_tolerance_file(path, nullptr);
  }
  if (format != kMachineFormat && format != kModelFormat)
    throw InputError({path, 0}, "tolerances are for a machine that is not built yet, and this is none",
                     "give a machine.toml with --tolerances; a result has an uncertainty of its own");
  const Machine machine = format == kModelFormat ? machine_of_model(path) : read_machine(path);
  if (!tolerances.empty()) return read_tolerance_file(tolerances, &machine);
  const TomlDocument document = TomlDocument::read(path);
  const auto table = document.root().table("tolerances");
  if (!table)
    throw InputError({path, 0}, "the machine file states no tolerances, and no errors are known of it",
                     "add [tolerances], or give a file of them with --tolerances");
  return {machine, read_tolerances(*table, path, machine)};
}

}  // namespace volcal
