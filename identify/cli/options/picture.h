#pragma once
/// Pages as PNG and PDF files, drawn by a headless Chromium that the user has installed.

#include <string>

#include "volcal/identify/report/report.h"

namespace volcal::cli {

/// Before anything long is computed. Throws InputError where the file is no .png, its folder does not exist,
/// the program has no report, or no Chromium is installed.
void require_picture(const std::string& option, const std::string& file);

/// Throws InputError where the browser draws nothing.
void write_picture(const std::string& option, const ReportPicture& picture, const std::string& file);

/// Throws InputError with `otherwise` as what else can be done where no Chromium is installed.
void require_browser(const std::string& option, const std::string& otherwise);

/// A page as it prints itself, as PDF. Throws InputError where the browser prints nothing.
void print_page(const std::string& option, const std::string& html, const std::string& file);

}  // namespace volcal::cli
