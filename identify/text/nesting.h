#pragma once
/// How deep a text is nested, found before a parser goes down with it: parsers and the destructors of what
/// they build call themselves at every bracket.

#include <string>

namespace volcal {

enum class NestedText { Json, Toml };

/// Throws InputError for brackets, or keys joined by dots, deeper than any file of volcal; `file` names the
/// text.
void require_shallow(const std::string& text, NestedText kind, const std::string& file);

}  // namespace volcal
