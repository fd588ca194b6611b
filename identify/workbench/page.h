#pragma once
/// The page, kept inside the program; empty when it was built without Node.js.

#include <string_view>

namespace volcal::workbench {

std::string_view page();

}  // namespace volcal::workbench
