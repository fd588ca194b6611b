#pragma once
/// Messages of the library name options of the command line; in Python these are arguments.

#include <string>

namespace volcal::python {

/// A message with arguments in place of options: "--tool zz" is "tool zz". Lines of the command line, which
/// begin with "volcal", stay.
std::string with_arguments(const std::string& message);

}  // namespace volcal::python
