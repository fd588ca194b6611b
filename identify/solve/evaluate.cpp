#include "volcal/identify/solve/evaluate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/identify/solve/normals/stated_sigma.h"
#include "volcal/identify/solve/residuals.h"
#include "volcal/identify/solve/unknown_rotary_axes.h"
#include "volcal/identify/solve/verdict.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/measured_ends.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/campaign_binding.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kHeld = 1e-12;          // m or rad: the model's errors stay as they are
constexpr double kUnheldNuisance = 1.0;  // m or rad: far wider than anything a setup can be wrong by

bool is_frozen_with_the_model(const ParameterBlock& block) {
  return block.kind == ParameterKind::Location || block.kind == ParameterKind::Effect ||
         block.kind == ParameterKind::EffectShape || block.kind == ParameterKind::Expansion || block.is_held;
}

/// Model parameters' place in both the fit's and the evaluation's vectors (the same model gives the same
/// order).
std::vector<std::pair<int, int>> shared_parameters(const ParameterLayout& fitted,
                                                   const ParameterLayout& here) {
  std::vector<std::pair<int, int>> shared;
  for (const FunctionGroup& group : here.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const auto place = fitted.find(group.symbols[static_cast<std::size_t>(slot)]);
      if (!place) continue;
      const FunctionGroup& source = fitted.groups[static_cast<std::size_t>(place->group)];
      for (int j = 0; j < group.basis->size(); ++j) {
        shared.emplace_back(source.index(j, place->slot), group.index(j, slot));
      }
    }
  }
  for (const ParameterBlock& block : here.blocks) {
    const ParameterBlock* source = fitted.find_block(block.name);
    if (source == nullptr || !is_frozen_with_the_model(block)) continue;
    for (int k = 0; k < block.size(); ++k) shared.emplace_back(source->offset + k, block.offset + k);
  }
  return shared;
}

/// 1 / sigma^2; 0 of what the campaign leaves out.
std::vector<double> weights_of(const ReadingIndex& index, const std::vector<double>& sigma) {
  std::vector<double> weight(sigma.size());
  std::ranges::transform(sigma, weight.begin(), [](double each) { return 1.0 / (each * each); });
  for (const std::size_t observation : index.left_out()) weight[observation] = 0.0;
  return weight;
}

/// Parameters that the campaign finds anew.
DatumSpace nuisance_of(const ParameterLayout& layout, const Machine& machine,
                       const Eigen::VectorXd& parameters) {
  return {layout, machine, parameters, [](ErrorSymbol) { return false; },
          [](const ParameterBlock& block) { return !is_frozen_with_the_model(block); }};
}

GaussianPrior prior_of_nuisance(const ParameterLayout& layout, const DatumSpace& nuisance,
                                const Eigen::VectorXd& z) {
  GaussianPrior prior = GaussianPrior::none(nuisance.size());
  for (const auto& block : nuisance.blocks()) {
    const ParameterBlock& source = layout.blocks[block.block];
    for (int k = 0; k < block.size; ++k) {
      const double held = source.prior_sigma[k] > 0.0 ? source.prior_sigma[k] : kUnheldNuisance;
      prior.precision(block.offset + k, block.offset + k) = 1.0 / (held * held);
      prior.mean[block.offset + k] = source.prior_sigma[k] > 0.0 ? source.prior_mean[k] : z[block.offset + k];
    }
  }
  return prior;
}

/// A campaign with a frozen model at its nuisance parameters.
struct Prediction {
  const ReadingIndex& index;
  const DatumSpace& nuisance;
  const GaussianPrior& prior;
  const NormalEquations& sums;
  const Eigen::VectorXd& parameters;
};

/// Errors that are not known exactly, by their places among the parameters of a model.
struct OpenErrors {
  std::vector<int> place;
  Eigen::MatrixXd covariance;

  void add(const std::vector<int>& more, const Eigen::MatrixXd& own) {
    const auto before = covariance.rows();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(before + own.rows(), before + own.rows());
    all.topLeftCorner(before, before) = covariance;
    all.bottomRightCorner(own.rows(), own.rows()) = own;
    covariance = std::move(all);
    place.insert(place.end(), more.begin(), more.end());
  }
};

struct PredictionUncertainty {
  std::vector<double> readings;
  Eigen::MatrixXd nuisance;  ///< covariance of the reduced nuisance parameters
};

/// u of every prediction: the covariance of open errors, less what the re-estimated nuisance parameters
/// absorb. Beyond what was measured it is that of the functions there, not that of the value that is held.
PredictionUncertainty prediction_uncertainty(const Prediction& prediction, const OpenErrors& open) {
  const ReadingIndex& index = prediction.index;
  std::optional<MeasurementModel> unheld;
  if (ModelSpec spec = index.model().spec(); !spec.measured.empty()) {
    spec.measured.clear();
    unheld.emplace(index.model().campaign(), std::move(spec))
        .set_second_order_remainder(prediction.parameters);
  }
  const MeasurementModel& model = unheld ? *unheld : index.model();
  const DatumSpace& datum = prediction.nuisance;
  const Eigen::MatrixXd nuisance = datum.reduce_matrix(prediction.sums.matrix) + prediction.prior.precision;
  const Eigen::MatrixXd coupling =
      datum.reduce_rows(prediction.sums.matrix(open.place, Eigen::all)).transpose();
  const Eigen::MatrixXd absorbed =
      solve_positive_definite(nuisance, coupling);  // d nuisance / d model, sign taken below
  std::vector<double> u(index.observations());
  RowJacobian row;
  for (const auto& [setup, reading] : index.sorted()) {
    model.linearize(setup, reading, prediction.parameters, row);
    for (int channel = 0; channel < row.channels; ++channel) {
      const Eigen::VectorXd dense = dense_row(model.layout(), row, channel);
      Eigen::VectorXd effective = dense(open.place);
      effective -= absorbed.transpose() * datum.reduce_gradient(dense);
      u[index.first_observation(setup, reading) + static_cast<std::size_t>(channel)] =
          std::sqrt(std::max(0.0, effective.dot(open.covariance * effective)));
    }
  }
  return {std::move(u), absorbed * open.covariance * absorbed.transpose()};
}

/// Expansions of scales that the machine file calls uncertain and of which the model says nothing.
void add_stated_expansions(const FitResult& identified, const ParameterLayout& layout, OpenErrors& open) {
  for (const ParameterBlock& block : layout.blocks) {
    const bool is_open = block.kind == ParameterKind::Expansion && !block.is_held &&
                         identified.layout.find_block(block.name) == nullptr;
    if (is_open) open.add({block.offset}, Eigen::MatrixXd::Constant(1, 1, std::pow(block.prior_sigma[0], 2)));
  }
}

/// Those of an identified model.
OpenErrors identified_errors(const FitResult& identified, const ParameterLayout& layout) {
  OpenErrors open;
  std::vector<int> fitted;
  for (const auto& [source, target] : shared_parameters(identified.layout, layout)) {
    fitted.push_back(source);
    open.place.push_back(target);
  }
  open.covariance = covariance_of(identified, fitted);
  add_stated_expansions(identified, layout, open);
  return open;
}

/// The values of parameters in the layout of a model with more errors.
Eigen::VectorXd carried(const Eigen::VectorXd& parameters, const ParameterLayout& from,
                        const MeasurementModel& to) {
  Eigen::VectorXd values = to.initial_parameters();
  for (const ParameterBlock& block : from.blocks) {
    const ParameterBlock* place = to.layout().find_block(block.name);
    values.segment(place->offset, block.size()) = parameters.segment(block.offset, block.size());
  }
  for (const auto& [source, target] : shared_parameters(from, to.layout()))
    values[target] = parameters[source];
  return values;
}

/// u of every prediction with what rotary axes may do that move here and of which the model has no errors.
PredictionUncertainty uncertainty_with_unknown_axes(const Prediction& known,
                                                    const std::vector<AxisName>& unknown,
                                                    const FitResult& identified,
                                                    const std::vector<double>& sigma,
                                                    const std::vector<double>& weight, int threads) {
  const MeasurementModel& without = known.index.model();
  const Campaign& campaign = without.campaign();
  MeasurementModel model(campaign, with_unknown_errors(campaign, without.spec(), unknown));
  const ParameterLayout& layout = model.layout();
  const Eigen::VectorXd parameters = carried(known.parameters, without.layout(), model);
  model.set_second_order_remainder(parameters);
  const ReadingIndex index(model);
  const DatumSpace nuisance = nuisance_of(layout, campaign.machine, parameters);
  const GaussianPrior prior = prior_of_nuisance(layout, nuisance, nuisance.reduced(parameters));
  const NormalEquations sums = NormalAccumulator(index, weight, nullptr, threads).accumulate(parameters);
  OpenErrors open = identified_errors(identified, layout);
  const Eigen::MatrixXd wide = covariance_of_unknown_errors(model, unknown, parameters, sigma);
  std::vector<int> place;
  for (int k = 0; k < layout.size; ++k) {
    if (wide(k, k) > 0.0) place.push_back(k);
  }
  open.add(place, wide(place, place));
  return prediction_uncertainty({index, nuisance, prior, sums, parameters}, open);
}

/// With the model's errors held.
std::shared_ptr<const Adjustment> adjustment_of(const MeasurementModel& model, const Machine& machine,
                                                const Eigen::VectorXd& parameters,
                                                const GaussianPrior& of_nuisance, const DatumSpace& nuisance,
                                                const std::vector<double>& sigma) {
  const DatumSpace all(model.layout(), machine, parameters);
  GaussianPrior prior = GaussianPrior::none(all.size());
  prior.mean = all.reduced(parameters);
  prior.precision.diagonal().setConstant(1.0 / (kHeld * kHeld));
  for (const auto& block : nuisance.blocks()) {
    const auto own = std::ranges::find(all.blocks(), block.block, &DatumSpace::BlockCoordinates::block);
    prior.precision.diagonal().segment(own->offset, own->size) =
        of_nuisance.precision.diagonal().segment(block.offset, block.size);
    prior.mean.segment(own->offset, own->size) = of_nuisance.mean.segment(block.offset, block.size);
  }
  const Eigen::VectorXd reduced = all.reduced(parameters);
  return std::make_shared<const Adjustment>(Adjustment{model.spec(), reduced, std::move(prior), {}, sigma});
}

}  // namespace

ModelSpec nominal_model() {
  ModelSpec model;
  model.default_function.basis = "zero";
  return model;
}

ModelSpec frozen_model(const ModelSpec& model) {
  ModelSpec frozen = model;
  frozen.default_function = {};
  frozen.default_function.basis = "zero";
  std::erase_if(frozen.functions, [](const auto& entry) { return entry.second.coefficients.empty(); });
  return frozen;
}

std::vector<Finding> missing_rotary_errors(const Campaign& campaign, const ModelSpec& model) {
  std::vector<Finding> findings;
  for (const AxisName axis : rotary_axes_without_errors(campaign, model)) {
    findings.push_back({FindingCode::RotaryErrorsNotInModel, {{"axis", std::string(1, letter_of(axis))}}});
  }
  return findings;
}

std::vector<Finding> differing_compensations(const Campaign& campaign, const FitResult& identified) {
  Finding finding{FindingCode::CompensationsDiffer};
  if (names_compensations(campaign.active_compensations))
    finding.data["measured"] = campaign.active_compensations;
  if (names_compensations(identified.active_compensations))
    finding.data["identified"] = identified.active_compensations;
  if (finding.data.empty() || campaign.active_compensations == identified.active_compensations) return {};
  return {finding};
}

namespace {

/// Curves and surfaces that fade out at readings beyond those they were drawn from.
std::vector<Finding> faded_at_readings(const Campaign& campaign, const ModelSpec& model) {
  const auto is_surface = [&](const EffectSpec& spec) {
    return find_effect(spec.kind)->make(spec, model.file)->surface() != nullptr;
  };
  std::vector<Finding> findings;
  if (std::ranges::none_of(model.effects, is_surface)) return findings;
  const KinematicChain chain(campaign.machine);
  const CampaignBinding binding = bind_campaign(campaign, frozen_model(model), chain);
  const std::vector<SetupView> views = setup_views(campaign, binding, chain);
  for (const EffectSpec& spec : model.effects) {
    const std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, model.file);
    std::int64_t readings = 0;
    for (const SetupView& view : views) {
      const Eigen::MatrixXd faded = effect->faded_drivers(view);
      for (Eigen::Index row = 0; row < faded.rows(); ++row) readings += faded.row(row).isZero(0.0) ? 0 : 1;
    }
    if (readings == 0) continue;
    findings.push_back({FindingCode::ErrorsFadedBeyondReadings,
                        {{"effect", effect_label(*effect)}, {"readings", readings}}});
  }
  return findings;
}

}  // namespace

std::vector<Finding> held_beyond_measured(const Campaign& campaign, const ModelSpec& model) {
  std::vector<Finding> findings;
  for (const auto& [name, stated] : model.measured) {
    const Axis& axis = campaign.machine.axis(name);
    const MeasuredEnds ends = measured_ends(axis, model);
    const bool beyond = std::ranges::any_of(campaign.setups, [&](const Setup& setup) {
      return std::ranges::any_of(setup.readings.position[index_of(axis.name)],
                                 [&ends](double q) { return ends.is_beyond(q); });
    });
    if (!beyond) continue;
    const Unit unit = position_unit(name);
    const auto number = [&](double q) {
      return FindingNumber{q, std::string(unit.suffix), unit.si_per_unit};
    };
    findings.push_back({FindingCode::ErrorsHeldBeyondReadings,
                        {{"axis", std::string(1, letter_of(name))},
                         {"measured_from", number(ends.first)},
                         {"measured_to", number(ends.last)},
                         {"travel_from", number(axis.travel_min)},
                         {"travel_to", number(axis.travel_max)}}});
  }
  std::ranges::move(faded_at_readings(campaign, model), std::back_inserter(findings));
  return findings;
}

Evaluation evaluate_model(const Campaign& campaign, const ModelSpec& model_spec, const FitResult* identified,
                          int threads) {
  use_single_threaded_blas();
  threads = thread_count(threads);
  MeasurementModel model(campaign, frozen_model(model_spec));
  const ReadingIndex index(model);
  Eigen::VectorXd parameters = model.initial_parameters();
  std::vector<double> sigma = stated_sigma(index, parameters);
  std::vector<double> weight = weights_of(index, sigma);
  const DatumSpace datum = nuisance_of(model.layout(), campaign.machine, parameters);
  Eigen::VectorXd z = datum.reduced(parameters);
  const GaussianPrior prior = prior_of_nuisance(model.layout(), datum, z);
  MinimiseOptions options;
  options.threads = threads;
  model.set_second_order_remainder(parameters);
  minimise(index, weight, datum, prior, options, z);
  const bool angles = renew_sigma_of_angles(index, datum.raw(z), sigma);
  const bool lengths = renew_sigma_of_lengths(index, datum.raw(z), sigma);
  if (angles || lengths) {
    weight = weights_of(index, sigma);
    minimise(index, weight, datum, prior, options, z);
  }
  parameters = datum.raw(z);

  const NormalEquations sums = NormalAccumulator(index, weight, nullptr, threads).accumulate(parameters);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(model.layout().size, model.layout().size);
  if (const auto factor = cholesky_lower(datum.reduce_matrix(sums.matrix) + prior.precision)) {
    covariance = datum.expand_covariance(inverse_from_cholesky(*factor));
  }
  Evaluation evaluation;
  evaluation.residuals = residual_records(index, sigma, weight, parameters, covariance,
                                          outlier_critical_value(index.observations(), 0.05), threads);
  evaluation.setups = setup_summaries(campaign, evaluation.residuals, sigma);
  for (const SetupSummary& setup : evaluation.setups) {
    evaluation.chi2 += setup.chi2;
    evaluation.dof += setup.redundancy;
  }
  evaluation.layout = model.layout();
  evaluation.parameters = parameters;
  evaluation.adjustment = adjustment_of(model, campaign.machine, parameters, prior, datum, sigma);
  evaluation.model_u.assign(index.observations(), 0.0);
  if (identified == nullptr) return evaluation;
  const Prediction prediction{index, datum, prior, sums, parameters};
  const std::vector<AxisName> unknown = rotary_axes_without_errors(campaign, model.spec());
  PredictionUncertainty u =
      unknown.empty()
          ? prediction_uncertainty(prediction, identified_errors(*identified, model.layout()))
          : uncertainty_with_unknown_axes(prediction, unknown, *identified, sigma, weight, threads);
  evaluation.model_u = std::move(u.readings);
  evaluation.parameters_u = datum.expand_covariance(u.nuisance).diagonal().cwiseMax(0.0).cwiseSqrt();
  return evaluation;
}

FitResult as_fitted(const Evaluation& evaluation, const FitResult& identified) {
  FitResult result;
  result.machine = identified.machine;
  result.identified = identified.identified;
  result.layout = evaluation.layout;
  result.parameters = evaluation.parameters;
  result.setups = evaluation.setups;
  result.residuals = evaluation.residuals;
  result.chi2 = evaluation.chi2;
  result.dof = evaluation.dof;
  result.variance_components = identified.variance_components;
  result.noise = identified.noise;
  result.adjustment = evaluation.adjustment;
  return result;
}

ErrorSizes error_sizes(const Campaign& campaign, const std::vector<ResidualRecord>& records) {
  const std::vector<std::vector<bool>> angles = angle_channels(campaign);
  const auto is_angle = [&](const ResidualRecord& record) {
    return angles[record.setup][static_cast<std::size_t>(record.channel)];
  };
  ErrorSizes sizes;
  for (std::size_t i = 0; i < records.size();) {
    double squares = 0.0;
    bool counts = false;
    const ResidualRecord& first = records[i];
    const bool angle = is_angle(first);
    do {
      if (!records[i].left_out) {
        squares += records[i].residual() * records[i].residual();
        counts = true;
      }
      ++i;
    } while (i < records.size() && records[i].setup == first.setup && records[i].row == first.row &&
             is_angle(records[i]) == angle);
    if (!counts) continue;
    ErrorSize& size = angle ? sizes.angles : sizes.lengths;
    size.rms += squares;
    size.max = std::max(size.max, std::sqrt(squares));
    ++size.count;
  }
  for (ErrorSize* size : {&sizes.lengths, &sizes.angles}) {
    if (size->count > 0) size->rms = std::sqrt(size->rms / static_cast<double>(size->count));
  }
  return sizes;
}

namespace {

std::vector<Finding> contradicted_nuisance(const Evaluation& evaluation) {
  std::vector<ParameterBlock> blocks = evaluation.layout.blocks;
  std::erase_if(blocks, is_frozen_with_the_model);
  return contradicted_priors(blocks, evaluation.parameters, evaluation.parameters_u);
}

}  // namespace

Validation validate(const Campaign& campaign, const FitResult& result, int threads) {
  Validation validation;
  validation.before = evaluate_model(campaign, nominal_model(), nullptr, threads);
  const ModelSpec model = model_of_result(result);
  const bool is_exact =
      result.covariance.isZero(0.0) && rotary_axes_without_errors(campaign, frozen_model(model)).empty();
  validation.after = evaluate_model(campaign, model, is_exact ? nullptr : &result, threads);
  validation.contradicted = contradicted_nuisance(validation.after);
  ValidationFigures& figures = validation.figures;
  const ErrorSizes before = error_sizes(campaign, validation.before.residuals);
  const ErrorSizes after = error_sizes(campaign, validation.after.residuals);
  figures.rms_before = before.lengths.rms;
  figures.rms_after = after.lengths.rms;
  figures.max_before = before.lengths.max;
  figures.max_after = after.lengths.max;
  figures.angle_rms_before = before.angles.rms;
  figures.angle_rms_after = after.angles.rms;
  figures.angle_max_before = before.angles.max;
  figures.angle_max_after = after.angles.max;
  figures.lengths = after.lengths.count;
  figures.angles = after.angles.count;
  std::size_t inside = 0, judged = 0;
  double chi2 = 0.0;
  for (std::size_t i = 0; i < validation.after.residuals.size(); ++i) {
    const ResidualRecord& record = validation.after.residuals[i];
    if (record.left_out) continue;
    ++judged;
    const double variance = record.sigma * record.sigma + std::pow(validation.after.model_u[i], 2);
    const double square = record.residual() * record.residual() / variance;
    chi2 += square;
    if (square <= kCoverageFactor * kCoverageFactor) ++inside;
  }
  figures.reduced_chi2 = chi2 / std::max(1.0, validation.after.dof);
  figures.coverage95 = static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(1, judged));
  return validation;
}

}  // namespace volcal
