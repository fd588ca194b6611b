#pragma once
/// JSON that the program wrote and that may have been cut off or changed since.

#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/model/description/errors.h"

namespace volcal {

/// Throws InputError with the line where the text is no JSON, or nested too deep.
nlohmann::ordered_json parsed_json(const std::string& text, const std::string& file,
                                   const std::string& remedy);

/// What is wrong with the content, in words.
std::string json_problem(const std::exception& error);

/// `read` of the JSON in `text`; whatever it throws becomes an InputError: "the `what` cannot be used: ...".
template <class Read>
auto read_json(const std::string& text, const std::string& file, const std::string& what,
               const std::string& remedy, const Read& read) {
  try {
    return read(parsed_json(text, file, remedy));
  } catch (const InputError& error) {
    if (!error.place().file.empty()) throw;
    throw InputError({file, 0}, "the " + what + " cannot be used: " + json_problem(error), remedy);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError({file, 0}, "the " + what + " cannot be used: " + json_problem(error), remedy);
  }
}

}  // namespace volcal
