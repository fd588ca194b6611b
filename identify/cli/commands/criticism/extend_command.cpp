#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/output_file.h"
#include "volcal/identify/cli/options/parameter_option.h"
#include "volcal/identify/criticism/asked_laws.h"
#include "volcal/identify/criticism/catalogue/named_effect.h"
#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/finding_json.h"

namespace volcal::cli {
namespace {

const std::string kOtherMotion = "name an error motion of one of the machine's axes";

struct ExtendArguments {
  std::string model;
  std::vector<std::string> effects;
  std::string custom;
  std::vector<std::string> parameters;
  std::string diagnosis;
  int rank = 0;
  bool accepted = false;
  std::string campaign;
  std::string output;
  bool force = false;
  bool json = false;
};

/// What the new model has that the old one had not, in the user's words.
struct Changes {
  std::vector<std::string> taken_out, given_back, added;
};

std::vector<EffectFinding> chosen(const ExtendArguments& arguments, const Diagnosis& diagnosis) {
  const std::string again = "volcal diagnose --show " + arguments.diagnosis + " prints the ranking";
  if (arguments.accepted) {
    std::vector<EffectFinding> accepted = accepted_effects(diagnosis);
    if (!accepted.empty()) return accepted;
    throw InputError({arguments.diagnosis, 0},
                     "the diagnosis added no effect, its verdict is " + to_string(diagnosis.verdict),
                     "choose one by --rank; " + again);
  }
  const std::vector<EffectFinding> all = ranked_effects(diagnosis);
  if (all.empty()) {
    throw InputError({arguments.diagnosis, 0}, "the diagnosis ranks no effect",
                     "name one by --effect; volcal diagnose --list prints all kinds");
  }
  if (arguments.rank > static_cast<int>(all.size())) {
    throw InputError({arguments.diagnosis, 0},
                     fmt::format("--rank {}: the diagnosis ranks {} effects", arguments.rank, all.size()),
                     again);
  }
  return {all[static_cast<std::size_t>(arguments.rank) - 1]};
}

/// `candidates_of`: the campaign, or the machine alone.
void add_named(const std::string& text, const ModelToExtend& extended, const Campaign& candidates_of,
               Changes& changes) {
  const EffectSpec spec = named_effect("--effect", text, candidates_of);
  const auto effect = extend_model(
      extended, spec,
      {.label = text, .remedy_if_known = "leave out --effect " + text, .remedy_if_absent = kOtherMotion});
  changes.added.push_back(full_name(effect->name()));
}

void add_custom(const ExtendArguments& arguments, const ModelToExtend& extended, Changes& changes) {
  const EffectSpec spec = written_effect("--custom", arguments.custom, arguments.parameters).spec;
  const auto effect = at_its_column("--custom", arguments.custom, [&] {
    return extend_model(extended, spec,
                        {.label = arguments.custom,
                         .remedy_if_known = "leave out --custom",
                         .remedy_if_absent = kOtherMotion});
  });
  changes.added.push_back(effect_label(*effect));
}

void add_found(const EffectFinding& found, const ExtendArguments& arguments, const ModelToExtend& extended,
               Changes& changes) {
  const bool added =
      extend_model(extended, found.spec,
                   {.label = found.label,
                    .place = {arguments.diagnosis, 0},
                    .remedy_if_known = "diagnose this model (volcal diagnose CAMPAIGN --model " +
                                       arguments.model + " -o DIR), or choose another --rank",
                    .remedy_if_absent = "give the model that was diagnosed, or one of the same machine"}) !=
      nullptr;
  if (added) {
    changes.added.push_back(found.label + (found.shape_text.empty() ? "" : ", " + found.shape_text));
  } else {
    changes.given_back.push_back(found.label);
  }
}

void require_one_source(const ExtendArguments& arguments) {
  if (arguments.custom.empty() && !arguments.parameters.empty())
    throw InputError({}, "--parameter needs an expression", "give --custom \"TARGET: expression\"");
  const std::string usage = "volcal extend MODEL --diagnosis DIR --rank 1 (or --accepted) -o NEW.toml";
  const bool chooses = arguments.rank > 0 || arguments.accepted;
  if (arguments.diagnosis.empty()) {
    if (chooses) throw InputError({}, "--rank and --accepted need a diagnosis to choose from", usage);
    if (!arguments.effects.empty() || !arguments.custom.empty()) return;
    throw InputError({}, "nothing to add is given",
                     "give --effect KIND:TARGET, --custom \"TARGET: expression\", or " + usage);
  }
  if (arguments.rank > 0 && arguments.accepted)
    throw InputError({}, "--rank and --accepted are both given", "leave one of the two out");
  if (!chooses) throw InputError({}, "no effect of the diagnosis is chosen", usage);
}

/// model.toml, model-1.toml, model-2.toml ...: the next of them that does not exist.
std::string next_name(const std::string& model) {
  const std::filesystem::path path(model);
  std::string stem = path.stem().string();
  const std::size_t dash = stem.rfind('-');
  const bool numbered = dash != std::string::npos && dash + 1 < stem.size() &&
                        stem.find_first_not_of("0123456789", dash + 1) == std::string::npos &&
                        stem.size() - dash < 6;
  int number = numbered ? std::stoi(stem.substr(dash + 1)) : 0;
  if (numbered) stem.resize(dash);
  std::filesystem::path next;
  do {
    next = path.parent_path() / fmt::format("{}-{}{}", stem, ++number, path.extension().string());
  } while (std::filesystem::exists(next));
  return next.string();
}

/// Path of a file as a file elsewhere names it.
std::string path_from(const std::string& from, const std::string& file) {
  const auto folder = std::filesystem::absolute(from).parent_path();
  return std::filesystem::proximate(std::filesystem::absolute(file), folder).generic_string();
}

void report(const Changes& changes, const std::string& output, std::size_t effects,
            const std::vector<Finding>& notes, bool as_json) {
  if (as_json) {
    nlohmann::ordered_json json = {{"file", output},
                                   {"effects", effects},
                                   {"added", changes.added},
                                   {"given_back", changes.given_back},
                                   {"taken_out", changes.taken_out}};
    add_notes(notes, json);
    fmt::print("{}\n", json_text(json, 2));
    return;
  }
  for (const std::string& label : changes.taken_out) fmt::print("taken out: {}\n", label);
  for (const std::string& label : changes.given_back) fmt::print("given back: {}\n", label);
  for (const std::string& label : changes.added) fmt::print("added: {}\n", label);
  fmt::print("written: {} ({} effect{})\n", output, effects, effects == 1 ? "" : "s");
  fmt::print("{}", findings_text(notes));
}

int run_extend(const ExtendArguments& arguments) {
  require_one_source(arguments);
  auto [machine, model] = read_model_with_machine(arguments.model);
  Campaign campaign;
  if (arguments.campaign.empty()) {
    campaign.machine = machine;
  } else {
    campaign = read_campaign(arguments.campaign);
  }
  const ModelToExtend extended{model, machine, arguments.campaign.empty() ? nullptr : &campaign};
  Changes changes;
  for (const std::string& effect : arguments.effects) add_named(effect, extended, campaign, changes);
  if (!arguments.custom.empty()) add_custom(arguments, extended, changes);
  std::optional<Diagnosis> diagnosis;
  if (!arguments.diagnosis.empty()) {
    diagnosis = read_diagnosis(arguments.diagnosis);
    changes.taken_out = take_out_surfaces(*diagnosis, model);
    for (const EffectFinding& effect : chosen(arguments, *diagnosis))
      add_found(effect, arguments, extended, changes);
  }
  const std::string output = arguments.output.empty() ? next_name(arguments.model) : arguments.output;
  if (!arguments.force)
    require_no_input(output, {arguments.model, machine.file, arguments.campaign},
                     "name another file with -o, or overwrite it with --force");
  write_text_file(output, model_toml(model, path_from(output, machine.file)));
  report(changes, output, model.effects.size(), campaign.notes, arguments.json);
  if (diagnosis && !arguments.json) {
    fmt::print("{}", removed_in_fit_text(
                         *diagnosis, arguments.campaign.empty() ? "CAMPAIGN" : arguments.campaign, output));
  }
  return kDone;
}

std::function<int()> define_extend(CLI::App& app) {
  auto arguments = std::make_shared<ExtendArguments>();
  app.add_option("MODEL", arguments->model, "model.toml to extend")->required();
  app.add_option("-e,--effect", arguments->effects,
                 "KIND:TARGET[:DRIVER[:SHAPE]]; may be given several times");
  app.add_option("--custom", arguments->custom,
                 "an effect of your own, \"TARGET: expression\" or \"TARGET += expression\"");
  add_parameter_option(app, arguments->parameters);
  app.add_option("--diagnosis", arguments->diagnosis,
                 "folder that volcal diagnose wrote, to choose effects from");
  app.add_option("--rank", arguments->rank,
                 "place in the diagnosis: what it added or could not separate first, then its ranking")
      ->check(positive());
  app.add_flag("--accepted", arguments->accepted, "all effects that the diagnosis added");
  app.add_option("--campaign", arguments->campaign,
                 "campaign.toml, for effects of temperatures, stations, setups and tools");
  app.add_option("-o,--output", arguments->output,
                 "model file to write; default: the model's name with the next free number, model-1.toml");
  app.add_flag("--force", arguments->force, "overwrite the model that is extended");
  app.add_flag("--json", arguments->json, "print one JSON document on standard output and nothing else");
  return [arguments] { return run_extend(*arguments); };
}

}  // namespace

const Command& extend_command() {
  static const Command command = {
      "extend", "add effects to a model file",
      "  volcal extend model.toml --effect reversal:EXX -o model-1.toml\n"
      "  volcal extend model.toml --diagnosis diagnosis --rank 1\n"
      "  volcal extend model.toml --diagnosis diagnosis --accepted -o model-1.toml\n"
      "  volcal extend model.toml --custom \"EZX: abs(x) / 400 * dir_x\" -o model-1.toml\n"
      "  volcal extend model.toml --effect axis-coupling:EAY:z:linear -o model-1.toml\n"
      "  volcal extend model.toml --effect thermal-drift:EAZ:T_air --campaign campaign.toml -o "
      "model-1.toml\n",
      define_extend};
  return command;
}

}  // namespace volcal::cli
