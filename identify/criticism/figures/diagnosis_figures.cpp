#include "volcal/identify/criticism/figures/diagnosis_figures.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "volcal/identify/criticism/figures/figure_statistics.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/statistics/even_sample.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr std::size_t kDrawn = 2500;
constexpr int kBins = 24;
constexpr int kPartialBins = 16;
constexpr int kCellsPerSide = 5;
constexpr std::size_t kFewestPerCell = 6;
constexpr double kSeen = 0.05;  // of the information along the best seen direction of a cell

class FigureMaker {
 public:
  FigureMaker(const ModelState& given, const ModelState& reached)
      : given_state_(given),
        state_(reached),
        setting_(reached.setting()),
        model_(reached.model()),
        problem_(model_.problem()) {
    for (const double variance : noise_variance(problem_.data, state_.noise()))
      deviation_.push_back(std::sqrt(variance));
  }

  DiagnosisFigures run() {
    find_residuals();
    draw_observations();
    for (const ScanVariable& variable : setting_.variables) {
      if (!variable.variable.is_indicator()) add_variable(variable);
    }
    add_categories();
    add_vectors();
    add_generic();
    add_autocorrelation();
    return std::move(figures_);
  }

 private:
  bool in_use(std::size_t i) const { return std::isfinite(problem_.data.sigma[i]); }
  const Setup& setup_of(std::size_t i) const {
    return model_.campaign().setups[model_.observations()[i].setup];
  }

  /// Residuals of both models, and the leading effect, for which the model without it is needed anyway.
  void find_residuals() {
    std::vector<Eigen::MatrixXd> others;
    std::set<std::size_t> all;
    for (const AddedEffect& effect : state_.added()) {
      all.insert(others.size());
      others.push_back(effect.columns);
    }
    reached_ = left_over(problem_, others, problem_.residual, state_.projector().solution());
    if (others.empty()) {
      given_ = reached_;
      add_leading(state_.projector(), {}, strongest());
      return;
    }
    const auto rest = state_.projector_without(all);
    given_ = left_over(problem_, {}, problem_.residual, rest->solution());
    const auto leading = std::ranges::find_if(
        state_.added(), [&](const AddedEffect& each) { return !state_.family_of(each).resolution; });
    if (leading == state_.added().end()) {
      for (const Eigen::MatrixXd& other : others) rest->accept(other);
      add_leading(*rest, others, strongest());
      return;
    }
    others.erase(others.begin() + (leading - state_.added().begin()));
    // The amplitude comes from all readings, and so does the line through the points.
    Projector readings(problem_, problem_.data, state_.noise(), setting_.threads, model_.parts());
    for (const Eigen::MatrixXd& other : others) readings.accept(other);
    figures_.leading.accepted = true;
    const Eigen::Index amplitudes =
        std::min(state_.family_of(*leading).amplitudes(), leading->columns.cols());
    add_leading(readings, others, {leading->test.family, leading->columns.leftCols(amplitudes)});
  }

  struct Leading {
    std::size_t family = 0;
    Eigen::MatrixXd columns;  ///< none: no effect is visible
  };

  Leading strongest() const {
    const FamilyTest* best = nullptr;
    for (const FamilyTest& test : state_.tests().families) {
      if (setting_.families[test.family].resolution || test.score.dof == 0) continue;
      if (best == nullptr || test.gain > best->gain) best = &test;
    }
    if (best == nullptr) return {};
    return {best->family, family_columns(model_, setting_.families[best->family], best->shape)};
  }

  void add_leading(const Projector& rest, std::span<const Eigen::MatrixXd> accepted, const Leading& leading) {
    if (leading.columns.cols() == 0) return;
    const NoiseData data = without(problem_.data, setting_.heldout);
    const PartialRegression partial =
        partial_regression(problem_, data, state_.noise(), rest, accepted, leading.columns);
    const Family& family = setting_.families[leading.family];
    const EffectAmplitude& amplitude = family.effect->amplitudes().front();
    AddedVariableFigure& figure = figures_.leading;
    figure.label = family.label();
    figure.unit = amplitude.unit();
    figure.si_per_unit = amplitude.si_per_unit();
    figure.slope = partial.slope;
    figure.u = partial.u;
    std::vector<Eigen::Index> used;
    for (std::size_t i = 0; i < model_.size(); ++i) {
      if (std::isfinite(data.sigma[i])) used.push_back(static_cast<Eigen::Index>(i));
    }
    for (const std::size_t k : even_sample(used.size(), kDrawn)) {
      figure.driver.push_back(partial.driver[used[k]]);
      figure.residual.push_back(partial.residual[used[k]]);
    }
    const Eigen::VectorXd driver = partial.driver(used), residual = partial.residual(used);
    const std::vector<int> bin = equal_bins(driver, kPartialBins);
    std::vector<double> variance(kPartialBins, 0.0);
    for (const int b : bin) variance[static_cast<std::size_t>(b)] += 1.0;
    for (double& count : variance) count = count > 0.0 ? 1.0 / count : 0.0;
    figure.mean = binned_mean(driver, residual, bin, variance);
  }

  void draw_observations() {
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < model_.size(); ++i) {
      if (in_use(i)) used.push_back(i);
    }
    figures_.observation_count = used.size();
    for (const std::size_t k : even_sample(used.size(), kDrawn)) drawn_.push_back(used[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) direction_[axis] = model_.direction(kScanDirections[axis]);
    for (const std::size_t i : drawn_) {
      const auto& [setup, row, channel] = model_.observations()[i];
      const auto at = static_cast<Eigen::Index>(i);
      DrawnObservation drawn;
      drawn.setup = setup;
      drawn.source_line = setup_of(i).readings.source_line[row];
      drawn.angle = is_angle(i);
      drawn.held_out = setting_.heldout[i];
      drawn.noise = deviation_[i];
      drawn.given = given_[at];
      drawn.reached = reached_[at];
      drawn.point_w = model_.views()[setup].nominal_point_w[row];
      drawn.direction_w = felt(at);
      figures_.observations.push_back(drawn);
    }
  }

  bool is_angle(std::size_t i) const {
    return is_angle_channel(setup_of(i), static_cast<std::size_t>(model_.observations()[i].channel));
  }
  Eigen::Vector3d felt(Eigen::Index i) const {
    return {direction_[0][i], direction_[1][i], direction_[2][i]};
  }

  /// `bin`: of every observation, whatever its kind.
  void add_figure(VariableFigure figure, const Eigen::VectorXd& abscissa, const std::vector<int>& bin,
                  int bins) {
    for (const std::size_t i : drawn_) figure.drawn.push_back(abscissa[static_cast<Eigen::Index>(i)]);
    for (std::size_t kind = 0; kind < std::size(figure.given); ++kind) {
      const Eigen::VectorXd felt = kind < 2 ? Eigen::VectorXd() : direction_[kind - 2];
      std::vector<int> own = bin;
      bool any = false;
      for (std::size_t i = 0; i < own.size(); ++i) {
        if (!in_use(i) || is_angle(i) != (kind == 1)) own[i] = -1;
        any = any || own[i] >= 0;
      }
      if (!any) continue;
      const std::vector<double> variance = mean_variance(problem_.data, state_.noise(), own, bins, felt);
      figure.given[kind] = binned_mean(abscissa, given_, own, variance, felt);
      figure.reached[kind] = binned_mean(abscissa, reached_, own, variance, felt);
    }
    figures_.variables.push_back(std::move(figure));
  }

  void add_variable(const ScanVariable& variable) {
    const Eigen::VectorXd abscissa = (variable.centre + variable.scale * variable.value.array()).matrix();
    add_figure({.name = variable.name(), .categories = {}, .drawn = {}, .given = {}, .reached = {}}, abscissa,
               equal_bins(abscissa, kBins), kBins);
  }

  template <class Name>
  void add_category(const std::string& name, const Name& name_of) {
    VariableFigure figure{.name = name, .categories = {}, .drawn = {}, .given = {}, .reached = {}};
    std::map<std::string, int> place;
    Eigen::VectorXd abscissa(static_cast<Eigen::Index>(model_.size()));
    std::vector<int> bin(model_.size());
    std::vector<int> of_setup;
    for (const Setup& setup : model_.campaign().setups) {
      const auto [found, is_new] = place.try_emplace(name_of(setup), static_cast<int>(place.size()));
      if (is_new) figure.categories.push_back(found->first);
      of_setup.push_back(found->second);
    }
    if (figure.categories.size() < 2) return;
    for (std::size_t i = 0; i < bin.size(); ++i) {
      bin[i] = of_setup[model_.observations()[i].setup];
      abscissa[static_cast<Eigen::Index>(i)] = bin[i];
    }
    const auto bins = static_cast<int>(figure.categories.size());
    add_figure(std::move(figure), abscissa, bin, bins);
  }

  void add_categories() {
    const Machine& machine = model_.campaign().machine;
    add_category("setup", [](const Setup& setup) { return setup.name; });
    if (station_names(model_.campaign()).size() > 1) {
      add_category("station", [](const Setup& setup) { return station_of(setup); });
    }
    add_category("tool", [&](const Setup& setup) { return machine.tools[setup.tool].name; });
  }

  /// Normal equations of a displacement in each cell of a grid over the measured points.
  void add_vectors() {
    struct Cell {
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d given = Eigen::Vector3d::Zero(), reached = Eigen::Vector3d::Zero();
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      std::size_t observations = 0;
    };
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
    for (const SetupView& view : model_.views()) {
      for (const Eigen::Vector3d& point : view.nominal_point_w) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
      }
    }
    std::map<std::array<int, 3>, Cell> cells;
    for (std::size_t i = 0; i < model_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d direction = felt(at);
      if (!in_use(i) || direction.isZero()) continue;
      const auto& [setup, row, channel] = model_.observations()[i];
      const Eigen::Vector3d& point = model_.views()[setup].nominal_point_w[row];
      std::array<int, 3> place{};
      for (int axis = 0; axis < 3; ++axis) {
        const double share = (point[axis] - low[axis]) / std::max(1e-9, high[axis] - low[axis]);
        place[static_cast<std::size_t>(axis)] =
            std::min(kCellsPerSide - 1, static_cast<int>(kCellsPerSide * share));
      }
      Cell& cell = cells[place];
      const Eigen::Vector3d weighted = direction / (deviation_[i] * deviation_[i]);
      cell.normal += weighted * direction.transpose();
      cell.given += weighted * given_[at];
      cell.reached += weighted * reached_[at];
      cell.point += point;
      ++cell.observations;
    }
    for (const auto& [place, cell] : cells) {
      if (cell.observations < kFewestPerCell) continue;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(cell.normal);
      ResidualVector vector;
      vector.observations = cell.observations;
      vector.point_w = cell.point / static_cast<double>(cell.observations);
      for (int k = 0; k < 3; ++k) {
        const double information = eigen.eigenvalues()[k];
        if (information < kSeen * eigen.eigenvalues()[2]) continue;
        const Eigen::Vector3d along = eigen.eigenvectors().col(k);
        vector.given_w += along * (along.dot(cell.given) / information);
        vector.reached_w += along * (along.dot(cell.reached) / information);
        vector.u += 1.0 / information;
      }
      vector.u = std::sqrt(vector.u);
      figures_.vectors.push_back(vector);
    }
  }

  void add_generic() {
    std::map<Variable, Eigen::Index> place;
    for (const ScanVariable& variable : setting_.variables) {
      place.emplace(variable.variable, static_cast<Eigen::Index>(place.size()));
      figures_.generic.variables.push_back(variable.name());
    }
    const auto count = static_cast<Eigen::Index>(place.size());
    const auto fill = [&](const std::vector<GenericTest>& tests, std::vector<Eigen::MatrixXd>& maps) {
      const double multiplicity = std::log10(static_cast<double>(std::max<std::size_t>(1, tests.size())));
      maps.assign(kScanDirections.size(), Eigen::MatrixXd::Zero(count, count));
      for (const GenericTest& test : tests) {
        const Eigen::Index a = place.at(test.variables.front()), b = place.at(test.variables.back());
        double& cell = maps[index_of(test.direction.value())](std::max(a, b), std::min(a, b));
        cell = std::min(cell, std::min(0.0, test.log10_p + multiplicity));
      }
    };
    fill(given_state_.tests().scans, figures_.generic.given);
    fill(state_.tests().scans, figures_.generic.reached);
  }

  void add_autocorrelation() {
    const Whitener whitener(problem_.data, state_.noise());
    const Eigen::VectorXd whitened = whitener.whiten(reached_);
    for (std::size_t group = 0; group < state_.noise().size(); ++group) {
      Autocorrelation one = autocorrelation(problem_.data, state_.noise(), group, reached_, whitened);
      if (!one.lag.empty()) figures_.autocorrelation.push_back(std::move(one));
    }
  }

  const ModelState& given_state_;
  const ModelState& state_;
  const SearchSetting& setting_;
  const LinearModel& model_;
  const NoiseProblem& problem_;
  std::vector<double> deviation_;
  Eigen::VectorXd given_, reached_;  ///< residuals of every observation
  std::vector<std::size_t> drawn_;
  std::array<Eigen::VectorXd, 3> direction_;
  DiagnosisFigures figures_;
};

}  // namespace

DiagnosisFigures diagnosis_figures(const ModelState& given, const ModelState& reached) {
  return FigureMaker(given, reached).run();
}

}  // namespace volcal
