#include "volcal/identify/report/template_data.h"

#include "volcal/identify/text/embedded_file.h"

#ifdef VOLCAL_REPORT_TEMPLATE
VOLCAL_EMBED_FILE(volcal_report_template, VOLCAL_REPORT_TEMPLATE);
#endif

namespace volcal::report {

std::string_view page_template() {
#ifdef VOLCAL_REPORT_TEMPLATE
  return {volcal_report_template_begin, volcal_report_template_end};
#else
  return {};
#endif
}

}  // namespace volcal::report
