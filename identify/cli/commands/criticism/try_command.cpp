#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/parameter_option.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/heldout_comparison.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/standards/comparison.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

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

/// An amplitude or a parameter of the effect, at the edge.
struct TriedValue {
  std::string name;
  std::string unit;
  double value = 0.0;
  double u = 0.0;  ///< NaN: held at its value
};

struct Tried {
  std::vector<TriedValue> values;
  std::string not_visible;  ///< why; empty = visible
  FitStatus status = FitStatus::Ok;
  bool judged = false;       ///< the setups have lines to hold out
  Comparison without, with;  ///< of the same lines, seen by neither fit
  Diagnosis remains;         ///< of the model with the effect
};

/// What stands before the parts of the work on the progress bar.
class ShareOfWork {
 public:
  ShareOfWork(ProgressBar& bar, std::string name, double from, double to)
      : bar_(bar), name_(std::move(name)), from_(from), to_(to) {}
  void operator()(const std::string& /*stage*/, double done) const {
    bar_.update(name_, from_ + (to_ - from_) * done);
  }

 private:
  ProgressBar& bar_;
  std::string name_;
  double from_, to_;
};

TriedValue tried_value(const FitResult& result, const std::string& label, const std::string& name) {
  const ParameterBlock* block = result.layout.find_block(label);
  if (block == nullptr) throw std::logic_error("the fit has lost the parameter " + label);
  const double per_edge = 1.0 / block->si_per_unit[0];
  return {.name = name,
          .unit = block->units[0],
          .value = result.parameters[block->offset] * per_edge,
          .u = std::sqrt(result.covariance(block->offset, block->offset)) * per_edge};
}

std::vector<TriedValue> tried_values(const FitResult& result, const WrittenEffect& effect) {
  std::vector<TriedValue> values;
  values.push_back(tried_value(result, effect.made->amplitudes().front().label, "amplitude"));
  for (const EffectShape& shape : effect.made->shapes()) {
    if (shape.sigma > 0.0) {
      values.push_back(tried_value(result, shape.label, shape.key));
    } else {
      values.push_back({shape.key, "", shape.value, std::nan("")});
    }
  }
  return values;
}

/// Why the readings say nothing of the effect; empty when they do.
std::string why_not_visible(const FitResult& result, const std::string& label) {
  for (const Observability& error : result.rank.errors) {
    if (error.symbol == label && !error.visible) return explanation(error.cause).reason;
  }
  for (const std::string& sentence : sentences(result.rank.invisible)) {
    if (sentence.find(label) != std::string::npos) return sentence;
  }
  return "";
}

Comparison judged_lines(const Campaign& campaign, const ModelSpec& model,
                        const std::vector<std::vector<bool>>& rows, int threads, const ShareOfWork& share) {
  return compare(campaign, heldout_residuals(campaign, model, rows, {threads, true, share}));
}

Diagnosis what_remains(const Campaign& campaign, const ModelSpec& model, int threads, ProgressBar& bar) {
  FitOptions options;
  options.threads = threads;
  options.outliers = OutlierPolicy::Remove;
  options.noise = NoisePolicy::White;  // the diagnosis estimates it, at every step anew
  options.progress = ShareOfWork(bar, "fit without suspect readings", 0.6, 0.7);
  const FitResult result = fit(campaign, model, options);
  DiagnoseOptions diagnosis;
  diagnosis.threads = threads;
  diagnosis.climb = true;
  diagnosis.figures = false;
  diagnosis.compare = false;
  diagnosis.progress = ShareOfWork(bar, "what remains", 0.7, 1.0);
  return diagnose(campaign, result, diagnosis);
}

Tried try_effect(const Campaign& campaign, const ModelSpec& without, const ModelSpec& with,
                 const WrittenEffect& effect, int threads) {
  ProgressBar bar("try");
  FitOptions options;
  options.threads = threads;
  options.progress = ShareOfWork(bar, "fit", 0.0, 0.2);
  const FitResult result = fit(campaign, with, options);
  Tried tried;
  tried.status = result.status;
  tried.values = tried_values(result, effect);
  tried.not_visible = why_not_visible(result, effect_label(*effect.made));
  const auto rows = judging_rows(campaign);
  tried.judged =
      std::ranges::any_of(rows, [](const auto& setup) { return std::ranges::count(setup, true) > 0; });
  if (tried.judged) {
    tried.without = judged_lines(campaign, without, rows, threads,
                                 ShareOfWork(bar, "held-out lines without it", 0.2, 0.4));
    tried.with =
        judged_lines(campaign, with, rows, threads, ShareOfWork(bar, "held-out lines with it", 0.4, 0.6));
  }
  tried.remains = what_remains(campaign, with, threads, bar);
  bar.finish();
  return tried;
}

std::string tried_value_text(const TriedValue& value) {
  const std::string unit = value.unit.empty() ? "" : " " + value.unit;
  if (std::isnan(value.u))
    return fmt::format("{} {}{} (held)", value.name, short_number(value.value, 4), unit);
  return fmt::format("{} {} +- {}{}", value.name, short_number(value.value, 4), short_number(value.u, 2),
                     unit);
}

std::string size_text(const Comparison& without, const Comparison& with) {
  std::string text;
  const auto add = [&](const ResidualSize& before, const ResidualSize& after, const char* unit) {
    if (before.count == 0) return;
    text +=
        fmt::format("{}RMS {} -> {} {}", text.empty() ? "" : ", ", short_number(before.rms * kPerMicro, 3),
                    short_number(after.rms * kPerMicro, 3), unit);
  };
  add(without.total.lengths, with.total.lengths, "um");
  add(without.total.angles, with.total.angles, "urad");
  return text;
}

std::string heldout_line(const Tried& tried) {
  if (!tried.judged) return "the setups have too few lines to hold some out";
  const double gain = tried.without.total.chi2 - tried.with.total.chi2;
  return fmt::format(
      "{} on {} readings that neither fit has seen, chi2 {} by {}: {}", size_text(tried.without, tried.with),
      count_number(static_cast<long long>(tried.with.total.observations)), gain >= 0.0 ? "less" : "more",
      short_number(std::abs(gain), 3), gain > 0.0 ? "it predicts better" : "it predicts no better");
}

/// What a scan or a test of the catalogue still sees, strongest first.
std::vector<std::string> above_the_noise(const Diagnosis& diagnosis) {
  std::vector<std::string> found;
  const auto add = [&](const std::string& what, double log10_p) {
    found.push_back(fmt::format("{} (log10 p {:.1f})", what, log10_p));
  };
  for (const EffectFinding& effect : diagnosis.effects) add(effect.label, effect.log10_p);
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    std::string names;
    for (const EffectFinding& effect : *set) names += (names.empty() ? "" : " or ") + effect.label;
    if (!set->empty()) add(names, set->front().log10_p);
  }
  for (const UnknownFinding& unknown : diagnosis.unknown)
    add("something in " + unknown.dependence() + " along " + unknown.action(), unknown.log10_p);
  return found;
}

std::string remains_line(const Diagnosis& diagnosis) {
  const auto found = above_the_noise(diagnosis);
  if (found.empty()) {
    return diagnosis.verdict == Verdict::NothingAbove
               ? "nothing above the noise"
               : (diagnosis.findings.empty() ? to_string(diagnosis.verdict)
                                             : sentence(diagnosis.findings.front()));
  }
  std::string text = "still above the noise: ";
  for (std::size_t i = 0; i < found.size() && i < 4; ++i) text += (i > 0 ? "; " : "") + found[i];
  return found.size() > 4 ? text + fmt::format("; and {} more", found.size() - 4) : text;
}

std::string tried_text(const TryArguments& arguments, const Tried& tried) {
  std::string values;
  for (const TriedValue& value : tried.values)
    values += (values.empty() ? "" : ", ") + tried_value_text(value);
  if (!tried.not_visible.empty()) values = "NOT VISIBLE: " + tried.not_visible;
  if (tried.status == FitStatus::NotConverged) values += " (the fit has not converged)";
  return fmt::format("{}: {}\nheld out: {}\nremains: {}\n{}", arguments.effect, values, heldout_line(tried),
                     remains_line(tried.remains), findings_text(tried.remains.notes));
}

nlohmann::ordered_json judged_json(const Comparison& comparison) {
  return {{"observations", comparison.total.observations},
          {"chi2", comparison.total.chi2},
          {"rms_um", comparison.total.lengths.rms * kPerMicro},
          {"rms_urad", comparison.total.angles.rms * kPerMicro}};
}

std::string tried_json(const TryArguments& arguments, const Tried& tried) {
  nlohmann::ordered_json values = nlohmann::ordered_json::array();
  for (const TriedValue& value : tried.values) {
    nlohmann::ordered_json u = nullptr;
    if (!std::isnan(value.u)) u = value.u;
    values.push_back({{"name", value.name}, {"value", value.value}, {"u", u}, {"unit", value.unit}});
  }
  nlohmann::ordered_json json = {{"effect", arguments.effect},
                                 {"status", std::string(to_string(tried.status))},
                                 {"visible", tried.not_visible.empty()},
                                 {"values", values}};
  json["held_out"] = nullptr;
  if (tried.judged)
    json["held_out"] = {{"without", judged_json(tried.without)}, {"with", judged_json(tried.with)}};
  json["verdict_of_what_remains"] = to_string(tried.remains.verdict);
  json["remains"] = above_the_noise(tried.remains);
  add_notes(tried.remains.notes, json);
  return json.dump(2) + "\n";
}

int run_try(const TryArguments& arguments) {
  const WrittenEffect effect = written_effect("EFFECT", arguments.effect, arguments.parameters);
  const Campaign campaign = read_campaign(arguments.campaign);
  const ModelSpec without =
      arguments.model.empty() ? ModelSpec{} : read_model(arguments.model, campaign.machine);
  ModelSpec with = without;
  extend_model({with, campaign.machine, &campaign}, effect.spec,
               {.label = "this effect",
                .remedy_if_known = "try another, or a model without it",
                .remedy_if_absent = "name an error motion of one of the machine's axes"});
  const Tried tried = try_effect(campaign, without, with, effect, arguments.threads);
  fmt::print("{}", arguments.json ? tried_json(arguments, tried) : tried_text(arguments, tried));
  const bool done = tried.not_visible.empty() && tried.status != FitStatus::NotConverged;
  return done ? kDone : kIncomplete;
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
