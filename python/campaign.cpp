#include "volcal/model/description/campaign.h"

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/record_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/findings.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

/// A setup of a campaign that it keeps alive.
struct SetupOf {
  std::shared_ptr<const Campaign> campaign;
  std::size_t index = 0;

  const Setup& setup() const { return campaign->setups[index]; }
  std::vector<ReadingColumn> columns() const { return reading_columns(setup(), campaign->machine); }
};

std::shared_ptr<Campaign> read_campaign_of(const std::filesystem::path& path) {
  return without_lock([&] { return std::make_shared<Campaign>(read_campaign(path.string())); });
}

/// Readings in memory: what `columns` refers to lives in `arrays`.
struct GivenReadings {
  std::vector<Doubles> arrays;
  std::vector<std::vector<NumberColumn>> columns;

  void add(const std::string& setup, const py::handle& readings) {
    if (!py::hasattr(readings, "items"))
      throw InputError({}, "setup \"" + setup + "\" has no readings",
                       "give \"readings\": a mapping from column to array, as {\"x_mm\": [...], ...}");
    std::vector<NumberColumn>& of_setup = columns.emplace_back();
    for (const py::handle item : readings.attr("items")()) {
      const auto [key, values] = item.cast<std::pair<py::object, py::object>>();
      const std::string file = "readings of " + setup;
      const std::string name = text_key(key, file);
      Doubles array = numbers_of(values, file, "column " + name, "give one number per reading");
      of_setup.push_back({name, {array.data(), static_cast<std::size_t>(array.size())}});
      arrays.push_back(std::move(array));
    }
  }
};

std::string name_in(const py::handle& setup) {
  const py::object name = setup.attr("get")("name");
  return py::isinstance<py::str>(name) ? name.cast<std::string>() : std::string("without a name");
}

std::shared_ptr<Campaign> campaign_of_arrays(const Machine& machine, const py::sequence& setups,
                                             const py::object& noise, const std::string& name,
                                             const std::string& active_compensations) {
  std::string text = "format = \"" + std::string(kCampaignFormat) + "\"\n";
  if (!active_compensations.empty())
    text += "active_compensations = " + toml_text(active_compensations) + "\n";
  if (!noise.is_none()) {
    require_mapping(noise, "noise", "give a mapping as the table [noise], {\"constant_um\": 0.3}");
    text += "[noise]\n" + toml_lines(noise);
  }
  GivenReadings given;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const py::object setup = setups[i];
    require_mapping(setup, fmt::format("setup {}", i + 1),
                    "give mappings with the keys of [[setups]], {\"name\": \"L\", \"readings\": {...}, ...}");
    given.add(name_in(setup), setup.attr("get")("readings"));
    text += "[[setups]]\n" + toml_lines(setup, {"readings"});
  }
  return without_lock(
      [&] { return std::make_shared<Campaign>(campaign_in_memory(text, name, machine, given.columns)); });
}

void write_campaign_folder(const Campaign& campaign, const std::filesystem::path& path) {
  without_lock([&] {
    AtomicFolder folder(path.string(), Replaceable::Unedited);
    folder.write("machine.toml", machine_toml(campaign.machine));
    write_campaign(campaign, folder.path(), "machine.toml");
    std::error_code ignored;
    if (std::filesystem::is_regular_file(campaign.file, ignored))
      folder.write("campaign.toml", campaign_toml(campaign, "machine.toml") +
                                        record_toml(read_campaign_record(campaign.file)));
    folder.commit_to_be_edited();
  });
}

std::vector<SetupOf> setups_of(const std::shared_ptr<Campaign>& campaign) {
  if (campaign == nullptr) throw py::type_error("None is not a Campaign");
  std::vector<SetupOf> setups;
  for (std::size_t i = 0; i < campaign->setups.size(); ++i) setups.push_back({campaign, i});
  return setups;
}

py::array_t<double> in_edge_unit(const ReadingColumn& column) {
  py::array_t<double> array = array_of(column.values);
  double* values = array.mutable_data();
  for (py::ssize_t i = 0; i < array.size(); ++i) values[i] /= column.si_per_unit;
  return array;
}

py::dict columns_dict(const SetupOf& setup) {
  py::dict columns;
  for (const ReadingColumn& column : setup.columns()) columns[text_of(column.name)] = in_edge_unit(column);
  return columns;
}

py::array_t<double> column_of(const SetupOf& setup, const std::string& name) {
  const std::vector<ReadingColumn> columns = setup.columns();
  const auto found = std::ranges::find(columns, name, &ReadingColumn::name);
  if (found != columns.end()) return in_edge_unit(*found);
  std::vector<std::string> names;
  for (const ReadingColumn& column : columns) names.push_back(column.name);
  throw py::key_error(name + ": the columns are " + listed_names(names));
}

py::list column_names(const SetupOf& setup) {
  py::list names;
  for (const ReadingColumn& column : setup.columns()) names.append(text_of(column.name));
  return names;
}

void define_setup(py::module_& module) {
  py::class_<SetupOf>(module, "Setup", "One setup of a campaign: an instrument, a tool and n readings.")
      .def_property_readonly(
          "name", [](const SetupOf& of) { return text_of(of.setup().name); }, "Name of the setup.")
      .def_property_readonly(
          "instrument", [](const SetupOf& of) { return of.setup().instrument; },
          "Kind of instrument: \"laser-tracer\".")
      .def_property_readonly(
          "tool", [](const SetupOf& of) { return text_of(of.campaign->machine.tools[of.setup().tool].name); },
          "Name of the tool.")
      .def_property_readonly("columns", &column_names,
                             "Names of the columns, with units, as in its CSV file.")
      .def("__len__", [](const SetupOf& of) { return of.setup().readings.size(); })
      .def("__getitem__", &column_of, py::arg("column"),
           "A column by its name: float array of shape (n,), in the unit of the name, a copy. Raises "
           "KeyError.")
      .def(
          "__contains__",
          [](const SetupOf& setup, const py::object& column) { return column_names(setup).contains(column); },
          py::arg("column"), "Whether it has a column of this name.")
      .def(
          "__iter__", [](const SetupOf& setup) { return py::iter(column_names(setup)); },
          "Names of the columns.")
      .def("to_dict", &columns_dict,
           "All columns by name: float arrays of shape (n,), in the units of the names, copies.")
      .def(
          "to_frame", [](const SetupOf& of) { return frame_of(columns_dict(of)); },
          "All columns as a pandas DataFrame of n rows. Raises ImportError without pandas.")
      .def("__repr__", [](const SetupOf& of) {
        return text_of("<volcal.Setup " + of.setup().name + ", " + of.setup().instrument + ", " +
                       std::to_string(of.setup().readings.size()) + " readings>");
      });
}

}  // namespace

void define_campaign(py::module_& module) {
  define_setup(module);
  py::class_<Campaign, std::shared_ptr<Campaign>>(
      module, "Campaign", "A measuring campaign: a machine, and setups with their readings.")
      .def_static(
          "from_arrays", &campaign_of_arrays, py::arg("machine"), py::arg("setups"), py::kw_only(),
          py::arg("noise") = py::none(), py::arg("name") = "arrays", py::arg("active_compensations") = "",
          "Campaign of readings in memory, checked as those of files are.\n\n"
          "setups: a sequence of mappings with the keys of a [[setups]] table of campaign.toml (\"name\", "
          "\"instrument\", \"tool\", \"station_mm\", \"noise\" ...) but those of files (\"data\", "
          "\"delimiter\", "
          "\"decimal\", \"encoding\", \"skip_rows\"), and \"readings\": a mapping from column to array of "
          "shape (n,), or a pandas DataFrame, columns named as in CSV files and in "
          "the units of their names (\"x_mm\", \"length_mm\", \"dir_x\", \"time_s\", \"T_air_degC\").\n"
          "noise: a mapping as the table [noise]. name: stands for the file in messages.\n"
          "Arrays of float64 in one piece are read where they are, others converted first; masked and "
          "complex "
          "ones are refused. Raises InputError with the setup and the row, from 1.")
      .def_property_readonly(
          "file", [](const Campaign& campaign) { return text_of(campaign.file); },
          "Path of campaign.toml, or the name that was given.")
      .def_property_readonly(
          "machine", [](const Campaign& campaign) { return campaign.machine; },
          "The machine that was measured.")
      .def_property_readonly(
          "setups",
          [](const std::shared_ptr<Campaign>& campaign) {
            py::list list;
            for (const SetupOf& setup : setups_of(campaign)) list.append(setup);
            return list;
          },
          "The setups, in the order of the file.")
      .def_property_readonly("reading_count", &Campaign::reading_count,
                             "Number of observations: rows times channels, over all setups.")
      .def_property_readonly(
          "notes", [](const Campaign& campaign) { return findings_of(campaign.notes); },
          "What was noticed while it was read.")
      .def("write", &write_campaign_folder, py::arg("path"),
           "Writes machine.toml, campaign.toml and one CSV file per setup into a folder. Raises InputError.")
      .def("__repr__", [](const Campaign& campaign) {
        return text_of("<volcal.Campaign " + campaign.file + ", " + std::to_string(campaign.setups.size()) +
                       " setups, " + std::to_string(campaign.reading_count()) + " readings>");
      });
  module.def("read_campaign", &read_campaign_of, py::arg("path"),
             "Campaign of a campaign.toml, with its machine and all readings. Raises InputError with file, "
             "line, problem "
             "and remedy.");
}

}  // namespace volcal::python
