#include "volcal/identify/report/template_data.h"

#ifdef VOLCAL_REPORT_TEMPLATE
// The assembler copies the file in: a two-megabyte array in C++ would take the compiler many seconds.
asm(".pushsection .rodata\n"
    ".balign 16\n"
    ".hidden volcal_report_template_begin\n"
    ".hidden volcal_report_template_end\n"
    ".global volcal_report_template_begin\n"
    ".global volcal_report_template_end\n"
    "volcal_report_template_begin:\n"
    ".incbin \"" VOLCAL_REPORT_TEMPLATE
    "\"\n"
    "volcal_report_template_end:\n"
    ".byte 0\n"
    ".popsection\n");
// NOLINTBEGIN(readability-identifier-naming): symbols of the assembler text above
extern "C" const char volcal_report_template_begin[];
extern "C" const char volcal_report_template_end[];
// NOLINTEND(readability-identifier-naming)
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
