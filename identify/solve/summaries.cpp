#include "volcal/identify/solve/summaries.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/scale_expansions.h"
#include "volcal/model/functions/registry.h"

namespace volcal {

namespace {

constexpr double kMostOfATurn = 0.75 * 2.0 * std::numbers::pi;

/// Of positions with readings. What is periodic and was measured over most of a turn is known everywhere.
MeasuredRange known_range(const Campaign& campaign, AxisName name, const FunctionSpec& function) {
  const MeasuredRange range = measured_range(campaign, name);
  const Axis& axis = campaign.machine.axis(name);
  const bool is_periodic = find_basis(function.basis)->is_periodic;
  if (!is_periodic || range.max - range.min < kMostOfATurn) return range;
  return {std::min(range.min, axis.travel_min), std::max(range.max, axis.travel_max)};
}

}  // namespace

std::vector<FunctionSummary> function_summaries(const Campaign& campaign, const ModelSpec& spec,
                                                const DatumSpace& datum,
                                                const std::vector<SmoothingTerm>& terms,
                                                const Eigen::MatrixXd& covariance) {
  std::vector<FunctionSummary> summaries;
  for (const auto& function : datum.functions()) {
    FunctionSummary summary;
    summary.symbol = function.symbol;
    const FunctionSpec& function_spec = spec.function(function.symbol);
    summary.intervals = std::max(0, static_cast<int>(function_spec.breakpoints.size()) - 1);
    summary.effective_parameters = function.size();
    for (const SmoothingTerm& term : terms) {
      if (!term.is_function() || term.symbol != function.symbol) continue;
      summary.smoothed = true;
      summary.prior = to_string(term.prior->roughness);
      summary.correlation_length = term.prior->correlation_length() * term.family->stretch_length();
      const auto n = term.precision().rows();
      summary.effective_parameters -=
          term.lambda * covariance.block(term.offset, term.offset, n, n).cwiseProduct(term.precision()).sum();
    }
    const MeasuredRange range = known_range(campaign, function.symbol.axis, function_spec);
    summary.measured_min = range.min;
    summary.measured_max = range.max;
    summaries.push_back(summary);
  }
  return summaries;
}

double mean_uncertainty(const Campaign& campaign, const FitResult& result, const MachineError& error) {
  const auto symbol = error.motion();
  if (!symbol) {
    const int offset = result.layout.find_block(error)->offset;
    return std::sqrt(result.covariance(offset, offset));
  }
  constexpr int kPlaces = 33;
  const auto place = *result.layout.find(*symbol);
  const FunctionGroup& group = result.layout.groups[static_cast<std::size_t>(place.group)];
  const MeasuredRange range = measured_range(campaign, symbol->axis);
  std::vector<int> raw;
  raw.reserve(static_cast<std::size_t>(group.basis->size()));
  for (int j = 0; j < group.basis->size(); ++j) raw.push_back(group.index(j, place.slot));
  const Eigen::MatrixXd covariance = result.covariance(raw, raw);
  double sum = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    const Eigen::VectorXd row =
        group.basis->row(range.min + (range.max - range.min) * static_cast<double>(i) / (kPlaces - 1));
    sum += row.dot(covariance * row);
  }
  return std::sqrt(sum / kPlaces);
}

void complete_observability(const Campaign& campaign, FitResult& result) {
  for (Observability& figure : result.rank.errors) {
    if (!figure.symbol.motion()) figure.effective_parameters = 1.0;
    for (FunctionSummary& function : result.functions) {
      if (figure.symbol != function.symbol) continue;
      // The smoothing of what is not visible is set aside, and nothing says what the readings carry of it.
      if (!figure.visible) function.effective_parameters = std::nan("");
      figure.effective_parameters = function.effective_parameters;
    }
    if (!figure.visible) figure.effective_parameters = std::nan("");
    if (figure.visible) figure.u_rms = mean_uncertainty(campaign, result, figure.symbol);
  }
}

ModelSpec identified_model(const ModelSpec& spec, const Machine& machine, const ParameterLayout& layout,
                           const Eigen::VectorXd& parameters) {
  ModelSpec identified = spec;
  identified.file.clear();
  for (const ErrorSymbol symbol : layout.symbols()) {
    FunctionSpec& function = identified.functions[symbol];
    function.smoothed = function.automatic_degree ||
                        (function.knots == KnotChoice::Automatic && find_basis(function.basis)->uses_knots);
    function.knots = KnotChoice::Explicit;
    function.automatic_degree = false;
    const Eigen::VectorXd coefficients = layout.coefficients(symbol, parameters);
    function.coefficients.assign(coefficients.begin(), coefficients.end());
  }
  for (const ParameterBlock& block : layout.blocks) {
    if (block.location) identified.locations[*block.location] = parameters[block.offset];
  }
  for (const Axis& axis : machine.axes) {
    const ParameterBlock* block = layout.find_block(expansion_parameter(axis.name));
    if (axis.expansion && block != nullptr)
      identified.expansions[axis.name] = axis.expansion->per_kelvin + parameters[block->offset];
  }
  for (EffectSpec& effect : identified.effects) {
    const auto made = find_effect(effect.kind)->make(effect, spec.file);
    for (const EffectAmplitude& amplitude : made->amplitudes()) {
      if (const auto place = layout.find_parameter(amplitude.label))
        amplitude.keep(parameters[*place], effect.options);
    }
    for (const EffectShape& shape : made->shapes()) {
      if (const auto place = layout.find_parameter(shape.label))
        effect.options.set(std::string(stem_of_key(shape.key)), parameters[*place]);
    }
  }
  return identified;
}

namespace {

/// Range and mean of values that come column by column.
class RangeOfColumns {
 public:
  void add(const std::vector<double>& column) {
    for (const double value : column) {
      min_ = std::min(min_, value);
      max_ = std::max(max_, value);
      sum_ += value;
    }
    count_ += column.size();
  }
  std::optional<RecordedRange> range() const {
    if (count_ == 0) return std::nullopt;
    return RecordedRange{min_, sum_ / static_cast<double>(count_), max_};
  }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace

RecordedConditions recorded_conditions(const Campaign& campaign) {
  RangeOfColumns time, feed;
  std::map<std::string, RangeOfColumns> temperature;
  for (const Setup& setup : campaign.setups) {
    time.add(setup.readings.time);
    feed.add(setup.readings.feed);
    for (const auto& [channel, values] : setup.readings.temperature) temperature[channel].add(values);
  }
  RecordedConditions conditions;
  conditions.time = time.range();
  conditions.feed = feed.range();
  for (const auto& [channel, columns] : temperature) {
    if (const auto range = columns.range()) conditions.temperature_degC[channel] = *range;
  }
  return conditions;
}

void summarise_temperature(const Campaign& campaign, FitResult& result) {
  if (!expansion_channels(campaign.machine, result.identified).empty()) return;
  double sum = 0.0;
  std::size_t count = 0;
  for (const Setup& setup : campaign.setups) {
    for (const auto& [channel, values] : setup.readings.temperature) {
      for (const double value : values) sum += value;
      count += values.size();
    }
  }
  result.temperature_is_campaign_mean = true;
  result.reference_temperature_degC = count > 0 ? sum / static_cast<double>(count) : std::nan("");
}

std::vector<VarianceComponent> variance_components(
    const std::vector<std::string>& groups, const std::vector<double>& scale,
    const std::vector<ResidualRecord>& records,
    const std::vector<std::vector<std::size_t>>& group_of_channel) {
  std::vector<VarianceComponent> components;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    components.emplace_back().instrument = groups[g];
    components.back().scale = scale[g];
  }
  for (const ResidualRecord& record : records) {
    if (record.removed) continue;
    VarianceComponent& own =
        components[group_of_channel[record.setup][static_cast<std::size_t>(record.channel)]];
    own.redundancy += record.redundancy;
    ++own.observations;
  }
  for (VarianceComponent& component : components) {
    component.scale_u =
        component.redundancy > 0.0 ? component.scale / std::sqrt(2.0 * component.redundancy) : 0.0;
  }
  return components;
}

void add_white_squares(const std::vector<ResidualRecord>& records, NoiseSummary& noise) {
  for (const ResidualRecord& record : records) {
    if (record.removed) continue;
    noise.chi2 += std::pow(record.residual() / record.sigma, 2);
    noise.dof += record.redundancy;
  }
}

}  // namespace volcal
