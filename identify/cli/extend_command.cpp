#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/io/campaign_reader.h"
#include "volcal/identify/io/model_reader.h"
#include "volcal/identify/io/text_file.h"
#include "volcal/identify/io/toml_writer.h"
#include "volcal/model/effects/registry.h"

namespace volcal::cli {
namespace {

struct Arguments {
  std::string model;
  std::vector<std::string> effects;
  std::string campaign;
  std::string output;
};

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::string full_name(const EffectName& name) {
  return fmt::format("{}:{}:{}:{}", name.kind, name.target, name.driver, name.shape);
}

/// KIND:TARGET, or more of KIND:TARGET:DRIVER:SHAPE where that is not one effect.
EffectSpec named_effect(const std::string& text, const Campaign& campaign) {
  const std::vector<std::string> wanted = parts_of(text);
  const EffectKind* kind = find_effect(wanted[0]);
  const std::string usage =
      "write KIND:TARGET, KIND:TARGET:DRIVER or KIND:TARGET:DRIVER:SHAPE; volcal diagnose --list "
      "prints all kinds";
  if (kind == nullptr)
    throw InputError({}, "--effect " + text + ": \"" + wanted[0] + "\" is no kind of effect", usage);
  std::vector<EffectSpec> matching;
  std::string names, all;
  for (const EffectSpec& spec : kind->candidates(campaign)) {
    const EffectName name = kind->make(spec, {})->name();
    const std::string fields[] = {name.kind, name.target, name.driver, name.shape};
    all += (all.empty() ? "" : ", ") + full_name(name);
    bool fits = wanted.size() <= 4;
    for (std::size_t k = 1; fits && k < wanted.size(); ++k)
      fits = wanted[k].empty() || wanted[k] == fields[k];
    if (!fits) continue;
    matching.push_back(spec);
    names += (names.empty() ? "" : ", ") + full_name(name);
  }
  if (matching.size() == 1) return matching.front();
  if (matching.empty()) {
    const bool by_hand = all.empty() && !kind->examples(campaign).empty();
    const std::string remedy = by_hand ? "this kind is written into the model file, as an [[effects]] table"
                               : all.empty() ? "give --campaign: this kind depends on what was recorded"
                                             : "choose one of " + all;
    throw InputError({}, "--effect " + text + " names nothing that could act here", remedy);
  }
  throw InputError({}, "--effect " + text + " fits " + std::to_string(matching.size()) + " effects",
                   "choose one of " + names);
}

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
  for (const std::string& effect : arguments.effects) model.effects.push_back(named_effect(effect, campaign));
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
