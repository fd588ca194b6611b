#include "volcal/identify/cli/options/output_file.h"

#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {

void require_no_input(const std::string& output, const std::vector<std::string>& inputs,
                      const std::string& remedy) {
  for (const std::string& input : inputs) {
    if (output.empty() || input.empty() || !same_file(output, input)) continue;
    throw InputError({output, 0}, "the output is a file that is read, and would be overwritten", remedy);
  }
}

}  // namespace volcal::cli
