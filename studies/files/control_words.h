#pragma once
/// Files of tables as words, for the simulated control's own reading of them. Apart from the readers of the
/// table formats: a mistake there must not cancel here.

#include <string>
#include <vector>

#include "volcal/model/description/machine.h"

namespace volcal {

using Words = std::vector<std::string>;

/// Lines as words, any of `separators` between them; empty lines are left out.
std::vector<Words> lines_of_words(const std::string& text, const std::string& separators);

/// The axis whose letter begins a word. Throws std::logic_error for another.
AxisName axis_in(const std::string& word);

}  // namespace volcal
