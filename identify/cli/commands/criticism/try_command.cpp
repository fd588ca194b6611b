#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/parameter_option.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/report/text/criticism/tried_text.h"
#include "volcal/identify/session/tried_effect.h"

namespace volcal::cli {
namespace {

struct TryArguments {
  std::string campaign;
  std::string effect;
  std::string model;
  std::vector<std::string> parameters;
  int threads = 0;
  bool json = false;
};

int run_try(const TryArguments& arguments) {
  const WrittenEffect effect = written_effect("EFFECT", arguments.effect, arguments.parameters);
  const Campaign campaign = read_campaign(arguments.campaign);
  const ModelSpec model =
      arguments.model.empty() ? ModelSpec{} : read_model(arguments.model, campaign.machine);
  ProgressBar bar("try");
  const TryOptions options{arguments.threads,
                           [&bar](const std::string& stage, double done) { bar.update(stage, done); }};
  const TriedEffect tried =
      at_its_column("EFFECT", arguments.effect, [&] { return try_effect(campaign, model, effect, options); });
  bar.finish();
  fmt::print("{}",
             arguments.json ? tried_json(arguments.effect, tried) : tried_text(arguments.effect, tried));
  return tried.done() ? kDone : kIncomplete;
}

std::function<int()> define_try(CLI::App& app) {
  auto arguments = std::make_shared<TryArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml")->required();
  app.add_option("EFFECT", arguments->effect,
                 "\"TARGET: expression\" or \"TARGET += expression\"; the program finds the amplitude of the "
                 "expression and what p and q are in it; targets and variables are those of effects of kind "
                 "custom (volcal diagnose --list)")
      ->required();
  app.add_option("-m,--model", arguments->model, "model.toml to add it to; default: all 21 errors");
  add_parameter_option(app, arguments->parameters);
  app.add_option("--threads", arguments->threads, "0 = all; results do not depend on it")
      ->check(not_negative());
  app.add_flag("--json", arguments->json, "print one JSON document on standard output and nothing else");
  return [arguments] { return run_try(*arguments); };
}

}  // namespace

const Command& try_command() {
  static const Command command = {
      "try", "try an effect of your own: its size, whether it predicts better, what remains",
      "  volcal try campaign.toml \"EZX: abs(x) / 400 * dir_x\"\n"
      "  volcal try campaign.toml \"EXX += dir_x * (T_air - 20)\" --model model.toml\n"
      "  volcal try campaign.toml \"EYZ: 1 - exp(-t / p)\" --parameter p=1800+-600\n"
      "  volcal extend model.toml --custom \"EZX: abs(x) / 400 * dir_x\" -o model-1.toml   keep it\n",
      define_try};
  return command;
}

}  // namespace volcal::cli
