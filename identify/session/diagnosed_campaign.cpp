#include "volcal/identify/session/diagnosed_campaign.h"

#include "volcal/identify/session/session.h"

namespace volcal {

DiagnosedModel diagnosed_campaign(const Campaign& campaign, const ModelSpec& model,
                                  const DiagnoseOptions& options) {
  constexpr double kShareOfGivenModel = 0.3;
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
