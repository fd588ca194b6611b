#include "volcal/identify/criticism/screening.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

/// The most improbable of all tests so far.
class Leading {
 public:
  void consider(double log10_p, const auto& describe) {
    if (!(log10_p < screening_.log10_p)) return;
    screening_.log10_p = log10_p;
    describe(screening_);
  }
  Screening take(std::size_t tests, double risk) {
    screening_.tests = tests;
    screening_.contradicts = screening_.log10_p <= risk;
    return std::move(screening_);
  }

 private:
  Screening screening_;
};

/// A few wild readings would speak for many tests.
std::vector<bool> flagged(const FitResult& result, const std::vector<std::size_t>& chosen) {
  std::vector<bool> flagged;
  for (const std::size_t i : chosen) flagged.push_back(result.residuals[i].flagged);
  return flagged;
}

std::vector<ObservationPlace> places(const FitResult& result) {
  std::vector<ObservationPlace> places;
  for (const ResidualRecord& record : result.residuals)
    places.push_back({record.setup, record.row, record.channel});
  return places;
}

double root_mean_square(const Eigen::VectorXd& moved) {
  return moved.norm() / std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, moved.size())));
}

std::string words_of(const GenericTest& test) {
  std::string text =
      fmt::format("something that depends on {}, along {}", fmt::join(names_of(test.variables), " and "),
                  name_of(test.direction.value()));
  if (test.rotation) text += ", as " + test.rotation->name();
  if (test.period > 0.0) text += fmt::format(", every {:.4g} mm", test.period * kPerMilli);
  return text;
}

void consider_families(const LinearModel& model, const std::vector<Family>& families,
                       const std::vector<FamilyTest>& tests, Leading& leading) {
  const double log10_count = std::log10(static_cast<double>(std::max<std::size_t>(1, tests.size())));
  for (const FamilyTest& test : tests) {
    if (test.score.dof == 0) continue;
    leading.consider(test.log10_p + log10_count, [&](Screening& found) {
      const Family& family = families[test.family];
      found.leading = family.label();
      found.rms = root_mean_square(displacement(model, family, test));
    });
  }
}

void consider_scans(const std::vector<GenericTest>& tests, Leading& leading) {
  const double log10_count = std::log10(static_cast<double>(std::max<std::size_t>(1, tests.size())));
  for (const GenericTest& test : tests) {
    leading.consider(test.log10_p + log10_count, [&](Screening& found) {
      found.leading = words_of(test);
      found.rms = test.rms;
    });
  }
}

}  // namespace

Screening screen(const Campaign& campaign, const FitResult& result, int threads,
                 std::size_t most_observations) {
  if (result.dof < kThresholds.screening_spare_observations) return {};
  threads = thread_count(threads);
  const std::vector<std::size_t> chosen = evenly_chosen(places(result), most_observations);
  const LinearModel model(campaign, result, chosen);
  const std::vector<NoiseParameters> noise = fitted_noise(result, model.noise_groups());
  const NoiseData data = without(model.problem().data, flagged(result, chosen));
  const Projector projector(model.problem(), data, noise, threads, model.parts());
  const std::vector<Family> families = volcal::families(model);
  Leading leading;
  consider_families(model, families, test_families(model, families, projector, threads), leading);
  std::vector<GenericTest> scans = generic_scan(model, scan_variables(model), projector, threads);
  std::ranges::move(wave_tests(model, projector, threads), std::back_inserter(scans));
  consider_scans(scans, leading);
  Screening screening = leading.take(families.size() + scans.size(),
                                     result.noise.more_than_white ? kThresholds.screening_log10_risk_of_drift
                                                                  : kThresholds.screening_log10_risk);
  screening.observations = model.size();
  screening.of_a_sample = model.size() < result.residuals.size();
  return screening;
}

void screen_fit(const Campaign& campaign, const FitOptions& options, FitResult& result) {
  if (options.loss != RobustLoss::None || result.status == FitStatus::NotConverged) return;
  constexpr double kShareBefore = 0.95;
  if (options.progress) options.progress("scans of the residuals", kShareBefore);
  const auto start = std::chrono::steady_clock::now();
  judge(screen(campaign, result, options.threads), result);
  result.timings.push_back({"scans of the residuals",
                            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
}

void judge(const Screening& screening, FitResult& result) {
  const std::optional<Finding> contradicted = finding_of(screening);
  if (!contradicted) return;
  if (result.status == FitStatus::Ok) result.status = FitStatus::LackOfFit;
  result.findings.push_back(*contradicted);
}

}  // namespace volcal
