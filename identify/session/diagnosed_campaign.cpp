#include "volcal/identify/session/diagnosed_campaign.h"

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/session/session.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

void require_new(const std::vector<EffectSpec>& own, const ModelSpec& model) {
  for (const EffectSpec& spec : own) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) continue;
    const auto effect = kind->make(spec, {});
    require_not_known(model, *effect,
                      {.label = effect_label(*effect),
                       .remedy_if_known = "try another, or diagnose a model without it",
                       .remedy_if_absent = {}});
  }
}

}  // namespace

DiagnosedModel diagnosed_campaign(const Campaign& campaign, const ModelSpec& model,
                                  const DiagnoseOptions& options) {
  constexpr double kShareOfGivenModel = 0.3;
  require_new(options.own, model);
  const auto part = [&options](const std::string& before, double from, double share) -> SessionProgress {
    if (!options.progress) return {};
    return [&options, before, from, share](const std::string& stage, double done) {
      options.progress(before + stage, from + share * done);
      return true;
    };
  };
  const Session session(campaign, model,
                        {options.threads, options.heldout_share, part("fit: ", 0.0, kShareOfGivenModel)});
  return session.diagnosis(options)(part("", kShareOfGivenModel, 1.0 - kShareOfGivenModel));
}

}  // namespace volcal
