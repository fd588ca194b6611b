// What a program does for a controller that the library does not know: a table format is registered, written
// and checked like any other.

#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "own_format.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/io/results/known_errors.h"

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: with_own_format ERRORS\n";
    return EXIT_FAILURE;
  }
  try {
    volcal::register_table_format(lines_format());
    const volcal::FitResult errors = volcal::read_known_errors(arguments[1]);
    const volcal::TableFormat& format = *volcal::find_table_format("lines");
    volcal::TableFormatOptions options;
    options.type = volcal::CompensationPart::Positioning;
    const auto files = volcal::write_tables(format, errors, options);
    const volcal::VolumeCheck left = volcal::check_in_volume(errors, options, format.read(files));
    std::cout << files.size() << " files; RMS in the volume before " << left.before.rms * 1e6
              << " um, after the ideal compensation " << left.ideal.rms * 1e6 << " um, after the tables "
              << left.exported.rms * 1e6 << " um\n";
    const bool same = std::abs(left.exported.rms - left.ideal.rms) < 0.01 * left.ideal.rms &&
                      left.exported.rms < left.before.rms;
    std::cout << (same ? "with_own_format: the tables compensate\n"
                       : "with_own_format: the tables do not compensate\n");
    return same ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
