#include "volcal/identify/criticism/proposals/next_measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/proposals/measurement_planner.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kNothing = 1e-6;  // s^2 that counts as none
constexpr std::size_t kMostAlternatives = 6;
constexpr std::size_t kMostProposals = 6;
constexpr std::size_t kMostActions = 3;     // that make effects visible
constexpr Eigen::Index kMostColumns = 400;  // of effects that are not visible

struct Pair {
  std::size_t first;
  std::size_t second;
};

class Proposer {
 public:
  Proposer(const CriticismState& state, const PlanningOptions& options, Diagnosis& diagnosis)
      : state_(state), options_(options), diagnosis_(diagnosis) {}

  void run() {
    const std::vector<PlannedHypothesis> asked = asked_hypotheses();
    const std::vector<Alternatives> alternatives = open_sets();
    std::vector<PlannedHypothesis> invisible;
    if (diagnosis_.verdict == Verdict::NotVisible) invisible = invisible_hypotheses();
    if (asked.empty() && alternatives.empty() && invisible.empty()) return;

    const CandidateContext context{state_.model.campaign(), state_.model.model().chain(), options_.readings};
    const HypotheticalCampaign hypothetical(state_.model.campaign(), state_.result,
                                            state_.model.noise_groups(), candidate_measurements(context));
    if (!asked.empty()) {
      const MeasurementPlanner planner = plan(asked, hypothetical);
      separate(planner, hypothetical, {asked, nullptr}, all_pairs(asked.size()));
      make_visible(planner, hypothetical, asked);
    }
    for (const Alternatives& set : alternatives)
      separate(plan(set.members, hypothetical), hypothetical, set, with_leading(set.members.size()));
    if (!invisible.empty()) make_visible(plan(invisible, hypothetical), hypothetical, invisible);
  }

 private:
  /// What is to be separated.
  struct Alternatives {
    std::vector<PlannedHypothesis> members;
    const SetFinding*
        same;  ///< of members that make the same of the volume; null: they do not, or nobody asked
  };

  std::vector<Alternatives> open_sets() const {
    std::vector<Alternatives> open;
    const auto sets = sets_of_alternatives(diagnosis_);
    for (std::size_t i = 0; i < sets.size(); ++i) {
      std::vector<PlannedHypothesis> members = of_findings(*sets[i]);
      if (members.size() < 2) continue;
      const bool is_same =
          i < diagnosis_.sets.size() && diagnosis_.sets[i].farthest && !diagnosis_.sets[i].matters;
      open.push_back({std::move(members), is_same ? &diagnosis_.sets[i] : nullptr});
    }
    return open;
  }

  const Family& family(const PlannedHypothesis& each) const {
    return state_.families[each.hypothesis.family];
  }

  MeasurementPlanner plan(const std::vector<PlannedHypothesis>& hypotheses,
                          const HypotheticalCampaign& hypothetical) const {
    std::vector<PlannedHypothesis> all;
    for (const Hypothesis& accepted : accepted_hypotheses(diagnosis_, state_.families)) {
      if (state_.families[accepted.family].effect) all.push_back({accepted, {}});
    }
    std::erase_if(all, [&](const PlannedHypothesis& accepted) {
      return std::ranges::any_of(hypotheses, [&](const PlannedHypothesis& each) {
        return each.hypothesis.family == accepted.hypothesis.family;
      });
    });
    const std::size_t given = all.size();
    all.insert(all.end(), hypotheses.begin(), hypotheses.end());
    return {state_, std::move(all), given, hypothetical};
  }

  /// Alternatives as they were found; changes of resolution are no effects.
  std::vector<PlannedHypothesis> of_findings(const std::vector<EffectFinding>& findings) const {
    std::vector<PlannedHypothesis> out;
    for (const EffectFinding& finding : findings) {
      if (finding.resolution || out.size() == kMostAlternatives) continue;
      auto hypothesis = hypothesis_of(finding, state_.families);
      if (!hypothesis) continue;
      Eigen::VectorXd amplitude =
          Eigen::VectorXd::Zero(state_.families[hypothesis->family].amplitudes());  // some may not stand
      for (std::size_t k = 0; k < finding.amplitudes.size(); ++k) {
        amplitude[static_cast<Eigen::Index>(k)] = finding.amplitudes[k].value;
      }
      out.push_back({*std::move(hypothesis), std::move(amplitude)});
    }
    return out;
  }

  std::vector<PlannedHypothesis> invisible_hypotheses() const {
    std::vector<PlannedHypothesis> out;
    Eigen::Index columns = 0;
    for (const EffectFinding& finding : diagnosis_.not_visible) {
      auto hypothesis = hypothesis_of(finding, state_.families);
      if (!hypothesis) continue;
      columns += state_.families[hypothesis->family].amplitudes();
      if (columns > kMostColumns) break;
      out.push_back({*std::move(hypothesis), {}});
    }
    return out;
  }

  std::vector<PlannedHypothesis> asked_hypotheses() const {
    std::vector<PlannedHypothesis> out;
    for (const EffectSpec& spec : options_.separate) {
      const EffectName name = find_effect(spec.kind)->make(spec, {})->name();
      const auto found = std::ranges::find_if(
          state_.families, [&](const Family& each) { return each.effect && each.name() == name; });
      if (found == state_.families.end()) {
        throw InputError({}, fmt::format("{}:{} is part of the model already", name.kind, name.target.name()),
                         "ask about effects that the model does not have");
      }
      out.push_back(asked(static_cast<std::size_t>(found - state_.families.begin())));
    }
    return out;
  }

  /// As it was found when it is significant, else where it is hardest to see.
  PlannedHypothesis asked(std::size_t family) const {
    std::vector<const std::vector<EffectFinding>*> lists = sets_of_alternatives(diagnosis_);
    lists.push_back(&diagnosis_.effects);
    for (const auto* list : lists) {
      for (const EffectFinding& finding : *list) {
        if (finding.name == state_.families[family].name()) return of_findings({finding}).front();
      }
    }
    const FamilyTest& test = state_.tests[family];
    if (test.log10_p < state_.log10_level) return {{family, test.shape}, test.score.amplitude};
    return {{family, least_visible_shape(family)}, {}};
  }

  /// Of the shapes that are looked for and the usual one.
  Eigen::VectorXd least_visible_shape(std::size_t family) const {
    std::vector<Hypothesis> all;
    for (const Eigen::VectorXd& shape : state_.families[family].scan) all.push_back({family, shape});
    all.push_back({family, state_.families[family].effect->shape_values()});
    const Eigen::Index amplitudes = state_.families[family].amplitudes();
    const ProjectedColumns projected =
        state_.projector.project(columns_of(state_.model, state_.families, all));
    std::size_t least = 0;
    double least_fraction = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double known = projected.norm.segment(projected.first[i], amplitudes).squaredNorm();
      const double fraction = known > 0.0 ? projected.grams[i].trace() / known : 0.0;
      if (fraction >= least_fraction) continue;
      least_fraction = fraction;
      least = i;
    }
    return all[least].shape;
  }

  static std::vector<Pair> all_pairs(std::size_t count) {
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) pairs.push_back({i, j});
    }
    return pairs;
  }
  static std::vector<Pair> with_leading(std::size_t count) {
    std::vector<Pair> pairs;
    for (std::size_t i = 1; i < count; ++i) pairs.push_back({0, i});
    return pairs;
  }

  /// The pair that is least apart, and how far.
  static std::pair<Pair, double> nearest(const MeasurementPlanner& planner, const ProjectedHypotheses& where,
                                         const std::vector<Pair>& pairs) {
    std::pair<Pair, double> least{pairs.front(), std::numeric_limits<double>::infinity()};
    for (const Pair& pair : pairs) {
      const double apart = planner.separation(where, pair.first, pair.second);
      if (apart < least.second) least = {pair, apart};
    }
    return least;
  }

  /// An instrument or a tool that the campaign did not use has to be worth it.
  double worth(const ExtraMeasurement& measurement) const {
    const auto& used = state_.model.noise_groups();
    const bool at_hand = std::ranges::all_of(measurement.setups, [&](const Setup& setup) {
      return std::ranges::any_of(used, [&](const std::string& group) {
        return instrument_of_noise_group(group) == setup.instrument;
      });
    });
    return at_hand && measurement.tools.empty() ? 1.0 : 1.0 / kThresholds.effort;
  }

  std::size_t best_for(const MeasurementPlanner& planner, const HypotheticalCampaign& hypothetical,
                       const std::vector<Pair>& pairs) const {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < planner.measurements(); ++i) {
      const double apart =
          nearest(planner, planner.with(i), pairs).second * worth(hypothetical.measurements()[i]);
      if (apart <= most) continue;
      most = apart;
      best = i;
    }
    return best;
  }

  /// One measurement that serves all pairs, then others for pairs that have a much better one.
  void separate(const MeasurementPlanner& planner, const HypotheticalCampaign& hypothetical,
                const Alternatives& set, const std::vector<Pair>& pairs) {
    if (pairs.empty() || planner.measurements() == 0) return;
    const std::size_t common = best_for(planner, hypothetical, pairs);
    propose(planner, hypothetical, set, nearest(planner, planner.now(), pairs).first, common);
    for (const Pair& pair : pairs) {
      const std::size_t own = best_for(planner, hypothetical, {pair});
      const auto reached = [&](std::size_t i) {
        return planner.separation(planner.with(i), pair.first, pair.second);
      };
      if (own != common && reached(own) > kThresholds.much_better * reached(common)) {
        propose(planner, hypothetical, set, pair, own);
      }
    }
  }

  /// s^2 without rounding.
  static double something(double separation) { return separation > kNothing ? separation : 0.0; }

  static double ratio(double after, double before) {
    if (before > 0.0) return after / before;
    return after > 0.0 ? std::numeric_limits<double>::infinity() : 1.0;
  }

  /// That none separates the two, and where it makes no difference to the machine that it makes none.
  static Finding none_separates(const std::vector<std::string>& both, const SetFinding* same) {
    Finding finding{FindingCode::MeasurementNoneSeparates, {{"effects", both}}};
    if (same == nullptr) return finding;
    const MemberFinding& farthest = same->members[*same->farthest];
    finding.data["difference"] = FindingNumber{farthest.difference, "um", kMicro};
    finding.data["U"] = FindingNumber{kCoverageFactor * farthest.difference_u, "um", kMicro};
    add_conditions(farthest, finding);
    return finding;
  }

  void propose(const MeasurementPlanner& planner, const HypotheticalCampaign& hypothetical,
               const Alternatives& set, Pair pair, std::size_t measurement) {
    if (diagnosis_.proposals.size() == kMostProposals) return;
    const auto apart = [&](const ProjectedHypotheses& where) {
      return planner.separation(where, pair.first, pair.second);
    };
    const PlannedHypothesis& first = set.members[pair.first];
    const PlannedHypothesis& second = set.members[pair.second];
    MeasurementProposal out;
    out.separates = {family(first).name(), family(second).name()};
    out.separation = something(apart(planner.now()));
    out.reached = something(apart(planner.with(measurement)));
    out.plain = something(apart(planner.plain(measurement)));
    out.gain = ratio(out.reached, out.separation);
    out.plain_gain = ratio(out.plain, out.separation);
    const std::vector<std::string> both = {described(first), described(second)};
    const double enough = set.same != nullptr ? kThresholds.worth_a_name : kThresholds.helpful_gain;
    if (out.gain < enough || out.reached < kThresholds.separated) {
      out.gain = out.plain_gain = 1.0;
      out.reached = out.plain = out.separation;
      out.finding = none_separates(both, set.same);
    } else {
      set_measurement(FindingCode::MeasurementSeparates, hypothetical.measurements()[measurement], out);
      out.finding.data["effects"] = both;
      out.finding.data["gain"] = FindingNumber{out.gain};
      out.finding.data["plain_gain"] = FindingNumber{out.plain_gain};
    }
    diagnosis_.proposals.push_back(std::move(out));
  }

  static void set_measurement(FindingCode code, const ExtraMeasurement& extra, MeasurementProposal& out) {
    out.action = extra.action;
    out.setup = extra.setup;
    out.readings = extra.readings();
    out.finding = {code,
                   {{"action", extra.action},
                    {"measurement", extra.words},
                    {"readings", static_cast<std::int64_t>(out.readings)}}};
  }

  std::string described(const PlannedHypothesis& each) const {
    std::string text = family(each).label();
    const auto& shapes = family(each).effect->shapes();
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      text += fmt::format(" ({} {:.4g} {})", stem_of_key(shapes[k].key),
                          each.hypothesis.shape[static_cast<Eigen::Index>(k)] / shapes[k].si_per_unit(),
                          shapes[k].unit());
    }
    return text;
  }

  /// Measurements that show most of what is hidden, one after another.
  void make_visible(const MeasurementPlanner& planner, const HypotheticalCampaign& hypothetical,
                    const std::vector<PlannedHypothesis>& hypotheses) {
    std::vector<std::size_t> hidden;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      if (planner.visible_fraction(planner.now(), i) < kThresholds.visible_fraction) hidden.push_back(i);
    }
    for (std::size_t action = 0; action < kMostActions && !hidden.empty(); ++action) {
      std::vector<std::size_t> most;
      std::size_t best = 0;
      double most_information = 0.0;
      for (std::size_t i = 0; i < planner.measurements(); ++i) {
        std::vector<std::size_t> shown = shown_by(planner, i, hidden);
        double information =
            0.0;  // a tie goes to the measurement that says most, in logarithms: units differ
        for (const std::size_t k : shown) {
          information +=
              std::log(planner.information(planner.with(i), k) * worth(hypothetical.measurements()[i]));
        }
        if (shown.size() < most.size()) continue;
        if (shown.empty() || (shown.size() == most.size() && information <= most_information)) continue;
        most = std::move(shown);
        most_information = information;
        best = i;
      }
      if (most.empty()) break;
      propose_visible(planner, hypothetical, hypotheses, most, hidden.size(), best);
      std::erase_if(hidden, [&](std::size_t i) { return std::ranges::find(most, i) != most.end(); });
    }
  }

  static std::vector<std::size_t> shown_by(const MeasurementPlanner& planner, std::size_t measurement,
                                           const std::vector<std::size_t>& hidden) {
    std::vector<std::size_t> shown;
    for (const std::size_t i : hidden) {
      if (planner.visible_fraction(planner.with(measurement), i) >= kThresholds.visible_fraction)
        shown.push_back(i);
    }
    return shown;
  }

  void propose_visible(const MeasurementPlanner& planner, const HypotheticalCampaign& hypothetical,
                       const std::vector<PlannedHypothesis>& hypotheses,
                       const std::vector<std::size_t>& shown, std::size_t hidden, std::size_t measurement) {
    MeasurementProposal out;
    set_measurement(FindingCode::MeasurementShows, hypothetical.measurements()[measurement], out);
    const std::size_t first = shown.front();
    const bool seen = planner.visible_fraction(planner.now(), first) > kThresholds.invisible_share;
    const double before = seen ? planner.information(planner.now(), first) : 0.0;
    out.gain = ratio(planner.information(planner.with(measurement), first), before);
    out.plain_gain = seen ? ratio(planner.information(planner.plain(measurement), first), before) : 1.0;
    std::vector<std::string> effects;
    for (const std::size_t k : shown) {
      out.makes_visible.push_back(family(hypotheses[k]).name());
      effects.push_back(described(hypotheses[k]));
    }
    out.finding.data["effects"] = std::move(effects);
    out.finding.data["of"] = static_cast<std::int64_t>(hidden);
    if (hidden == 1) {
      const auto& amplitude = family(hypotheses[shown.front()]).effect->amplitudes().front();
      out.finding.data["detectable"] =
          FindingNumber{planner.detectable(planner.with(measurement), shown.front()),
                        std::string(amplitude.unit()), amplitude.si_per_unit()};
    }
    diagnosis_.proposals.push_back(std::move(out));
  }

  const CriticismState& state_;
  const PlanningOptions& options_;
  Diagnosis& diagnosis_;
};

}  // namespace

void add_next_measurements(const CriticismState& state, const PlanningOptions& options,
                           Diagnosis& diagnosis) {
  Proposer(state, options, diagnosis).run();
}

}  // namespace volcal
