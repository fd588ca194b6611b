#include "volcal/identify/cli/options/parameter_option.h"

namespace volcal::cli {

void add_parameter_option(CLI::App& app, std::vector<std::string>& parameters) {
  app.add_option("--parameter", parameters,
                 "p or q of the expression: p=250 is held, p=250+-50 estimated; may be given several times")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace volcal::cli
