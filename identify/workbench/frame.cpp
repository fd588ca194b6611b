#include "volcal/identify/workbench/frame.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "volcal/identify/text/json_text.h"

namespace volcal::workbench {

static_assert(std::endian::native == std::endian::little, "columns are sent as they are in memory");

std::string frame(Json json, const std::vector<std::string>& names,
                  const std::vector<Eigen::VectorXd>& columns) {
  json["columns"] = names;
  std::string text = json_text(json, -1);
  while (text.size() % sizeof(float) != 0) text += ' ';
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string framed(sizeof length, '\0');
  std::memcpy(framed.data(), &length, sizeof length);
  framed += text;
  for (const Eigen::VectorXd& column : columns) {
    const Eigen::VectorXf values = column.cast<float>();
    framed.append(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::size_t>(values.size()) * sizeof(float));
  }
  return framed;
}

}  // namespace volcal::workbench
