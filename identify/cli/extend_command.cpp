#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/named_effect.h"
#include "volcal/identify/io/campaign_reader.h"
#include "volcal/identify/io/model_reader.h"
#include "volcal/identify/io/text_file.h"
#include "volcal/identify/io/toml_writer.h"

namespace volcal::cli {
namespace {

struct Arguments {
  std::string model;
  std::vector<std::string> effects;
  std::string campaign;
  std::string output;
};

/// Path of a file as a file elsewhere names it.
std::string path_from(const std::string& from, const std::string& file) {
  const auto folder = std::filesystem::absolute(from).parent_path();
  return std::filesystem::proximate(std::filesystem::absolute(file), folder).generic_string();
}

int run(const Arguments& arguments) {
  auto [machine, model] = read_model_with_machine(arguments.model);
  Campaign campaign;
  if (arguments.campaign.empty()) {
    campaign.machine = machine;
  } else {
    campaign = read_campaign(arguments.campaign);
  }
  for (const std::string& effect : arguments.effects)
    model.effects.push_back(named_effect("--effect", effect, campaign));
  write_text_file(arguments.output, model_toml(model, path_from(arguments.output, machine.file)));
  fmt::print("written: {} ({} effects)\n", arguments.output, model.effects.size());
  return kDone;
}

std::function<int()> define(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  app.add_option("MODEL", arguments->model, "model.toml to extend")->required();
  app.add_option("-e,--effect", arguments->effects,
                 "KIND:TARGET[:DRIVER[:SHAPE]]; may be given several times")
      ->required();
  app.add_option("--campaign", arguments->campaign,
                 "campaign.toml, for effects of temperatures, stations, setups and tools");
  app.add_option("-o,--output", arguments->output, "model file to write")->required();
  return [arguments] { return run(*arguments); };
}

}  // namespace

const Command& extend_command() {
  static const Command command = {
      "extend", "add effects to a model file",
      "  volcal extend model.toml --effect reversal:EXX -o model-1.toml\n"
      "  volcal extend model.toml --effect axis-coupling:EAY:z:linear -o model-1.toml\n"
      "  volcal extend model.toml --effect thermal-drift:EAZ:T_column --campaign campaign.toml -o "
      "model-1.toml\n",
      define};
  return command;
}

}  // namespace volcal::cli
