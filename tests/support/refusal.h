#pragma once
/// What bad input is answered with.

#include <string>

#include "volcal/model/description/errors.h"

namespace volcal::testing {

/// what() of the InputError; empty when there is none.
template <class Work>
std::string refusal(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace volcal::testing
