#include "volcal/identify/criticism/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "volcal/identify/criticism/constancy_test.h"
#include "volcal/identify/criticism/shape_refinement.h"
#include "volcal/identify/solve/correlated_adjustment.h"

namespace volcal {

const double kLog10FamilyRisk = std::log10(0.005);
const double kLog10GenericRisk = std::log10(0.002);
const double kLog10ConstancyRisk = std::log10(0.01);

namespace {

constexpr double kToldApart = 6.0;       // of the extended BIC
constexpr double kWorthRefining = 40.0;  // the same, below the leading one
constexpr double kNotByChance = -2.0;    // log10 p of a family for itself, before its shape is refined
constexpr double kVisibleDerivative = 1e-3;
constexpr double kSameLikelihood = 4.0;  // of LM: what fits as well is a rival, however many its parameters
constexpr double kLessProbable = 0.1;    // share of log10 p, family-wise; components cost probability
constexpr int kMostChanges = 4;
constexpr int kNoiseRounds = 2;

void append(Eigen::MatrixXd& all, const Eigen::MatrixXd& more) {
  const Eigen::Index before = all.cols();
  all.conservativeResize(more.rows(), before + more.cols());
  all.rightCols(more.cols()) = more;
}

bool near(const FamilyTest& own, const FamilyTest& other) {
  return own.gain - other.gain < kToldApart || own.score.lm - other.score.lm < kSameLikelihood;
}

}  // namespace

EffectSearch::EffectSearch(LinearModel& model, const std::vector<bool>& heldout, SearchOptions options)
    : model_(model), heldout_(heldout), options_(std::move(options)), families_(volcal::families(model)) {
  std::erase_if(families_, [this](const Family& family) {
    return std::ranges::find(options_.leave_out, family.name().kind) != options_.leave_out.end();
  });
  log10_families_ = std::log10(static_cast<double>(std::max<std::size_t>(families_.size(), 1)));
  variables_ = scan_variables(model_);
}

void EffectSearch::run() {
  start();
  climb();
  settle([this] { climb(); });
  give_up();
  if (!options_.climb) keep_one_step();
  restate_ladder();
}

/// Until every added effect stands against its rivals.
void EffectSearch::settle(const std::function<void()>& after_a_change) {
  for (int change = 0; change < kMostChanges; ++change) {
    if (!reconsider(true)) return;
    after_a_change();
  }
  reconsider(false);
}

void EffectSearch::start() {
  if (options_.progress) options_.progress("noise model", 0.05);
  model_.return_to_fit();
  added_.clear();
  ladder_.clear();
  smoothing_of_steps_.clear();
  heldout_loglik_.reset();
  find_noise();
  add_step("");
}

/// Noise of all readings, then smoothing under it by those that are not held out, as the projector that
/// chooses; twice where the smoothing changes, since either takes the other's part.
void EffectSearch::find_noise() {
  NoiseOptions noise;
  noise.threads = options_.threads;
  noise.uncertainty = false;
  for (int round = 0; round < (model_.smoothing().empty() ? 1 : kNoiseRounds); ++round) {
    noise_estimate_ =
        estimate_noise(problem_with_added(), noise, noise_estimate_ ? &*noise_estimate_ : nullptr);
    noise_ = noise_estimate_->parameters();
    projector_ = projector_without(std::nullopt);
    if (model_.smoothing().empty()) return;
    const std::vector<SmoothingTerm> before = model_.smoothing();
    model_.smooth(projector_->gram(), projector_->observations());
    if (alike(before, model_.smoothing())) break;
  }
  projector_ = projector_without(std::nullopt);
}

NoiseEstimate EffectSearch::noise_with_uncertainty() const {
  NoiseOptions noise;
  noise.threads = options_.threads;
  return estimate_noise(problem_with_added(), noise, &*noise_estimate_);
}

std::unique_ptr<Projector> EffectSearch::projector_of_all_readings() const {
  return projector_of(model_.problem().data, std::nullopt);
}

std::unique_ptr<Projector> EffectSearch::projector_without(std::optional<std::size_t> left_out) const {
  return projector_of(without(model_.problem().data, heldout_), left_out);
}

std::unique_ptr<Projector> EffectSearch::projector_of(const NoiseData& data,
                                                      std::optional<std::size_t> left_out) const {
  auto projector =
      std::make_unique<Projector>(model_.problem(), data, noise_, options_.threads, model_.parts());
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(model_.size()), 0);
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (i != left_out) append(columns, added_[i].columns);
  }
  if (columns.cols() > 0) projector->accept(columns);
  return projector;
}

/// The linear model with the added effects as further columns.
NoiseProblem EffectSearch::problem_with_added() const {
  NoiseProblem problem = model_.problem();
  for (const AddedEffect& effect : added_) append(problem.jacobian, effect.columns);
  const Eigen::Index before = problem.prior_mean.size(), count = problem.jacobian.cols();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(count, count);
  precision.topLeftCorner(before, before) = problem.prior_precision;
  problem.prior_precision = std::move(precision);
  problem.prior_mean.conservativeResize(count);
  problem.prior_mean.tail(count - before).setZero();
  return problem;
}

void EffectSearch::test() {
  tests_ = refined_tests(*projector_);
  generic_ = generic_scan(model_, variables_, *projector_, options_.threads);
  log10_generic_ = std::log10(static_cast<double>(std::max<std::size_t>(generic_.size(), 1)));
}

std::vector<FamilyTest> EffectSearch::refined_tests(const Projector& projector) const {
  std::vector<FamilyTest> tests = test_families(model_, families_, projector, options_.threads);
  double best = 0.0;
  for (const FamilyTest& test : tests) best = std::max(best, test.gain);
  for (FamilyTest& test : tests) {
    if (test.gain > best - kWorthRefining && test.log10_p < kNotByChance)
      refine_shape(model_, families_[test.family], projector, test);
  }
  return tests;
}

void EffectSearch::climb() {
  for (;;) {
    if (options_.progress) {
      options_.progress(fmt::format("tests, step {}", added_.size() + 1),
                        0.2 + 0.7 * static_cast<double>(added_.size()) / (options_.most + 1.0));
    }
    test();
    if (first_tests_.empty()) {
      first_tests_ = tests_;
      first_generic_ = generic_;
    }
    if (static_cast<int>(added_.size()) >= options_.most || !add_leading()) return;
  }
}

/// False when nothing stands out, or something that is in no catalogue stands out more.
bool EffectSearch::add_leading() {
  const FamilyTest* best = leading(tests_, std::nullopt);
  if (best == nullptr) return false;
  if (family_wise_log10_p(*best) > kLog10FamilyRisk) return false;
  if (generic_does_better(*best)) return false;
  add(FamilyTest(*best));
  return true;
}

void EffectSearch::add(const FamilyTest& test) {
  const Family& family = families_[test.family];
  AddedEffect effect{test, family_columns(model_, family, test.shape), {}};
  if (const auto derivative = shape_derivative(model_, family, test.shape, test.score.amplitude)) {
    projector_->accept(effect.columns);
    const ProjectedColumns projected = projector_->project(*derivative);
    if (projected.gram(0, 1)(0, 0) > std::pow(kVisibleDerivative * projected.norm[0], 2)) {
      append(effect.columns, *derivative);
    }
  }
  added_.push_back(std::move(effect));
  find_noise();
  while (take_up_removed() > 0) find_noise();
  add_step(family.label());
}

/// Those that are no outliers of the model reached.
std::size_t EffectSearch::take_up_removed() {
  const NoiseProblem& problem = model_.problem();
  const Eigen::VectorXd solution = projector_->solution();
  const std::vector<double> sigma = total_sigma(problem.data, model_.stated_sigma(), noise_);
  Eigen::MatrixXd row(1, solution.size());
  return model_.take_up([&](std::size_t observation) {
    const auto at = static_cast<Eigen::Index>(observation);
    Eigen::Index column = problem.jacobian.cols();
    row.leftCols(column) = problem.jacobian.row(at);
    for (const AddedEffect& effect : added_) {
      row.middleCols(column, effect.columns.cols()) = effect.columns.row(at);
      column += effect.columns.cols();
    }
    const double miss = problem.residual[at] - row.row(0).dot(solution);
    const double u = std::hypot(sigma[observation], std::sqrt(projector_->prediction_variance(row)[0]));
    return std::abs(miss) < model_.outlier_critical_value() * u;
  });
}

void EffectSearch::add_step(const std::string& added) {
  std::vector<Eigen::MatrixXd> columns;
  for (const AddedEffect& effect : added_) columns.push_back(effect.columns);
  LadderStep step = ladder_step(model_, heldout_, noise_, *projector_, columns, heldout_loglik_);
  step.model = std::to_string(ladder_.size());
  step.added = added;
  ladder_.push_back(std::move(step));
  smoothing_of_steps_.push_back(model_.smoothing());
}

/// All steps against the noise of the model reached: noise estimated beside a missing effect holds part of
/// the effect, and would hide its fall.
void EffectSearch::restate_ladder() {
  std::vector<Eigen::MatrixXd> columns;
  heldout_loglik_.reset();
  for (std::size_t i = 0; i < ladder_.size(); ++i) {
    if (i > 0) columns.push_back(added_[i - 1].columns);
    model_.set_smoothing(smoothing_of_steps_[i]);
    Projector projector(model_.problem(), without(model_.problem().data, heldout_), noise_, options_.threads,
                        model_.parts());
    for (const Eigen::MatrixXd& each : columns) projector.accept(each);
    LadderStep step = ladder_step(model_, heldout_, noise_, projector, columns, heldout_loglik_);
    step.model = ladder_[i].model;
    step.added = ladder_[i].added;
    ladder_[i] = std::move(step);
  }
}

/// Each added effect against all others, now that the rest is in the model: true when one was exchanged or
/// left, and the climb goes on from there.
bool EffectSearch::reconsider(bool may_change) {
  std::vector<FamilyTest> kept;
  for (const AddedEffect& effect : added_) kept.push_back(effect.test);
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (options_.progress) options_.progress("rivals of " + families_[kept[i].family].label(), 0.9);
    std::vector<FamilyTest> tests = refined_tests(*projector_without(i));
    const FamilyTest& own = tests[kept[i].family];
    if (may_change && family_wise_log10_p(own) > kLog10FamilyRisk) {
      dropped_.insert(own.family);
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(i));
      add_again(kept);
      return true;
    }
    const FamilyTest* best = leading(tests, kept[i].family);
    if (may_change && best != nullptr && best->gain > own.gain + kToldApart) {
      kept[i] = *best;
      add_again(kept);
      return true;
    }
    added_[i].test = own;
    added_[i].rivals.clear();
    for (const FamilyTest& test : tests) {
      if (test.score.dof > 0 && !is_added(test.family) && near(own, test)) added_[i].rivals.push_back(test);
    }
    std::ranges::sort(added_[i].rivals, std::greater{}, &FamilyTest::gain);
  }
  return false;
}

/// Its own driver moves what an effect leaves: it has another shape, or is another effect.
bool EffectSearch::still_moves(const std::vector<std::string>& drivers) const {
  return std::ranges::any_of(generic_, [&](const GenericTest& test) {
    return family_wise_log10_p(test) < kLog10GenericRisk &&
           std::ranges::any_of(test.variables, [&](const std::string& variable) {
             return std::ranges::find(drivers, variable) != drivers.end();
           });
  });
}

/// Powers of one driver that are needed together stand for a function of it that the catalogue does not hold,
/// and a name that is less certain than what it leaves unexplained, leaves its own driver at work, or is of
/// another size here than there, is none.
void EffectSearch::find_no_names() {
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<std::size_t>> by_driver;
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const std::size_t family = added_[i].test.family;
    const EffectName name = families_[family].name();
    by_driver[{name.kind, name.target, name.driver}].push_back(family);
    const std::string reason = why_no_name(i);
    if (!reason.empty()) given_up_[family] = reason;
  }
  for (const auto& [key, members] : by_driver) {
    if (members.size() < 2) continue;
    for (const std::size_t family : members) given_up_[family] = "several powers of its driver are needed";
  }
}

/// Empty for a name that stands.
std::string EffectSearch::why_no_name(std::size_t added) const {
  const AddedEffect& effect = added_[added];
  const Family& family = families_[effect.test.family];
  double remains = 0.0;
  for (const GenericTest& test : generic_) remains = std::min(remains, family_wise_log10_p(test));
  if (remains < kLog10GenericRisk && remains < family_wise_log10_p(effect.test)) {
    return "what it leaves stands out more than it does";
  }
  const auto drivers = scan_variables_of(family.name());
  if (still_moves(drivers)) return fmt::format("{} still moves what it leaves", fmt::join(drivers, " or "));
  if (!family.effect) return {};
  const Eigen::Index first = first_column(added), count = family.amplitudes();
  const Eigen::VectorXd moved = effect.columns.leftCols(count) * projector_->solution().segment(first, count);
  const ConstancyTest constancy = least_constant(family, moved, variables_, *projector_);
  if (constancy.log10_p > kLog10ConstancyRisk) return {};
  return fmt::format("its amplitude varies with {} (log10 p {:.1f})", constancy.variable, constancy.log10_p);
}

/// Of the amplitudes among the projector's parameters.
Eigen::Index EffectSearch::first_column(std::size_t added) const {
  Eigen::Index first = projector_->parameters() - projector_->accepted();
  for (std::size_t i = 0; i < added; ++i) first += added_[i].columns.cols();
  return first;
}

void EffectSearch::give_up() {
  find_no_names();
  if (given_up_.empty()) return;
  std::vector<FamilyTest> kept;
  for (const AddedEffect& effect : added_) {
    if (!given_up_.contains(effect.test.family)) kept.push_back(effect.test);
  }
  add_again(kept);
  settle([] {});
  test();
}

/// The first effect, and the changes of the model before it.
void EffectSearch::keep_one_step() {
  const auto is_effect = [this](const AddedEffect& each) {
    return families_[each.test.family].effect != nullptr;
  };
  const auto first = std::ranges::find_if(added_, is_effect);
  if (first == added_.end() || first + 1 == added_.end()) return;
  more_is_known_ = std::any_of(first + 1, added_.end(), is_effect);
  const std::vector<AddedEffect> before(added_.begin(), first + 1);
  std::vector<FamilyTest> kept;
  std::ranges::transform(before, std::back_inserter(kept), &AddedEffect::test);
  add_again(kept);
  for (std::size_t i = 0; i < before.size(); ++i) added_[i].rivals = before[i].rivals;
  test();
}

/// The ladder from its beginning.
void EffectSearch::add_again(const std::vector<FamilyTest>& tests) {
  start();
  for (const FamilyTest& test : tests) add(test);
}

bool EffectSearch::is_added(std::size_t family) const {
  return std::ranges::any_of(added_, [&](const AddedEffect& each) { return each.test.family == family; });
}

/// Best of those that are not in the model, `but` one that is.
const FamilyTest* EffectSearch::leading(const std::vector<FamilyTest>& tests,
                                        std::optional<std::size_t> but) const {
  const FamilyTest* best = nullptr;
  for (const FamilyTest& test : tests) {
    if (test.score.dof == 0 || given_up_.contains(test.family) || dropped_.contains(test.family)) continue;
    if (is_added(test.family) && test.family != but) continue;
    if (best == nullptr || test.gain > best->gain) best = &test;
  }
  return best;
}

/// An unlisted effect of few terms has a larger gain among the polynomials; bumps and waves make a kernel
/// less probable than any name.
bool EffectSearch::generic_does_better(const FamilyTest& best) const {
  return std::ranges::any_of(generic_, [&](const GenericTest& test) {
    if (!test.kernel && test.gain > best.gain + kToldApart) return true;
    return family_wise_log10_p(test) < (1.0 + kLessProbable) * family_wise_log10_p(best) - 1.0;
  });
}

double EffectSearch::family_wise_log10_p(const FamilyTest& test) const {
  return std::min(0.0, test.log10_p + log10_families_);
}

double EffectSearch::family_wise_log10_p(const GenericTest& test) const {
  return std::min(0.0, test.log10_p + log10_generic_);
}

double EffectSearch::log10_level() const { return kLog10FamilyRisk - log10_families_; }

}  // namespace volcal
