#include <array>
#include <stdexcept>
#include <utility>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/model/description/registration.h"

namespace volcal {

// One line per table format.
#define VOLCAL_TABLE_FORMATS(FORMAT) \
  FORMAT(csv_table_format)           \
  FORMAT(neutral_csv_format)         \
  FORMAT(linuxcnc_format)            \
  FORMAT(linuxcnc_grid_format)       \
  FORMAT(linuxcnc_trt_format)        \
  FORMAT(klipper_format)             \
  FORMAT(marlin_format)              \
  FORMAT(isg_csv_format)             \
  FORMAT(etalon_exchange_format)     \
  FORMAT(isg_ssfk_format)            \
  FORMAT(sinumerik_format)           \
  FORMAT(sinumerik_cec_format)       \
  FORMAT(heidenhain_format)          \
  FORMAT(fanuc_format)

#define VOLCAL_DECLARE_FORMAT(name) const TableFormat& name();
#define VOLCAL_ADDRESS_OF_FORMAT(name) &(name)(),
VOLCAL_TABLE_FORMATS(VOLCAL_DECLARE_FORMAT)

namespace {

Registration<TableFormat>& registered_table_formats() {
  static Registration<TableFormat> formats(
      {VOLCAL_TABLE_FORMATS(VOLCAL_ADDRESS_OF_FORMAT)},
      [](const TableFormat& format) -> std::string_view { return format.name; });
  return formats;
}

}  // namespace

std::span<const TableFormat* const> table_formats() { return registered_table_formats().all(); }

const TableFormat* find_table_format(std::string_view name) { return registered_table_formats().find(name); }

const TableFormat& register_table_format(std::unique_ptr<const TableFormat> format) {
  if (format != nullptr && (format->write == nullptr || format->read == nullptr))
    throw std::invalid_argument("a table format needs both write and read");
  return registered_table_formats().add(std::move(format));
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
