#include "volcal/identify/workbench/page.h"

#include "volcal/identify/text/embedded_file.h"

#ifdef VOLCAL_WORKBENCH_PAGE
VOLCAL_EMBED_FILE(volcal_workbench_page, VOLCAL_WORKBENCH_PAGE);
#endif

namespace volcal::workbench {

std::string_view page() {
#ifdef VOLCAL_WORKBENCH_PAGE
  return {volcal_workbench_page_begin, volcal_workbench_page_end};
#else
  return {};
#endif
}

}  // namespace volcal::workbench
