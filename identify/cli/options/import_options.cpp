#include "volcal/identify/cli/options/import_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>

#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"

namespace volcal::cli {
namespace {

bool names_file(const std::string& name, const std::string& file) {
  const std::filesystem::path path(file);
  return name == file || name == path.filename().string() || name == path.stem().string();
}

/// The file that a value is for; empty = for all.
std::string file_of_value(const std::string& value, const std::vector<std::string>& files) {
  const std::string name = value.substr(0, value.find(':'));
  if (name.size() == value.size()) return "";
  for (const std::string& file : files) {
    if (names_file(name, file)) return name;
  }
  return "";
}

std::map<AxisName, double> positions_of(const std::string& text) {
  std::map<AxisName, double> positions;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    const auto axis =
        part.size() > 2 && part[1] == '='
            ? axis_from_letter(static_cast<char>(std::toupper(static_cast<unsigned char>(part[0]))))
            : std::nullopt;
    double value = 0.0;
    if (!axis || !CLI::detail::lexical_cast(part.substr(2), value) || !std::isfinite(value))
      throw InputError(
          {}, "--at " + printable(text) + ": \"" + printable(part) + "\" is not a position of an axis",
          "write axes and positions in mm or deg, as in Y=100,Z=-200");
    if (!positions.emplace(*axis, value).second)
      throw InputError({}, "--at " + printable(text) + " gives " + letter_of(*axis) + " twice",
                       "leave one of the two out");
  }
  return positions;
}

std::optional<TextEncoding> encoding_option(const std::optional<std::string>& name) {
  if (!name) return std::nullopt;
  const auto encoding = encoding_of_name(*name);
  if (!encoding)
    throw InputError({}, "--encoding \"" + printable(*name) + "\" is not known",
                     suggest_name(*name, encoding_names(), "encodings"));
  return encoding;
}

/// "KEY = VALUE" of the setup.
void add_key(const std::string& text, std::map<std::string, std::string>& keys) {
  const std::size_t equals = text.find('=');
  const auto trimmed = [](const std::string& part) {
    const std::size_t start = part.find_first_not_of(" \t");
    return start == std::string::npos ? "" : part.substr(start, part.find_last_not_of(" \t") - start + 1);
  };
  const std::string key = trimmed(text.substr(0, equals));
  const bool bare = !key.empty() && key.find_first_not_of(
                                        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
                                        std::string::npos;
  const std::string value = equals == std::string::npos ? "" : trimmed(text.substr(equals + 1));
  if (!bare || value.empty() || value.find('\n') != std::string::npos)
    throw InputError({}, "--set \"" + printable(text) + "\" is not a key and a value",
                     "write it as in campaign.toml: --set \"noise = { constant_um = 0.3 }\"");
  keys[key] = value;
}

}  // namespace

void add_import_options(CLI::App& app, ImportOptions& options) {
  const auto add = [&app](const char* name, std::vector<std::string>& values, const char* help) {
    app.add_option(name, values, help)
        ->delimiter('\0')
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  std::string formats, encodings;
  for (const ImportFormat* format : import_formats())
    formats +=
        (formats.empty() ? "" : "; ") + std::string(format->name()) + ": " + std::string(format->summary());
  for (const std::string& name : encoding_names()) encodings += (encodings.empty() ? "" : " ") + name;
  app.add_option("--format", options.format, "default: recognised by content; " + formats);
  app.add_option("--encoding", options.encoding, "of files that are not UTF-8: " + encodings);
  add("--unit", options.unit, "of deviations or lengths: um mm nm m inch; of angles: arcsec urad deg");
  add("--runs", options.runs,
      "order of a laser's runs: forward, backward, alternating (bidirectional is the same)");
  add("--axis", options.axis, "the axis that moves");
  add("--measures", options.measures, "the error that a laser's runs read: EXX, EYX, ECX ...");
  add("--at", options.at,
      "where the other axes stood, mm or deg; of the axis that moves: added to its targets");
  add("--angle-unit", options.angle_unit, "of a tracker's angles: gon, deg, rad");
  add("--horizontal", options.horizontal,
      "sense of a tracker's horizontal angle, from above: clockwise, counterclockwise");
  add("--vertical", options.vertical,
      "a tracker's vertical angle counts from: zenith, elevation (the horizon)");
  add("--columns", options.columns,
      "of a list without header, its columns of numbers: x,y,z or hz,v,distance");
  add("--nominal", options.nominal,
      "CSV of the positions commanded for a tracker's points: name,x_mm,y_mm,z_mm");
  add("--decimal", options.decimal,
      "sign of the numbers, of --nominal, too, where they do not tell it: point (1,000 is a thousand), "
      "comma");
  add("--instrument", options.instrument, "of a table whose columns several instruments have");
  add("--tool", options.tool, "of the machine, at which was measured; needed where it has several");
  add("--set", options.set, "a key of the setup as campaign.toml has it: \"noise = { constant_um = 0.3 }\"");
}

std::optional<std::string> value_for(const std::string& file, const std::vector<std::string>& files,
                                     const std::string& option, const std::vector<std::string>& values) {
  std::optional<std::string> for_all, for_this;
  for (const std::string& value : values) {
    const std::string owner = file_of_value(value, files);
    if (!owner.empty() && !names_file(owner, file)) continue;
    auto& found = owner.empty() ? for_all : for_this;
    if (found)
      throw InputError({}, option + " is given twice for " + (owner.empty() ? "all files" : printable(owner)),
                       "leave one of the two out, or say FILE:VALUE");
    found = owner.empty() ? value : value.substr(owner.size() + 1);
  }
  return for_this ? for_this : for_all;
}

std::optional<char> decimal_of(const std::string& file, const std::vector<std::string>& files,
                               const ImportOptions& options) {
  const auto name = value_for(file, files, "--decimal", options.decimal);
  if (!name) return std::nullopt;
  require_choice("--decimal", *name, {"point", "comma"});
  return *name == "comma" ? ',' : '.';
}

ImportAnswers import_answers(const std::string& file, const std::vector<std::string>& files,
                             const ImportOptions& options) {
  const auto value = [&](const char* option, const std::vector<std::string>& values) {
    return value_for(file, files, option, values);
  };
  ImportAnswers answers;
  answers.encoding = encoding_option(options.encoding);
  answers.unit = value("--unit", options.unit);
  answers.runs = value("--runs", options.runs);
  answers.axis = value("--axis", options.axis);
  answers.measures = value("--measures", options.measures);
  answers.angle_unit = value("--angle-unit", options.angle_unit);
  answers.horizontal = value("--horizontal", options.horizontal);
  answers.vertical = value("--vertical", options.vertical);
  answers.columns = value("--columns", options.columns);
  if (const auto nominal = value("--nominal", options.nominal))
    answers.nominal = {*nominal, read_foreign_text(*nominal, answers.encoding, "give --encoding "),
                       decimal_of(file, files, options)};
  answers.instrument = value("--instrument", options.instrument);
  if (const auto at = value("--at", options.at)) answers.at = positions_of(*at);
  for (const bool for_one : {false, true}) {
    for (const std::string& each : options.set) {
      const std::string owner = file_of_value(each, files);
      if (owner.empty() == for_one || (for_one && !names_file(owner, file))) continue;
      add_key(for_one ? each.substr(owner.size() + 1) : each, answers.keys);
    }
  }
  return answers;
}

}  // namespace volcal::cli
