#include <algorithm>
#include <array>

#include "volcal/identify/compensation/table_format.h"

namespace volcal {

// One line per table format.
#define VOLCAL_TABLE_FORMATS(FORMAT) \
  FORMAT(csv_table_format)           \
  FORMAT(neutral_csv_format)         \
  FORMAT(linuxcnc_format)            \
  FORMAT(linuxcnc_grid_format)       \
  FORMAT(klipper_format)             \
  FORMAT(marlin_format)              \
  FORMAT(isg_csv_format)             \
  FORMAT(etalon_exchange_format)     \
  FORMAT(isg_ssfk_format)            \
  FORMAT(sinumerik_format)           \
  FORMAT(sinumerik_cec_format)       \
  FORMAT(heidenhain_format)          \
  FORMAT(fanuc_format)

#define VOLCAL_DECLARE(name) const TableFormat& name();
#define VOLCAL_ADDRESS(name) &(name)(),
VOLCAL_TABLE_FORMATS(VOLCAL_DECLARE)

std::span<const TableFormat* const> table_formats() {
  static const auto kFormats = std::to_array<const TableFormat*>({VOLCAL_TABLE_FORMATS(VOLCAL_ADDRESS)});
  return kFormats;
}

const TableFormat* find_table_format(std::string_view name) {
  const auto formats = table_formats();
  const auto found = std::ranges::find(formats, name, &TableFormat::name);
  return found == formats.end() ? nullptr : *found;
}

std::span<const RefusedFormat> refused_table_formats() {
  static constexpr std::array<RefusedFormat, 1> kRefused = {
      {{"sinumerik-vcs", "no public grammar of its files is known"}}};
  return kRefused;
}

std::vector<std::string> table_format_names() {
  std::vector<std::string> names;
  for (const TableFormat* format : table_formats()) names.emplace_back(format->name);
  return names;
}

}  // namespace volcal
