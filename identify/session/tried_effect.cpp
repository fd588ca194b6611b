#include "volcal/identify/session/tried_effect.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

using TryProgress = std::function<void(const std::string& stage, double done)>;

/// Progress of a part of the work, under a name of its own.
TryProgress part_of(const TryProgress& whole, const std::string& name, double from, double to) {
  if (!whole) return {};
  return [=](const std::string& /*stage*/, double done) { whole(name, from + (to - from) * done); };
}

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
std::string why_not_visible(const FitResult& result, const Effect& effect) {
  for (const EffectAmplitude& amplitude : effect.amplitudes()) {
    const auto found =
        std::ranges::find(result.rank.errors, MachineError(amplitude.label), &Observability::symbol);
    if (found != result.rank.errors.end() && !found->visible) return explanation(found->cause).reason;
  }
  return "";
}

void judge_by_held_out_lines(const Campaign& campaign, const ModelSpec& without, const ModelSpec& with,
                             const TryOptions& options, TriedEffect& tried) {
  const auto rows = judging_rows(campaign);
  tried.judged =
      std::ranges::any_of(rows, [](const auto& setup) { return std::ranges::count(setup, true) > 0; });
  if (!tried.judged) return;
  const auto left_by = [&](const ModelSpec& model, const TryProgress& progress) {
    return heldout_residuals(campaign, model, rows, {options.threads, true, progress});
  };
  const auto before = left_by(without, part_of(options.progress, "held-out lines without it", 0.2, 0.4));
  const auto after = left_by(with, part_of(options.progress, "held-out lines with it", 0.4, 0.6));
  tried.without = compare(campaign, before);
  tried.with = compare(campaign, after);
  tried.gain = heldout_gain(campaign, before, after);
}

/// A pointer to the next step: nothing is drawn, and what no single name explains is reported as the scans
/// find it.
SearchRules rules_of_a_pointer() {
  using enum SearchRule;
  return {.off = {Surfaces, OneCause, WiderSurface, ReplacedSurfaces, NamesTogether}, .decided = {}};
}

Diagnosis what_remains(const Campaign& campaign, const ModelSpec& model, const TryOptions& tried) {
  FitOptions options;
  options.threads = tried.threads;
  options.outliers = OutlierPolicy::Remove;
  options.noise = NoisePolicy::White;  // the diagnosis estimates it, at every step anew
  options.progress = part_of(tried.progress, "fit without suspect readings", 0.6, 0.7);
  const FitResult result = fit(campaign, model, options);
  DiagnoseOptions diagnosis;
  diagnosis.threads = tried.threads;
  diagnosis.climb = true;
  diagnosis.figures = false;
  diagnosis.compare = false;
  diagnosis.rules = rules_of_a_pointer();
  diagnosis.progress = part_of(tried.progress, "what remains", 0.7, 1.0);
  return diagnose(campaign, result, diagnosis);
}

ModelSpec model_with(const ModelSpec& model, const WrittenEffect& effect, const Campaign& campaign) {
  ModelSpec with = model;
  extend_model({with, campaign.machine, &campaign}, effect.spec,
               {.label = "this effect",
                .remedy_if_known = "try another, or a model without it",
                .remedy_if_absent = "name an error motion of one of the machine's axes"});
  return with;
}

}  // namespace

TriedEffect try_effect(const Campaign& campaign, const ModelSpec& model, const WrittenEffect& effect,
                       const TryOptions& options) {
  const ModelSpec with = model_with(model, effect, campaign);
  FitOptions of_fit;
  of_fit.threads = options.threads;
  of_fit.progress = part_of(options.progress, "fit", 0.0, 0.2);
  const FitResult result = fit(campaign, with, of_fit);
  TriedEffect tried;
  tried.status = result.status;
  tried.values = tried_values(result, effect);
  tried.not_visible = why_not_visible(result, *effect.made);
  judge_by_held_out_lines(campaign, model, with, options, tried);
  tried.remains = what_remains(campaign, with, options);
  return tried;
}

}  // namespace volcal
