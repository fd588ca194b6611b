#pragma once
/// What the user says of the files to import: every option may be given for all files, or for one as
/// FILE:VALUE.

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/io/import/import_format.h"

namespace volcal::cli {

struct ImportOptions {
  std::optional<std::string> encoding, format;
  std::vector<std::string> unit, runs, axis, measures, at, angle_unit, horizontal, vertical, columns,
      instrument, nominal, decimal, tool, set;
};

void add_import_options(CLI::App& app, ImportOptions& options);

/// Of the values of an option the one for `file`, by its path, name or stem, or else the one for all files.
/// Throws InputError for two of either.
std::optional<std::string> value_for(const std::string& file, const std::vector<std::string>& files,
                                     const std::string& option, const std::vector<std::string>& values);

/// Decimal sign of the numbers of one of the files, if it is said. Throws InputError.
std::optional<char> decimal_of(const std::string& file, const std::vector<std::string>& files,
                               const ImportOptions& options);

/// Answers for one of the files. Throws InputError for what cannot be read.
ImportAnswers import_answers(const std::string& file, const std::vector<std::string>& files,
                             const ImportOptions& options);

}  // namespace volcal::cli
