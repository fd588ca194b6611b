#include "volcal/identify/workbench/page.h"

#ifdef VOLCAL_WORKBENCH_PAGE
// As in identify/report/template_data.cpp.
asm(".pushsection .rodata\n"
    ".balign 16\n"
    ".hidden volcal_workbench_page_begin\n"
    ".hidden volcal_workbench_page_end\n"
    ".global volcal_workbench_page_begin\n"
    ".global volcal_workbench_page_end\n"
    "volcal_workbench_page_begin:\n"
    ".incbin \"" VOLCAL_WORKBENCH_PAGE
    "\"\n"
    "volcal_workbench_page_end:\n"
    ".byte 0\n"
    ".popsection\n");
// NOLINTBEGIN(readability-identifier-naming): symbols of the assembler text above
extern "C" const char volcal_workbench_page_begin[];
extern "C" const char volcal_workbench_page_end[];
// NOLINTEND(readability-identifier-naming)
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
