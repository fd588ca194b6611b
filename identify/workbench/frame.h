#pragma once
/// Columns of numbers behind a JSON text, as the page of the workbench reads them
/// (docs/workbench-protocol.md): 4 bytes length of the text, the text, blanks to a multiple of 4 bytes, then
/// float32, all little endian.

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace volcal::workbench {

using Json = nlohmann::ordered_json;

/// `names` become json["columns"].
std::string frame(Json json, const std::vector<std::string>& names,
                  const std::vector<Eigen::VectorXd>& columns);

}  // namespace volcal::workbench
