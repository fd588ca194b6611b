#include "volcal/identify/planning/plan_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/planning/line_of_sight.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/identify/solve/campaign_noise.h"
#include "volcal/identify/solve/normals/stated_sigma.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/rank.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

constexpr int kSearchIntervals = 8;
constexpr int kSearchHarmonics = 4;
constexpr int kVolumePerAxis = 4;
constexpr std::size_t kProbePositions = 27;
constexpr int kTablePositions = 11;
constexpr double kWideNuisance = 1.0;  // m or rad
constexpr double kApart = 1.0;         // m, of an instrument that is tried from the volume

bool uses_automatic_knots(const FunctionSpec& function) {
  const BasisKind* kind = find_basis(function.basis);
  return kind != nullptr && kind->uses_knots && function.knots == KnotChoice::Automatic;
}

/// Breakpoints only: the functions stay smoothed.
ModelSpec with_few_knots(ModelSpec model, const Machine& machine) {
  for (const ErrorSymbol symbol : modelled_motions(machine, model)) {
    const Axis& axis = machine.axis(symbol.axis);
    FunctionSpec function = model.function(symbol);
    if (function.automatic_degree) function.degree = kSearchHarmonics;
    const BasisKind* kind = find_basis(function.basis);
    if (uses_automatic_knots(function)) {
      function.breakpoints = uniform_breakpoints(axis, kSearchIntervals);
    } else if (kind != nullptr && kind->uses_knots && function.knots == KnotChoice::IntervalCount) {
      function.breakpoints = uniform_breakpoints(axis, function.intervals);
    }
    model.functions[symbol] = function;
  }
  return model;
}

bool comes_from_setups(const ParameterBlock& block) {
  return block.kind == ParameterKind::Nuisance || block.kind == ParameterKind::ToolOffset;
}

/// Where no position is: a length of zero has no derivative.
Eigen::Vector3d probe_place_w(const LineOfSight& sight) {
  const Eigen::Vector3d corner_w = sight.stations_w().min();
  const bool among_positions = sight.swept_w().contains(corner_w);
  return among_positions ? corner_w - kApart * Eigen::Vector3d::Ones() - sight.swept_w().sizes() : corner_w;
}

/// Row numbers, ascending: first and last row and the one farthest from the first, which give a setup its
/// direction; with `of_passes` the first row of every line and of every run, too.
std::set<std::size_t> rows_of_unknowns(const Setup& setup, const Machine& machine, bool of_passes) {
  const Readings& all = setup.readings;
  if (all.size() == 0) return {};
  const KinematicChain chain(machine);
  const auto point_w = [&](std::size_t row) {
    return chain.nominal_point_w(all.commanded_position(row), machine.tools[setup.tool].offset);
  };
  const Eigen::Vector3d start_w = point_w(0);
  std::size_t farthest = 0;
  double reach = 0.0;
  for (std::size_t row = 1; row < all.size(); ++row) {
    const double distance = (point_w(row) - start_w).norm();
    if (distance <= reach) continue;
    reach = distance;
    farthest = row;
  }
  std::set<std::size_t> rows = {0, farthest, all.size() - 1};
  if (!of_passes) return rows;
  for (const std::vector<std::int32_t>* passes : {&all.line, &all.run}) {
    std::set<std::int32_t> seen;
    for (std::size_t row = 0; row < passes->size(); ++row) {
      if (seen.insert((*passes)[row]).second) rows.insert(row);
    }
  }
  return rows;
}

void keep_rows(const std::set<std::size_t>& rows, Setup& setup) {
  Readings& all = setup.readings;
  const auto keep = [&rows](auto& column) {
    if (column.empty()) return;
    std::size_t kept = 0;
    for (const std::size_t row : rows) column[kept++] = column[row];
    column.resize(kept);
  };
  for (auto& column : all.position) keep(column);
  for (auto& column : all.direction) keep(column);
  for (auto& column : all.value) keep(column);
  for (auto& column : all.given) keep(column);
  for (auto& [name, column] : all.temperature) keep(column);
  keep(all.sigma);
  keep(all.time);
  keep(all.line);
  keep(all.run);
  keep(all.feed);
  keep(all.source_line);
  setup.left_out.clear();
}

std::vector<std::pair<std::string, int>> unknowns_of(const Campaign& campaign, const ModelSpec& model) {
  std::vector<std::pair<std::string, int>> unknowns;
  const MeasurementModel bound(campaign, model);
  for (const ParameterBlock& block : bound.layout().blocks) unknowns.emplace_back(block.name, block.size());
  return unknowns;
}

/// As few rows of every setup as bring along the same unknowns as all do.
Campaign thinned(const Campaign& campaign, const ModelSpec& model) {
  const auto unknowns = unknowns_of(campaign, model);
  for (const bool of_passes : {false, true}) {
    Campaign thin = campaign;
    for (Setup& setup : thin.setups) keep_rows(rows_of_unknowns(setup, thin.machine, of_passes), setup);
    if (unknowns_of(thin, model) == unknowns) return thin;
  }
  return campaign;
}

/// A surface is as large as the model states it; without coefficients as it starts.
void assume_identified(const Eigen::VectorXd& z, SmoothingTerm& term) {
  const auto size = term.precision().rows();
  const auto own = z.segment(term.offset, size);
  const double squares = own.dot(term.precision() * own);
  if (squares > 0.0) term.lambda = static_cast<double>(size) / squares;
}

}  // namespace

std::vector<SmoothingTerm> assumed_smoothing(const MeasurementModel& model, const DatumSpace& datum,
                                             const FunctionRoughnessGuess& guess) {
  std::vector<SmoothingTerm> terms = smoothing_terms(model, datum);
  const Eigen::VectorXd z = datum.reduced(model.initial_parameters());
  for (SmoothingTerm& term : terms) {
    if (!term.is_function()) {
      assume_identified(z, term);
      continue;
    }
    const auto& shapes = term.family->shapes();
    double nearest = std::numeric_limits<double>::infinity();
    const double travel = model.campaign().machine.axis(term.symbol.axis).travel();
    const double length = guess.length * travel / term.family->stretch_length();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (shapes[i]->roughness != Roughness::SquaredExponential) continue;
      const double miss = std::abs(std::log(shapes[i]->length / length));
      if (miss >= nearest) continue;
      nearest = miss;
      term.shape = i;
    }
    term.prior = shapes[term.shape];
    const double amplitude = is_rotation(term.symbol.component) ? guess.rotation : guess.displacement;
    term.lambda = 1.0 / (amplitude * amplitude);
  }
  return terms;
}

/// A campaign's model on the nominal machine.
struct PlanProblem::Linearised {
  MeasurementModel model;
  Eigen::VectorXd parameters;
  DatumSpace datum;

  Linearised(const Campaign& campaign, const ModelSpec& spec)
      : model(campaign, spec),
        parameters(model.initial_parameters()),
        datum(model.layout(), campaign.machine, parameters) {}

  Eigen::MatrixXd information(double factor, std::size_t first_setup) const {
    const ReadingIndex index(model);
    std::vector<double> weight = stated_sigma(index, parameters);
    for (double& each : weight) each = factor / (each * each);
    for (const std::size_t left_out : index.left_out()) weight[left_out] = 0.0;
    std::vector<bool> include(model.campaign().setups.size(), true);
    std::fill_n(include.begin(), first_setup, false);
    NormalAccumulator accumulator(index, weight, nullptr, 1);
    return datum.reduce_matrix(accumulator.accumulate(parameters, &include).matrix);
  }
  /// Reduced parameters behind the machine's: block and number.
  std::vector<std::string> names_behind(Eigen::Index machine_size) const {
    std::vector<std::string> names(static_cast<std::size_t>(datum.size() - machine_size));
    for (const auto& block : datum.blocks()) {
      if (block.offset < machine_size) continue;
      for (int k = 0; k < block.size; ++k) {
        names[static_cast<std::size_t>(block.offset - machine_size + k)] =
            model.layout().blocks[block.block].name + "/" + std::to_string(k);
      }
    }
    return names;
  }
};

PlanProblem::PlanProblem(const PlanSettings& settings) : settings_(settings), model_(search_model()) {
  use_single_threaded_blas();
  both_directions_ = !model_.effects.empty();
  if (settings.existing != nullptr) thin_ = thinned(*settings.existing, model_);
  learn_machine();
  if (settings.existing != nullptr) learn_existing();
}

/// With the errors of all rotary axes that readings move.
ModelSpec PlanProblem::search_model() const {
  std::vector<AxisName> moving;
  if (settings_.existing != nullptr) moving = moving_rotary_axes(*settings_.existing);
  if (plan_instrument_of(settings_).turns_rotary_axes()) {
    moving.clear();
    for (const RotaryStretch& each : rotary_stretches(settings_.machine)) moving.push_back(each.axis);
  }
  ModelSpec model = settings_.model;
  if (!moving.empty())
    model = with_rotary_errors(settings_.machine, model, moving, independent_locations(settings_.machine));
  model = with_few_knots(model, settings_.machine);
  for (const EffectSpec& effect : settings_.separate) model.effects.push_back(effect);
  return model;
}

/// What no setup changes, from a campaign of one reading a tool and station.
void PlanProblem::learn_machine() {
  PlanLayout probe;
  const LineOfSight sight(settings_);
  const std::vector<PlanPosition> grid =
      sight.instrument().turns_rotary_axes()
          ? rotary_grid(settings_.machine, kProbePositions, 0.0, 0, 0)
          : grid_over_travel(settings_.machine, Eigen::Vector3i::Constant(3), 0.0, 0, 0);
  for (int station = 0; station < settings_.budget.stations; ++station) {
    probe.stations_w.push_back(probe_place_w(sight));
    probe.station_names.push_back("P" + std::to_string(station + 1));
    for (const std::size_t tool : tools_of(settings_)) {
      probe.runs.push_back({static_cast<std::size_t>(station), tool, grid});
    }
  }
  const Campaign campaign = campaign_with_existing(probe);
  const Linearised at(campaign, model_);
  machine_size_ = at.datum.size();
  for (const auto& block : at.datum.blocks()) {
    if (!comes_from_setups(at.model.layout().blocks[block.block])) continue;
    machine_size_ = std::min<Eigen::Index>(machine_size_, block.offset);
  }
  GaussianPrior prior = wide_prior(at.model, at.datum, at.datum.reduced(at.parameters), {});
  add_smoothing(assumed_smoothing(at.model, at.datum, settings_.roughness), prior);
  prior.precision += stated_priors(at.model, at.datum).precision;
  machine_precision_ = prior.precision.topLeftCorner(machine_size_, machine_size_);
  const auto functionals = [&]() -> Eigen::MatrixXd {
    switch (settings_.target) {
      case PlanTarget::Volumetric:
        return volume_functionals(at);
      case PlanTarget::Worst:
        return table_functionals(at);
      case PlanTarget::Symbol:
        return symbol_functionals(at, settings_.symbol);
      case PlanTarget::Separate:
        return effect_functionals(at);
    }
    return {};
  }();
  const bool largest = settings_.target == PlanTarget::Worst || settings_.target == PlanTarget::Separate;
  criterion_ = std::make_unique<DesignCriterion>(functionals.leftCols(machine_size_),
                                                 largest ? Aggregate::Largest : Aggregate::Mean);
}

void PlanProblem::learn_existing() {
  const Linearised at(*settings_.existing, model_);
  existing_ = at.information(1.0, 0);
  existing_names_ = at.names_behind(machine_size_);
}

template <class Use>
void PlanProblem::for_each_volume_pose(const Use& use) const {
  const LineOfSight sight(settings_);
  const std::vector<Tool> tools = own_tools(settings_);
  std::vector<std::vector<AxisPosition>> poses;
  std::size_t most = 0;
  for (std::size_t tool = 0; tool < tools.size(); ++tool) {
    poses.push_back(sight.volume(tool, kVolumePerAxis));
    most = std::max(most, poses.back().size());
  }
  for (std::size_t i = 0; i < most; ++i) {
    for (std::size_t tool = 0; tool < tools.size(); ++tool) {
      if (i < poses[tool].size()) use(poses[tool][i], tools[tool]);
    }
  }
}

/// ex, ey, ez over the volume for every tool, divided so that their mean is that of e^2.
Eigen::MatrixXd PlanProblem::volume_functionals(const Linearised& at) const {
  std::vector<Eigen::MatrixXd> parts;
  for_each_volume_pose([&](const AxisPosition& position, const Tool& tool) {
    parts.emplace_back(at.datum.reduce_rows(
        pose_error_rows(at.model.chain(), at.model.layout(), position, tool.offset, position).topRows(3)));
  });
  Eigen::MatrixXd all(3 * static_cast<Eigen::Index>(parts.size()), at.datum.size());
  for (std::size_t i = 0; i < parts.size(); ++i)
    all.middleRows(3 * static_cast<Eigen::Index>(i), 3) = parts[i];
  return std::sqrt(3.0) * all;
}

Eigen::MatrixXd PlanProblem::symbol_functionals(const Linearised& at, const MachineError& error) const {
  const ParameterLayout& layout = at.model.layout();
  if (const auto motion = error.motion(); motion && layout.find(*motion)) {
    const auto place = *layout.find(*motion);
    const FunctionGroup& group = layout.groups[static_cast<std::size_t>(place.group)];
    const Axis& axis = settings_.machine.axis(motion->axis);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(kTablePositions, layout.size);
    for (int i = 0; i < kTablePositions; ++i) {
      const Eigen::VectorXd values =
          group.basis->row(axis.travel_min + axis.travel() * i / (kTablePositions - 1));
      for (int j = 0; j < group.basis->size(); ++j) rows(i, group.index(j, place.slot)) = values[j];
    }
    return at.datum.reduce_rows(rows);
  }
  if (const auto location = error.location()) {
    if (const ParameterBlock* block = layout.find_location(*location)) {
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, layout.size);
      row(0, block->offset) = 1.0;
      return at.datum.reduce_rows(row);
    }
  }
  throw InputError({}, "\"" + error.name() + "\" is not an error of this machine and model",
                   "name one such as EXX, EC0Y, or volumetric, worst, separate:KIND:TARGET,KIND:TARGET");
}

/// Every table value as the displacement that it causes: rotations times the root mean square of their lever
/// over the volume and the tools.
Eigen::MatrixXd PlanProblem::table_functionals(const Linearised& at) const {
  const ParameterLayout& layout = at.model.layout();
  const KinematicChain& chain = at.model.chain();
  std::vector<JointLever> levers(chain.joint_count());
  const auto lever_of = [&](AxisName axis, Component component, bool location) {
    double squares = 0.0, count = 0.0;
    for_each_volume_pose([&](const AxisPosition& position, const Tool& tool) {
      chain.levers(position, tool.offset, levers.data());
      for (const JointLever& lever : levers) {
        if (lever.axis != axis) continue;
        squares += (location ? KinematicChain::location_lever_w(lever, component)
                             : KinematicChain::motion_lever_w(lever, component))
                       .squaredNorm();
        count += 1.0;
      }
    });
    return std::sqrt(squares / std::max(1.0, count));
  };
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index rows = 0;
  for (const ErrorSymbol symbol : layout.symbols()) {
    parts.emplace_back(symbol_functionals(at, symbol) * lever_of(symbol.axis, symbol.component, false));
    rows += parts.back().rows();
  }
  for (const ParameterBlock& block : layout.blocks) {
    if (!block.location) continue;
    parts.emplace_back(symbol_functionals(at, *block.location) *
                       lever_of(block.location->axis, block.location->component, true));
    rows += parts.back().rows();
  }
  Eigen::MatrixXd all(rows, at.datum.size());
  Eigen::Index row = 0;
  for (const Eigen::MatrixXd& part : parts) {
    all.middleRows(row, part.rows()) = part;
    row += part.rows();
  }
  return all;
}

/// Amplitudes of the two effects with both in the model, in units of what the even grid of the probe gives:
/// of one column each, 1 / variance is what is left of an effect after projection off the other
/// (criticism/projection/separation.h).
Eigen::MatrixXd PlanProblem::effect_functionals(const Linearised& at) const {
  const ParameterLayout& layout = at.model.layout();
  const Eigen::MatrixXd information = at.information(1.0, 0) + known(at);
  const auto factor = cholesky_lower(information);
  if (!factor) throw std::runtime_error("the precision of a plan is not positive definite");
  const Eigen::MatrixXd covariance = inverse_from_cholesky(*factor);
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t e = at.model.binding().effects.size() - settings_.separate.size();
       e < at.model.binding().effects.size(); ++e) {
    const EffectBinding& effect = at.model.binding().effects[e];
    for (int k = 0; k < effect.amplitude_count(); ++k) {
      const Eigen::VectorXd row =
          at.datum.reduce_rows(Eigen::RowVectorXd::Unit(layout.size, effect.first_parameter + k)).transpose();
      rows.emplace_back(row / std::sqrt(row.dot(covariance * row)));
    }
  }
  Eigen::MatrixXd all(static_cast<Eigen::Index>(rows.size()), at.datum.size());
  for (std::size_t i = 0; i < rows.size(); ++i) all.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return all;
}

/// Precision of everything without readings of the plan.
Eigen::MatrixXd PlanProblem::known(const Linearised& at) const {
  const Eigen::Index size = at.datum.size();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(size, size);
  precision.topLeftCorner(machine_size_, machine_size_) = machine_precision_;
  precision.diagonal().tail(size - machine_size_).setConstant(1.0 / (kWideNuisance * kWideNuisance));
  for (const auto& block : at.datum.blocks()) {
    if (block.offset < machine_size_) continue;
    const ParameterBlock& source = at.model.layout().blocks[block.block];
    for (int k = 0; k < block.size; ++k) {
      const double sigma = source.prior_sigma[k];
      if (sigma > 0.0) precision(block.offset + k, block.offset + k) = 1.0 / (sigma * sigma);
    }
  }
  if (existing_.size() == 0) return precision;
  const std::vector<std::string> names = at.names_behind(machine_size_);
  std::vector<Eigen::Index> place;
  for (Eigen::Index k = 0; k < machine_size_; ++k) place.push_back(k);
  for (const std::string& name : existing_names_) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) throw std::logic_error("plan: unknown " + name + " is in no planned campaign");
    place.push_back(machine_size_ + (found - names.begin()));
  }
  for (Eigen::Index i = 0; i < existing_.rows(); ++i) {
    for (Eigen::Index j = 0; j < existing_.cols(); ++j) {
      precision(place[static_cast<std::size_t>(i)], place[static_cast<std::size_t>(j)]) += existing_(i, j);
    }
  }
  return precision;
}

Campaign PlanProblem::campaign_with_existing(const PlanLayout& layout) const {
  PlanSettings settings = settings_;
  settings.progress = nullptr;
  settings.existing = settings_.existing == nullptr ? nullptr : &thin_;
  return campaign_of(layout, settings, both_directions_);
}

double PlanProblem::value(const PlanLayout& layout, std::size_t readings) const {
  const Campaign campaign = campaign_with_existing(layout);
  const Linearised at(campaign, model_);
  const double taken = static_cast<double>(layout.positions()) * (both_directions_ ? 2.0 : 1.0);
  const auto wanted = static_cast<double>(readings > 0 ? readings : layout.readings());
  const Eigen::MatrixXd information =
      at.information(wanted / std::max(1.0, taken), thin_.setups.size()) + known(at);
  return criterion_->value(information).value_or(std::numeric_limits<double>::infinity());
}

PlanProblem::Pool PlanProblem::pool_of(const PlanLayout& layout) const {
  const Campaign campaign = campaign_with_existing(layout);
  const Linearised at(campaign, model_);
  const std::vector<double> sigma = stated_sigma(ReadingIndex(at.model), at.parameters);
  const double repeats = both_directions_ ? 1.0 : 2.0;
  NoiseProblem linear;
  std::vector<ObservationPlace> places;
  std::vector<double> scale;
  Pool out;
  out.pool.first.push_back(0);
  std::size_t observation = 0, setup = 0;
  for (; setup < thin_.setups.size(); ++setup) {
    observation +=
        static_cast<std::size_t>(at.model.bound(setup).channels()) * campaign.setups[setup].readings.size();
  }
  for (; setup < campaign.setups.size(); ++setup) {
    const std::size_t rows = campaign.setups[setup].readings.size();
    const int channels = at.model.bound(setup).channels();
    const std::size_t positions = both_directions_ ? rows / 2 : rows;
    for (std::size_t i = 0; i < positions; ++i) {
      std::vector<std::size_t> own = {i};
      if (both_directions_) own.push_back(rows - 1 - i);
      for (const std::size_t row : own) {
        for (int channel = 0; channel < channels; ++channel) {
          places.push_back({setup, row, channel});
          scale.push_back(std::sqrt(repeats) / sigma[observation + row * static_cast<std::size_t>(channels) +
                                                     static_cast<std::size_t>(channel)]);
        }
      }
      out.pool.first.push_back(static_cast<Eigen::Index>(places.size()));
    }
    observation += rows * static_cast<std::size_t>(channels);
  }
  linearise(at.model, at.datum, at.parameters, places, linear);
  out.pool.rows =
      Eigen::Map<const Eigen::VectorXd>(scale.data(), static_cast<Eigen::Index>(scale.size())).asDiagonal() *
      linear.jacobian;
  out.base = known(at);
  return out;
}

}  // namespace volcal
