#include <array>

#include "volcal/identify/io/import/import_format.h"

namespace volcal {

// One line per format, in the order in which files are tried.
#define VOLCAL_IMPORT_FORMATS(FORMAT) \
  FORMAT(rtl_format)                  \
  FORMAT(tracker_points_format)       \
  FORMAT(generic_csv_format)

#define VOLCAL_DECLARE_FORMAT(name) const ImportFormat& name();
#define VOLCAL_ADDRESS_OF_FORMAT(name) &(name)(),
VOLCAL_IMPORT_FORMATS(VOLCAL_DECLARE_FORMAT)

std::span<const ImportFormat* const> import_formats() {
  static const auto kFormats =
      std::to_array<const ImportFormat*>({VOLCAL_IMPORT_FORMATS(VOLCAL_ADDRESS_OF_FORMAT)});
  return kFormats;
}

}  // namespace volcal
