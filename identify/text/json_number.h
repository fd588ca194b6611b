#pragma once

#include <nlohmann/json.hpp>

namespace volcal {

/// A number, or its name where it is not finite, which JSON cannot write: "nan", "inf", "-inf".
nlohmann::ordered_json number_json(double value);
/// Throws std::exception where `json` is neither.
double number_from(const nlohmann::ordered_json& json);

}  // namespace volcal
