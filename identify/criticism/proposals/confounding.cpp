#include "volcal/identify/criticism/proposals/confounding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "volcal/identify/criticism/projection/separation.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr Eigen::Index kRivalBlockColumns = 160;
constexpr std::size_t kMatrix = 24;           // hypotheses that the matrix shows
constexpr std::size_t kInvisibleListed = 40;  // of the families that are not visible
constexpr double kFarApart = 0.01;            // squared cosine that changes an MIB by half a percent

/// What is known of one hypothesis against all its rivals.
struct Nearest {
  Eigen::VectorXd u;                ///< of the amplitudes, the worst rival in the model too
  std::vector<std::string> rivals;  ///< per amplitude; empty: none that matters
};

class RivalSearch {
 public:
  RivalSearch(const CriticismState& state, std::vector<Hypothesis> accepted, std::vector<Hypothesis> others)
      : state_(state),
        accepted_(accepted.size()),
        projector_(state.model.problem(), state.data, state.noise, state.threads, state.model.parts()),
        focus_(std::move(accepted)) {
    focus_.insert(focus_.end(), others.begin(), others.end());
    for (const Hypothesis& each : focus_) focus_columns_ += width(each);
  }

  /// Per focus.
  std::vector<Nearest> run() {
    const std::vector<std::vector<Hypothesis>> all = blocks();
    std::vector<std::vector<Nearest>> found(all.size());
    run_parallel(all.size(), state_.threads, [&](std::size_t i) { found[i] = nearest(all[i], i == 0); });
    for (std::size_t i = 1; i < found.size(); ++i) {
      for (std::size_t k = 0; k < focus_.size(); ++k) merge(found[i][k], found[0][k]);
    }
    return std::move(found[0]);
  }

  /// Cosines of the first hypotheses; after run().
  Confounding matrix(std::size_t most) const {
    const auto count = static_cast<Eigen::Index>(std::min(most, focus_.size()));
    Confounding out;
    out.cosine = Eigen::MatrixXd::Identity(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Family& family = state_.families[focus_[static_cast<std::size_t>(i)].family];
      out.names.push_back(family.name());
      out.labels.push_back(family.label());
      for (Eigen::Index j = 0; j <= i; ++j) {
        out.cosine(i, j) = out.cosine(j, i) = canonical_cosine(focus_gram_, range(i), range(j));
      }
    }
    return out;
  }

  const std::vector<Hypothesis>& focus() const { return focus_; }

 private:
  Eigen::Index width(const Hypothesis& each) const { return state_.families[each.family].amplitudes(); }

  ColumnRange range(Eigen::Index focus) const {
    ColumnRange out;
    for (Eigen::Index i = 0; i < focus; ++i) out.first += width(focus_[static_cast<std::size_t>(i)]);
    out.count = width(focus_[static_cast<std::size_t>(focus)]);
    return out;
  }

  /// All visible families that are no focus; at least one block.
  std::vector<std::vector<Hypothesis>> blocks() const {
    std::vector<std::vector<Hypothesis>> all(1);
    Eigen::Index columns = 0;
    for (const FamilyTest& test : state_.tests) {
      const auto is_it = [&](const Hypothesis& each) { return each.family == test.family; };
      if (test.score.dof == 0 || std::ranges::any_of(focus_, is_it)) continue;
      const Hypothesis rival{test.family, test.shape};
      if (columns + width(rival) > kRivalBlockColumns) {
        all.emplace_back();
        columns = 0;
      }
      columns += width(rival);
      all.back().push_back(rival);
    }
    return all;
  }

  /// Gram matrix of the focus, then the rivals, projected off the model.
  Eigen::MatrixXd gram_of(const std::vector<Hypothesis>& all) const {
    CandidateColumns candidates = columns_of(state_.model, state_.families, all);
    candidates.groups = {candidates.count};
    const ProjectedColumns projected = projector_.project(candidates);
    Eigen::MatrixXd gram = projected.grams.front();
    clear_invisible(projected.norm, gram);
    return gram;
  }

  /// The focus against the rivals of a block; with `each_other`, also among itself.
  std::vector<Nearest> nearest(const std::vector<Hypothesis>& rivals, bool each_other) {
    std::vector<Hypothesis> all = focus_;
    all.insert(all.end(), rivals.begin(), rivals.end());
    const Eigen::MatrixXd gram = gram_of(all);
    if (each_other) focus_gram_ = gram.topLeftCorner(focus_columns_, focus_columns_);
    std::vector<ColumnRange> ranges;
    Eigen::Index at = 0;
    for (const Hypothesis& each : all) {
      ranges.push_back({at, width(each)});
      at += width(each);
    }
    std::vector<Nearest> out(focus_.size());
    for (std::size_t i = 0; i < accepted_; ++i) {
      Eigen::MatrixXd beside = gram;
      for (std::size_t k = 0; k < accepted_; ++k) {
        if (k != i) beside = projected_off(beside, ranges[k]);
      }
      compare(beside, all, ranges, i, i + 1, each_other, out);
    }
    Eigen::MatrixXd beside = gram;
    for (std::size_t k = 0; k < accepted_; ++k) beside = projected_off(beside, ranges[k]);
    compare(beside, all, ranges, accepted_, focus_.size(), each_other, out);
    return out;
  }

  void compare(const Eigen::MatrixXd& gram, const std::vector<Hypothesis>& all,
               const std::vector<ColumnRange>& ranges, std::size_t first, std::size_t end, bool each_other,
               std::vector<Nearest>& out) const {
    for (std::size_t f = first; f < end; ++f) {
      const auto [at, count] = ranges[f];
      const Eigen::MatrixXd own = gram.block(at, at, count, count);
      out[f] = {amplitude_uncertainty(own, own.diagonal()), std::vector<std::string>(ranges[f].count)};
    }
    for (std::size_t r = each_other ? 0 : focus_.size(); r < all.size(); ++r) {
      const Eigen::MatrixXd along = components_along(gram, ranges[r]);
      for (std::size_t f = first; f < end; ++f) {
        if (f == r) continue;
        const auto [at, count] = ranges[f];
        const Eigen::MatrixXd own = gram.block(at, at, count, count);
        const Eigen::MatrixXd onto = along.middleCols(at, count);
        const auto shares = onto.colwise().squaredNorm().transpose().array();
        if ((shares < kFarApart * own.diagonal().array()).all()) continue;
        merge({amplitude_uncertainty(own - onto.transpose() * onto, own.diagonal()),
               std::vector<std::string>(static_cast<std::size_t>(count),
                                        state_.families[all[r].family].label())},
              out[f]);
      }
    }
  }

  static void merge(const Nearest& other, Nearest& into) {
    for (Eigen::Index k = 0; k < into.u.size(); ++k) {
      if (!(other.u[k] > into.u[k])) continue;
      into.u[k] = other.u[k];
      into.rivals[static_cast<std::size_t>(k)] = other.rivals[static_cast<std::size_t>(k)];
    }
  }

  const CriticismState& state_;
  std::size_t accepted_;
  Projector projector_;
  std::vector<Hypothesis> focus_;
  Eigen::Index focus_columns_ = 0;
  Eigen::MatrixXd focus_gram_;
};

void add_unless_there(const Hypothesis& hypothesis, const std::vector<Hypothesis>& accepted,
                      std::vector<Hypothesis>& all) {
  const auto is_it = [&](const Hypothesis& each) { return each.family == hypothesis.family; };
  if (std::ranges::none_of(accepted, is_it) && std::ranges::none_of(all, is_it)) all.push_back(hypothesis);
}

}  // namespace

std::optional<Hypothesis> hypothesis_of(const EffectFinding& finding, std::span<const Family> families) {
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (families[i].name() != finding.name) continue;
    if (families[i].scan.size() == 1) return Hypothesis{i, families[i].scan.front()};
    return Hypothesis{i, find_effect(finding.spec.kind)->make(finding.spec, {})->shape_values()};
  }
  return std::nullopt;
}

std::vector<Hypothesis> accepted_hypotheses(const Diagnosis& diagnosis, std::span<const Family> families) {
  std::vector<Hypothesis> accepted;
  for (const auto* list : {&diagnosis.effects, &diagnosis.model_changes}) {
    for (const EffectFinding& finding : *list) {
      if (auto hypothesis = hypothesis_of(finding, families)) accepted.push_back(*std::move(hypothesis));
    }
  }
  return accepted;
}

void add_confounding(const CriticismState& state, Diagnosis& diagnosis) {
  const std::vector<Hypothesis> accepted = accepted_hypotheses(diagnosis, state.families);
  std::vector<Hypothesis> others;
  const auto add = [&](const std::vector<EffectFinding>& findings, std::size_t most) {
    for (const EffectFinding& finding : findings) {
      if (finding.dof == 0) continue;
      if (most-- == 0) return;
      if (const auto hypothesis = hypothesis_of(finding, state.families)) {
        add_unless_there(*hypothesis, accepted, others);
      }
    }
  };
  for (const auto* set : sets_of_alternatives(diagnosis)) add(*set, set->size());
  add(diagnosis.tried, diagnosis.tried.size());
  add(diagnosis.ranking, diagnosis.ranking.size());
  add(diagnosis.not_visible, kInvisibleListed);
  RivalSearch search(state, accepted, std::move(others));
  if (search.focus().empty()) return;
  const std::vector<Nearest> nearest = search.run();
  diagnosis.confounding = search.matrix(kMatrix);

  std::map<EffectName, const Nearest*> found;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    found[state.families[search.focus()[i].family].name()] = &nearest[i];
  }
  std::vector<std::vector<EffectFinding>*> lists = {&diagnosis.effects, &diagnosis.one_of, &diagnosis.ranking,
                                                    &diagnosis.not_visible, &diagnosis.tried};
  for (auto& set : diagnosis.further_one_of) lists.push_back(&set);
  for (auto* list : lists) {
    for (EffectFinding& finding : *list) {
      const auto it = found.find(finding.name);
      if (it == found.end()) continue;
      const double detectable =
          std::sqrt(detectable_noncentrality(state.log10_level, std::max(1, finding.dof), state.power));
      for (std::size_t k = 0; k < finding.amplitudes.size(); ++k) {
        AmplitudeFigure& figure = finding.amplitudes[k];
        figure.mib = std::max(figure.mdb, detectable * it->second->u[static_cast<Eigen::Index>(k)]);
        figure.mib_rival = it->second->rivals[k];
      }
    }
  }
}

}  // namespace volcal
