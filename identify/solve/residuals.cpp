#include "volcal/identify/solve/residuals.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

/// Indices and values of one observation's derivatives.
struct SparseRow {
  std::vector<int> index;
  std::vector<double> value;
};

void gather(const ParameterLayout& layout, const RowJacobian& row, int channel, SparseRow& out) {
  out.index.clear();
  out.value.clear();
  for_each_derivative(layout, row, channel, [&](int parameter, double derivative) {
    out.index.push_back(parameter);
    out.value.push_back(derivative);
  });
}

/// a^T C a over the active parameters only.
double variance_of(const SparseRow& row, const Eigen::MatrixXd& covariance) {
  double sum = 0.0;
  const std::size_t n = row.index.size();
  for (std::size_t j = 0; j < n; ++j) {
    const double* column = &covariance(0, row.index[j]);
    double part = 0.0;
    for (std::size_t i = 0; i < n; ++i) part += column[row.index[i]] * row.value[i];
    sum += part * row.value[j];
  }
  return sum;
}

}  // namespace

double outlier_critical_value(std::size_t observations, double risk) {
  const double single =
      1.0 - std::pow(1.0 - risk, 1.0 / static_cast<double>(std::max<std::size_t>(observations, 1)));
  return normal_quantile(1.0 - 0.5 * single);
}

std::vector<ResidualRecord> residual_records(const ReadingIndex& index, const std::vector<double>& sigma,
                                             const std::vector<double>& weight,
                                             const Eigen::VectorXd& parameters,
                                             const Eigen::MatrixXd& covariance, double critical_value,
                                             int threads) {
  const MeasurementModel& model = index.model();
  const auto& setups = model.campaign().setups;
  std::vector<ResidualRecord> records(index.observations());
  const auto work = [&](std::size_t begin, std::size_t end) {
    RowJacobian row;
    SparseRow sparse;
    for (std::size_t i = begin; i < end; ++i) {
      const auto [setup, reading] = index.sorted()[i];
      const Readings& readings = setups[setup].readings;
      model.linearize(setup, reading, parameters, row);
      for (int channel = 0; channel < row.channels; ++channel) {
        const std::size_t observation =
            index.first_observation(setup, reading) + static_cast<std::size_t>(channel);
        ResidualRecord& record = records[observation];
        record.setup = setup;
        record.row = reading;
        record.channel = channel;
        record.source_line = readings.source_line[reading];
        record.reading = readings.value[static_cast<std::size_t>(channel)][reading];
        record.predicted = row.predicted[channel];
        record.sigma = sigma[observation];
        record.removed = weight[observation] == 0.0;
        record.redundancy = 1.0;
        if (covariance.size() > 0) {
          gather(model.layout(), row, channel, sparse);
          const double share = variance_of(sparse, covariance) / (record.sigma * record.sigma);
          // A removed reading is judged by a fit that did not see it: variances add instead of subtract.
          record.redundancy = record.removed ? 1.0 + share : std::clamp(1.0 - share, 0.0, 1.0);
        }
        if (record.redundancy > 1e-6)
          record.w = record.residual() / (record.sigma * std::sqrt(record.redundancy));
        record.flagged = std::abs(record.w) > critical_value;
      }
    }
  };
  const std::size_t readings = index.sorted().size();
  const auto parts = static_cast<std::size_t>(std::max(1, threads));
  run_parallel(parts, threads,
               [&](std::size_t part) { work(readings * part / parts, readings * (part + 1) / parts); });
  for (const std::size_t observation : index.left_out()) records[observation].left_out = true;
  return records;
}

std::vector<std::size_t> worst_outliers(const std::vector<ResidualRecord>& records, double nearly,
                                        double most) {
  struct Own {
    double largest = 0.0;
    double observations = 0.0;
    double removed = 0.0;
  };
  std::map<std::size_t, Own> setups;
  const auto in_question = [](const ResidualRecord& record) { return record.flagged && !record.removed; };
  for (const ResidualRecord& record : records) {
    Own& setup = setups[record.setup];
    setup.observations += 1.0;
    setup.removed += record.removed && !record.left_out ? 1.0 : 0.0;
    if (in_question(record)) setup.largest = std::max(setup.largest, std::abs(record.w));
  }
  std::vector<std::size_t> worst;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Own& setup = setups[records[i].setup];
    if (!in_question(records[i]) || setup.removed > most * setup.observations) continue;
    if (std::abs(records[i].w) >= nearly * setup.largest) worst.push_back(i);
  }
  return worst;
}

std::vector<SetupSummary> setup_summaries(const Campaign& campaign,
                                          const std::vector<ResidualRecord>& records,
                                          const std::vector<double>& stated_sigma) {
  const std::vector<std::vector<bool>> is_angle = angle_channels(campaign);
  std::vector<SetupSummary> summaries(campaign.setups.size());
  std::vector<std::size_t> averaged(campaign.setups.size(), 0);
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    summaries[i].name = setup.name;
    summaries[i].instrument = setup.instrument;
    summaries[i].tool = campaign.machine.tools[setup.tool].name;
    summaries[i].reading_unit = residual_unit(setup, 0);
  }
  for (std::size_t i = 0; i < records.size(); ++i) {
    const ResidualRecord& record = records[i];
    if (record.removed) continue;
    SetupSummary& summary = summaries[record.setup];
    const double residual = record.residual();
    ++summary.observations;
    summary.chi2 += residual * residual / (stated_sigma[i] * stated_sigma[i]);
    summary.redundancy += record.redundancy;
    const std::vector<bool>& of_setup = is_angle[record.setup];
    if (of_setup[static_cast<std::size_t>(record.channel)] != of_setup[0]) continue;
    ++averaged[record.setup];
    summary.rms_residual += residual * residual;
    summary.max_residual = std::max(summary.max_residual, std::abs(residual));
  }
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    if (averaged[i] > 0)
      summaries[i].rms_residual = std::sqrt(summaries[i].rms_residual / static_cast<double>(averaged[i]));
  }
  return summaries;
}

}  // namespace volcal
