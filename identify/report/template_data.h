#pragma once
/// The page's template, kept inside the library; empty when it was built without Node.js.

#include <string_view>

namespace volcal::report {

std::string_view page_template();

}  // namespace volcal::report
