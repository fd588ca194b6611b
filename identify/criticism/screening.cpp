#include "volcal/identify/criticism/screening.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/criticism/scans/reading_factors.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/statistics/even_sample.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr double kShareBeforeScans = 0.95;  // of the work of a fit

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

/// A few wild readings would speak for many tests. Where most of a setup are wild it is the setup.
std::vector<bool> flagged(const FitResult& result, const std::vector<std::size_t>& chosen,
                          std::size_t setups) {
  std::vector<double> excess(setups, 0.0);  // of flagged readings over others
  for (const std::size_t i : chosen)
    excess[result.residuals[i].setup] += result.residuals[i].flagged ? 1.0 : -1.0;
  std::vector<bool> flagged;
  flagged.reserve(chosen.size());
  for (const std::size_t i : chosen)
    flagged.push_back(result.residuals[i].flagged && excess[result.residuals[i].setup] <= 0.0);
  return flagged;
}

std::vector<ObservationPlace> places(const FitResult& result) {
  std::vector<ObservationPlace> places;
  for (const ResidualRecord& record : result.residuals)
    places.push_back({record.setup, record.row, record.channel});
  return places;
}

/// Of at most so many setups, and of these so many observations; ascending.
std::vector<std::size_t> chosen_of(const std::vector<ObservationPlace>& all, std::size_t setups,
                                   std::size_t most_observations, std::size_t most_setups) {
  std::vector<bool> is_chosen(setups, false);
  for (const std::size_t setup : even_sample(setups, most_setups)) is_chosen[setup] = true;
  std::vector<std::size_t> numbers;
  std::vector<ObservationPlace> places;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!is_chosen[all[i].setup]) continue;
    numbers.push_back(i);
    places.push_back(all[i]);
  }
  std::vector<std::size_t> chosen;
  for (const std::size_t i : evenly_chosen(places, most_observations)) chosen.push_back(numbers[i]);
  return chosen;
}

/// Without what only setups have that were not chosen.
NoiseProblem problem_of(const LinearModel& model, const Campaign& campaign, const FitResult& result) {
  if (model.size() == result.residuals.size()) return model.problem();
  const ParameterLayout& layout = model.model().layout();
  return without_unseen_nuisance(model.problem(), layout,
                                 DatumSpace(layout, campaign.machine, result.parameters));
}

std::string words_of(const GenericTest& test) {
  UnknownFinding finding;
  finding.variables = test.variables;
  finding.direction = test.direction.value();
  finding.rotation = test.rotation;
  finding.period = test.period;
  return finding.in_words() + ", along " + finding.action();
}

void consider_families(const LinearModel& model, const Projector& projector,
                       const std::vector<Family>& families, const std::vector<FamilyTest>& tests,
                       Leading& leading) {
  const double log10_count = std::log10(static_cast<double>(std::max<std::size_t>(1, tests.size())));
  for (const FamilyTest& test : tests) {
    if (test.score.dof == 0) continue;
    leading.consider(test.log10_p + log10_count, [&](Screening& found) {
      found.leading = families[test.family].label();
      found.rms = explained_rms(test.score.lm, model, projector);
    });
  }
}

Finding finding_of(const ReadingFactor& found, const Campaign& campaign) {
  std::vector<std::string> setups;
  for (const std::size_t setup : found.setups) setups.push_back(campaign.setups[setup].name);
  return {FindingCode::ReadingsMisread,
          {{"setups", setups}, {"columns", found.columns}, {"factor", FindingNumber{found.factor}}}};
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
                 std::size_t most_observations, std::size_t most_setups) {
  if (result.dof < kThresholds.screening_spare_observations) return {};
  threads = thread_count(threads);
  const std::vector<std::size_t> chosen =
      chosen_of(places(result), campaign.setups.size(), most_observations, most_setups);
  const LinearModel model(campaign, result, chosen);
  const std::vector<NoiseParameters> noise = fitted_noise(result, model.noise_groups());
  const NoiseData data = without(model.problem().data, flagged(result, chosen, campaign.setups.size()));
  const Projector projector(problem_of(model, campaign, result), data, noise, threads, model.parts());
  const std::vector<Family> families = volcal::families(model);
  Leading leading;
  consider_families(model, projector, families, test_families(model, families, projector, threads), leading);
  std::vector<GenericTest> scans = generic_scan(model, scan_variables(model), projector, threads);
  std::ranges::move(wave_tests(model, projector, threads), std::back_inserter(scans));
  consider_scans(scans, leading);
  Screening screening = leading.take(families.size() + scans.size(),
                                     result.noise.more_than_white ? kThresholds.screening_log10_risk_of_drift
                                                                  : kThresholds.screening_log10_risk);
  screening.observations = model.size();
  screening.of_a_sample = model.size() < result.residuals.size();
  if (const auto found = misread_setup(model, projector)) screening.misread = finding_of(*found, campaign);
  return screening;
}

namespace {

/// As the fit's finding has it.
std::optional<Screening> found_by(const FitResult& fitted) {
  const auto found = std::ranges::find(fitted.findings, FindingCode::ModelContradicted, &Finding::code);
  if (found == fitted.findings.end()) return std::nullopt;
  Screening screening;
  screening.tests = static_cast<std::size_t>(found->count("tests"));
  screening.of_a_sample = found->has("sampled");
  screening.observations =
      screening.of_a_sample ? static_cast<std::size_t>(found->count("sampled")) : fitted.residuals.size();
  screening.contradicts = true;
  screening.leading = found->text("leading");
  screening.log10_p = found->number("log10_p").si;
  screening.rms = found->number("rms").si;
  return screening;
}

}  // namespace

Screening screen_evaluated(const Campaign& campaign, const FitResult& evaluated, const FitResult& fitted,
                           int threads) {
  Screening screening = screen(campaign, evaluated, threads);
  const std::optional<Screening> own = found_by(fitted);
  const bool is_worse = own && own->log10_p < screening.log10_p;
  return is_worse && fitted_readings(campaign, fitted).are_all() ? *own : screening;
}

namespace {

/// Beside errors that are not visible the search for noise may not end, and correlated readings look like a
/// contradiction.
bool is_without_noise(const FitOptions& options, const FitResult& result) {
  return options.noise == NoisePolicy::Automatic && options.variance_components &&
         !result.rank.invisible.empty() && !result.noise.estimated;
}

}  // namespace

void screen_fit(const Campaign& campaign, const FitOptions& options, FitResult& result) {
  if (options.loss != RobustLoss::None || result.status == FitStatus::NotConverged) return;
  if (is_without_noise(options, result)) return;
  if (options.progress) options.progress("scans of the residuals", kShareBeforeScans);
  const auto start = std::chrono::steady_clock::now();
  judge(screen(campaign, result, options.threads), result);
  result.timings.push_back({"scans of the residuals",
                            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
}

FitResult screened_fit(const Campaign& campaign, const ModelSpec& model, const FitOptions& options) {
  FitOptions before_scans = options;
  before_scans.progress = [&](const std::string& stage, double done) {
    if (options.progress && done < 1.0) options.progress(stage, std::min(done, kShareBeforeScans));
  };
  FitResult result = fit(campaign, model, before_scans);
  screen_fit(campaign, options, result);
  if (options.progress) options.progress("done", 1.0);
  return result;
}

void judge(const Screening& screening, FitResult& result) {
  if (screening.misread) result.findings.insert(result.findings.begin(), *screening.misread);
  const std::optional<Finding> contradicted = finding_of(screening);
  if (!contradicted) return;
  if (result.status == FitStatus::Ok) result.status = FitStatus::LackOfFit;
  result.findings.push_back(*contradicted);
}

}  // namespace volcal
