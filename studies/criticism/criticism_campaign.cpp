#include "volcal/studies/criticism/criticism_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <set>

#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/channels.h"
#include "volcal/studies/criticism/criticism_names.h"
#include "volcal/studies/criticism/criticism_plan.h"
#include "volcal/studies/criticism/yardstick.h"

namespace volcal::studies {
namespace {

constexpr double kTrialRms = 1e-6;        // m
constexpr double kLargestRms = 40e-6;     // m: a larger effect is another kind of trouble
constexpr double kLargestAngle = 300e-6;  // rad, and per whatever the amplitude is taken for
constexpr double kLargestLength = 200e-6;
constexpr int kMostAttempts = 60;
constexpr double kLargestShared = 0.75;  // of a squared signal, by the columns of what is hidden beside it
constexpr double kRemainderOfTheSame = 0.02;  // share of a signal; below, no reading tells two effects apart
constexpr std::size_t kKeptOfRanking = 5;

/// Of this thread, which does all the work of its campaign.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// An effect that shows at second order alone needs an amplitude that no machine has.
bool plausible(const sim::HiddenEffect& effect, double amplitude, double rms) {
  const std::string unit = sim::amplitude_unit(effect);
  if (unit.starts_with("urad") && std::abs(amplitude) > kLargestAngle) return false;
  if (unit == "um" && std::abs(amplitude) > kLargestLength) return false;
  return rms <= kLargestRms;
}

/// Hidden effects with the amplitudes that give the wanted signals, and what they do to the readings.
struct Hidden {
  std::vector<sim::HiddenEffect> effects;
  std::vector<Eigen::VectorXd> changes;
};

class CampaignRun {
 public:
  CampaignRun(const std::string& row, int index, std::uint64_t seed, int readings, SearchRules rules = {})
      : row_(row), index_(index), seed_(seed), readings_(readings), rules_(std::move(rules)) {
    for (const SearchRule rule : rules_.off) record_.without.emplace_back(name_of(rule));
    record_.row = row;
    record_.index = index;
    record_.seed = seed;
    record_.wanted_readings = readings;
  }

  std::optional<sim::Study> study() {
    if (!find_visible()) return std::nullopt;
    return hiding(plan_.study, hidden_.effects);
  }

  CampaignRecord run() {
    const std::optional<sim::Study> drawn = study();
    if (!drawn) {
      record_.failure = "no effect drawn is visible in this layout";
      return std::move(record_);
    }
    const sim::SimulatedCampaign simulated = sim::simulate(*drawn);
    describe(simulated.campaign);
    const FitResult given = fitted(simulated.campaign, plan_.given);
    DiagnoseOptions options;
    options.compare = false;
    options.figures = false;
    options.threads = 1;
    options.climb = true;
    options.leave_out = plan_.leave_out;
    options.rules = rules_;
    const double start = processor_seconds();
    const Diagnosis diagnosis = diagnose(simulated.campaign, given, options);
    record_.seconds = processor_seconds() - start;
    judge(diagnosis);
    if (!record_.hidden.empty() && row_ != "partial") recover(simulated, given, diagnosis);
    return std::move(record_);
  }

 private:
  /// Draws until every hidden effect shows in the readings. A partial campaign takes what comes.
  bool find_visible() {
    for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
      plan_ = plan_campaign(row_, index_, seed_, readings_, attempt);
      if (plan_.hidden.empty()) return true;
      if (attempt % kAttemptsPerKind == 0) yardstick_ = std::make_unique<Yardstick>(plan_.study);
      hidden_ = {};
      record_.hidden.clear();
      const auto added = [this](const PlannedEffect& effect) { return add(effect); };
      if (std::ranges::all_of(plan_.hidden, added) && stand_apart()) return true;
    }
    return false;
  }

  bool add(const PlannedEffect& planned) {
    sim::HiddenEffect effect = planned.effect;
    const bool scaled = planned.signal > 0.0;
    effect.rms = scaled ? kTrialRms : planned.rms;
    double amplitude = 0.0;
    Eigen::VectorXd change;
    try {
      change = yardstick_->change(plan_.study, effect, &amplitude);
    } catch (const InputError&) {
      return false;  // it has no effect on these readings
    }
    const Yardstick::Visible visible = yardstick_->visible(change);
    if (scaled && visible.fraction < kThresholds.visible_fraction) return false;
    const double factor = scaled ? planned.signal / visible.signal : 1.0;
    if (!plausible(effect, amplitude * factor, *effect.rms * factor)) return false;
    HiddenRecord record;
    record.signal = visible.signal * factor;
    record.visible_fraction = visible.fraction;
    record.rms_um = *effect.rms * factor * kPerMicro;
    effect.rms.reset();
    effect.amplitude = amplitude * factor;
    record.text = text_of(effect);
    hidden_.changes.emplace_back(change * factor);
    hidden_.effects.push_back(std::move(effect));
    record_.hidden.push_back(std::move(record));
    return true;
  }

  /// Effects hidden together are raised until each has its signal beside the columns of the others; false
  /// where these take nearly all of it.
  bool stand_apart() {
    std::vector<double> factors(hidden_.effects.size(), 1.0);
    for (std::size_t i = 0; i < factors.size(); ++i) {
      for (std::size_t k = 0; k < factors.size(); ++k) {
        const auto other = right_answer(hidden_.effects[k], yardstick_->campaign()).spec;
        if (k == i || !other) continue;
        const double share = yardstick_->share_taken(hidden_.changes[i], yardstick_->columns(*other));
        if (share > kLargestShared) return false;
        factors[i] = std::max(factors[i], 1.0 / std::sqrt(1.0 - share));
      }
    }
    for (std::size_t i = 0; i < factors.size(); ++i) {
      *hidden_.effects[i].amplitude *= factors[i];
      hidden_.changes[i] *= factors[i];
      record_.hidden[i].rms_um *= factors[i];
    }
    return true;
  }

  void describe(const Campaign& campaign) {
    record_.readings = static_cast<int>(campaign.reading_count());
    record_.structure = plan_.study.machine.structure.code;
    record_.layout = plan_.layout;
    record_.noise = plan_.noise;
    if (lacks_errors()) {
      HiddenRecord& lacking = record_.hidden.emplace_back();
      lacking.text = "errors of rotary axes";
      lacking.right = kLeftOut;
    }
    for (std::size_t i = 0; i < hidden_.effects.size(); ++i) {
      RightAnswer right = right_answer(hidden_.effects[i], campaign);
      HiddenRecord& hidden = record_.hidden[i];
      if (right.name && !left_out(*right.name)) hidden.right = full_name(*right.name);
      hidden.drivers.assign(right.drivers.begin(), right.drivers.end());
      hidden.companions.assign(right.companions.begin(), right.companions.end());
      hidden.directions.assign(right.directions.begin(), right.directions.end());
      right_.push_back(std::move(right));
    }
  }

  /// What is hidden is what the model lacks, and no effect.
  bool lacks_errors() const { return !plan_.given.functions.empty(); }

  bool left_out(const EffectName& name) const {
    return std::ranges::find(plan_.leave_out, name.kind) != plan_.leave_out.end();
  }

  void judge(const Diagnosis& diagnosis) {
    record_.verdict = to_string(diagnosis.verdict);
    record_.families = static_cast<int>(diagnosis.families);
    record_.removed_readings = static_cast<int>(diagnosis.removed_readings.size());
    for (const EffectFinding& finding : diagnosis.effects) record_.named.push_back(answer(finding));
    for (const auto* set : sets_of_alternatives(diagnosis)) {
      auto& answers = record_.sets.emplace_back();
      for (const EffectFinding& finding : *set) answers.push_back(answer(finding));
    }
    for (const EffectFinding& finding : diagnosis.ranking) {
      if (record_.ranking.size() < kKeptOfRanking) record_.ranking.push_back(answer(finding));
    }
    for (const UnknownFinding& unknown : diagnosis.unknown) {
      record_.unknown.push_back(
          {names_of(unknown.variables), std::string(name_of(unknown.direction)), unknown.log10_p});
    }
    for (const EffectFinding& change : diagnosis.model_changes) record_.model_changes.push_back(change.label);
    for (const NoiseRow& row : diagnosis.noise) {
      if (row.value != 0.0) {
        record_.noise_terms.push_back(fmt::format(
            "{} {} {:.3g} {}", diagnosis.noise_instruments[row.instrument], row.term, row.value, row.unit));
      }
    }
    judge_drawn(diagnosis);
    record_.named_explain = explained_by_all(diagnosis.effects);
    record_.told_explain = explained_by_all(with_first_of_sets(diagnosis));
  }

  /// What is hidden and neither named nor in a set.
  Eigen::VectorXd without_name() const {
    std::set<int> told;
    for (const AnswerRecord& answer : record_.named) told.insert(answer.hidden);
    for (const auto& set : record_.sets) {
      for (const AnswerRecord& answer : set) told.insert(answer.hidden);
    }
    Eigen::VectorXd change;
    for (std::size_t i = 0; i < hidden_.changes.size(); ++i) {
      if (told.contains(static_cast<int>(i))) continue;
      change = change.size() == 0 ? hidden_.changes[i] : Eigen::VectorXd(change + hidden_.changes[i]);
    }
    return change;
  }

  void judge_drawn(const Diagnosis& diagnosis) {
    const Eigen::VectorXd change = without_name();
    if (change.size() == 0 || diagnosis.surfaces.empty()) return;
    const double signal = yardstick_->signal(change);
    for (const SurfaceFinding& surface : diagnosis.surfaces) {
      for (const FormulaFinding& law : surface.formulas) {
        const double share = yardstick_->explained(change, yardstick_->columns(law.spec)).share;
        record_.laws.push_back({law.label, share, signal * std::sqrt(std::max(0.0, 1.0 - share))});
      }
    }
    if (!record_.named.empty() || !record_.sets.empty() || diagnosis.surfaces.size() > 1) return;
    const Yardstick::Covered covered = yardstick_->covered(change, diagnosis.surfaces.front());
    record_.band_inside = covered.count;
    record_.band_of = covered.of;
  }

  static std::vector<EffectFinding> with_first_of_sets(const Diagnosis& diagnosis) {
    std::vector<EffectFinding> reported = diagnosis.effects;
    for (const auto* set : sets_of_alternatives(diagnosis)) reported.push_back(set->front());
    return reported;
  }

  double explained_by_all(const std::vector<EffectFinding>& findings) const {
    if (findings.empty() || hidden_.changes.empty()) return 0.0;
    Eigen::VectorXd change = hidden_.changes.front();
    for (std::size_t i = 1; i < hidden_.changes.size(); ++i) change += hidden_.changes[i];
    Eigen::MatrixXd all(change.size(), 0);
    for (const EffectFinding& finding : findings) {
      const Eigen::MatrixXd columns = yardstick_->columns(finding);
      const Eigen::Index before = all.cols();
      all.conservativeResize(Eigen::NoChange, before + columns.cols());
      all.rightCols(columns.cols()) = columns;
    }
    return yardstick_->explained(change, all).share;
  }

  AnswerRecord answer(const EffectFinding& finding) const {
    AnswerRecord answer;
    answer.name = full_name(finding.name);
    answer.resolution = finding.resolution;
    answer.log10_p = finding.log10_p;
    answer.gain = finding.gain;
    answer.scanned = !finding.shape_text.empty();
    Yardstick::Explained nearest;
    int nearest_hidden = -1;
    for (std::size_t i = 0; i < hidden_.changes.size(); ++i) {
      const Yardstick::Explained explained =
          yardstick_->explained(hidden_.changes[i], yardstick_->columns(finding));
      if (nearest_hidden >= 0 && explained.share <= nearest.share) continue;
      nearest = explained;
      nearest_hidden = static_cast<int>(i);
    }
    answer.explains = nearest.share;
    for (std::size_t i = 0; i < right_.size(); ++i) {
      if (record_.hidden[i].right == answer.name) {
        answer.by_name = true;
        answer.hidden = static_cast<int>(i);
      }
    }
    if (lacks_errors() && finding.name.kind == kLeftOut) {
      answer.by_name = true;
      answer.hidden = 0;
    }
    const bool same = !finding.resolution && 1.0 - nearest.share < kRemainderOfTheSame * kRemainderOfTheSame;
    if (answer.hidden < 0 && same) answer.hidden = nearest_hidden;
    for (std::size_t k = 0; k < finding.amplitudes.size(); ++k) {
      const AmplitudeFigure& figure = finding.amplitudes[k];
      const double truth =
          nearest.amplitude.size() > 0 ? nearest.amplitude[static_cast<Eigen::Index>(k)] : 0.0;
      const double mdb = std::isfinite(figure.mdb) ? figure.mdb : 0.0;  // 0: never found
      answer.amplitudes.push_back({figure.value / figure.si_per_unit, figure.u / figure.si_per_unit,
                                   mdb / figure.si_per_unit, truth / figure.si_per_unit});
    }
    return answer;
  }

  void recover(const sim::SimulatedCampaign& simulated, const FitResult& given, const Diagnosis& diagnosis) {
    record_.recovery = true;
    record_.ms_given = unseen_square(simulated, given);
    record_.ms_oracle = oracle_square(simulated);
    record_.ms_named =
        diagnosis.effects.empty()
            ? record_.ms_given
            : unseen_square(simulated, fitted(simulated.campaign, given_with(diagnosis.effects)));
    record_.ms_told = record_.ms_offered = record_.ms_named;
    if (!record_.sets.empty())
      record_.ms_told =
          unseen_square(simulated, fitted(simulated.campaign, given_with(with_first_of_sets(diagnosis))));
    if (record_.sets.empty() && diagnosis.surfaces.empty()) return;
    for (const SurfaceFinding& surface : diagnosis.surfaces)
      record_.drawn.push_back(surface.accepted_label());
    record_.ms_offered = unseen_square(
        simulated, fitted(simulated.campaign,
                          extended_model(plan_.given, simulated.campaign, accepted_effects(diagnosis))));
  }

  /// The model that was diagnosed with what was found; more resolution is no name.
  ModelSpec given_with(const std::vector<EffectFinding>& findings) const {
    ModelSpec model = plan_.given;
    for (const EffectFinding& finding : findings) {
      if (!finding.resolution && !restore_left_out(finding.spec, plan_.study.machine, model))
        model.effects.push_back(finding.spec);
    }
    return model;
  }

  /// With the hidden effects in the model where the catalogue has them, else with nothing hidden.
  double oracle_square(const sim::SimulatedCampaign& simulated) const {
    ModelSpec oracle;
    for (const RightAnswer& right : right_) {
      if (right.spec) oracle.effects.push_back(*right.spec);
    }
    if (oracle.effects.size() == right_.size())
      return unseen_square(simulated, fitted(simulated.campaign, oracle));
    sim::Study clean = plan_.study;
    clean.hidden.clear();
    const sim::SimulatedCampaign without = sim::simulate(clean);
    return unseen_square(without, fitted(without.campaign, {}));
  }

  std::string row_;
  int index_;
  std::uint64_t seed_;
  int readings_;
  SearchRules rules_;
  PlannedCampaign plan_;
  std::unique_ptr<Yardstick> yardstick_;
  Hidden hidden_;
  std::vector<RightAnswer> right_;
  CampaignRecord record_;
};

}  // namespace

CampaignRecord criticise_campaign(const std::string& row, int index, std::uint64_t seed, int readings,
                                  const SearchRules& rules) {
  return CampaignRun(row, index, seed, readings, rules).run();
}

std::optional<sim::Study> study_of_campaign(const std::string& row, int index, std::uint64_t seed,
                                            int readings) {
  return CampaignRun(row, index, seed, readings).study();
}

}  // namespace volcal::studies
