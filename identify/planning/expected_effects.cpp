#include "volcal/identify/planning/expected_effects.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/criticism/catalogue/detectable.h"
#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

constexpr double kDetectionPower = 0.8;
constexpr double kLeastVisibleFraction = 0.02;  // as in a diagnosis

/// By the amplitude that is hardest to find.
DetectableEffect detectable_effect(const Family& family, const FamilyTest& test, double log10_level,
                                   const FunctionalPointLevers& levers) {
  const double found_from =
      std::sqrt(detectable_noncentrality(log10_level, std::max(1, test.score.dof), kDetectionPower));
  const auto& amplitudes = family.effect->amplitudes();
  std::size_t hardest = 0;
  const auto mdb = [&](std::size_t k) {
    const auto at = static_cast<Eigen::Index>(k);
    const double variance = test.score.covariance(at, at);
    return variance > 0.0 ? std::sqrt(variance) * found_from : std::nan("");
  };
  for (std::size_t k = 1; k < amplitudes.size(); ++k) {
    if (!(mdb(k) <= mdb(hardest))) hardest = k;
  }
  DetectableEffect out;
  out.name = family.name();
  out.label = family.label();
  out.unit = amplitudes[hardest].unit();
  out.si_per_unit = amplitudes[hardest].si_per_unit();
  out.visible_fraction = test.score.visible_fraction;
  out.visible = test.score.dof > 0 && test.score.visible_fraction >= kLeastVisibleFraction;
  out.mdb = mdb(hardest);
  out.volumetric = out.mdb * levers.rms(*family.effect, test.shape, hardest);
  return out;
}

}  // namespace

std::vector<DetectableEffect> expected_detectable(const Campaign& campaign, const FitResult& result,
                                                  int threads) {
  if (campaign.reading_count() == 0) return {};
  const LinearModel model(campaign, result);
  std::vector<Family> all = families(model);
  std::erase_if(all,
                [](const Family& family) { return family.resolution.has_value() || family.scan.empty(); });
  for (Family& family : all) family.scan = {family.scan[family.scan.size() / 2]};
  const std::vector<NoiseParameters> noise(model.noise_groups().size());
  const Projector projector(model.problem(), model.problem().data, noise, thread_count(threads),
                            model.parts());
  const std::vector<FamilyTest> tests = test_families(model, all, projector, thread_count(threads));
  const FunctionalPointLevers levers(model);
  const double log10_level =
      log10_family_risk() - std::log10(static_cast<double>(std::max<std::size_t>(1, all.size())));
  std::vector<DetectableEffect> out;
  out.reserve(tests.size());
  for (const FamilyTest& test : tests)
    out.push_back(detectable_effect(all[test.family], test, log10_level, levers));
  return out;
}

}  // namespace volcal
