#pragma once
/// What the library calls settings of the user, in Python: arguments. Where its messages name settings by
/// what they are (SettingText), their names are looked up; elsewhere they name options of the command line,
/// which are found in the text.

#include <string>

namespace volcal::python {

/// A message with arguments in place of options: "--tool zz" is "tool zz". Lines of the command line, which
/// begin with "volcal", stay.
std::string with_arguments(const std::string& message);

/// The argument of a setting: "rotary_step_deg" of "rotary-step"; of one that Python does not have, the
/// option.
std::string argument_of_setting(const std::string& name);

}  // namespace volcal::python
