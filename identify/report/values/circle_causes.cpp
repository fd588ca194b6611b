#include "volcal/identify/report/values/circle_causes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/statistics/even_sample.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

constexpr std::size_t kMostReadings = 720;  // per circle: more say no more of a smooth curve
constexpr double kNothing = 1e-12;          // m

/// Parameters of one cause, here and in the identified result.
struct CauseParameters {
  std::string name;
  std::vector<int> here;
  std::vector<int> fitted;
};

bool is_of_the_machine(const ParameterBlock& block) {
  return block.kind == ParameterKind::Location || block.kind == ParameterKind::Effect ||
         block.kind == ParameterKind::Expansion;
}

std::vector<CauseParameters> causes_of(const ParameterLayout& layout, const FitResult* identified) {
  std::vector<CauseParameters> causes;
  for (const FunctionGroup& group : layout.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
      CauseParameters& cause = causes.emplace_back();
      cause.name = symbol.name();
      const auto place = identified == nullptr ? std::nullopt : identified->layout.find(symbol);
      for (int j = 0; j < group.basis->size(); ++j) {
        cause.here.push_back(group.index(j, slot));
        if (!place) continue;
        const FunctionGroup& source = identified->layout.groups[static_cast<std::size_t>(place->group)];
        cause.fitted.push_back(source.index(j, place->slot));
      }
    }
  }
  for (const ParameterBlock& block : layout.blocks) {
    if (!is_of_the_machine(block)) continue;
    CauseParameters& cause = causes.emplace_back();
    cause.name = block.name;
    const ParameterBlock* source =
        identified == nullptr ? nullptr : identified->layout.find_block(block.name);
    for (int k = 0; k < block.size(); ++k) {
      cause.here.push_back(block.offset + k);
      if (source != nullptr) cause.fitted.push_back(source->offset + k);
    }
  }
  return causes;
}

/// Orthonormal columns that span 1, cos and sin of the angle.
Eigen::MatrixXd circle_columns(const std::vector<CircleReading>& readings,
                               const std::vector<std::size_t>& places) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double angle = readings[places[i]].angle;
    columns.row(static_cast<Eigen::Index>(i)) << 1.0, std::cos(angle), std::sin(angle);
  }
  for (Eigen::Index c = 0; c < 3; ++c) {
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index d = 0; d < c; ++d)
        columns.col(c) -= columns.col(d).dot(columns.col(c)) * columns.col(d);
    }
    const double norm = columns.col(c).norm();
    columns.col(c) *= norm > 1e-9 ? 1.0 / norm : 0.0;
  }
  return columns;
}

/// Derivatives of the radius to every parameter, without what a circle takes up.
Eigen::MatrixXd radius_rows(const MeasurementModel& model, const Eigen::VectorXd& parameters,
                            const CircleTest& circle, const std::vector<std::size_t>& places) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(places.size()), model.layout().size);
  const std::vector<double>& length = model.campaign().setups[circle.setup_index].readings.value[0];
  RowJacobian row;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t reading = circle.rows[places[i]];
    model.linearize(circle.setup_index, reading, parameters, row);
    rows.row(static_cast<Eigen::Index>(i)) =
        length[reading] / circle.radius * dense_row(model.layout(), row, 0).transpose();
  }
  const Eigen::MatrixXd columns = circle_columns(circle.radial.readings, places);
  return rows - columns * (columns.transpose() * rows);
}

std::vector<CircleCause> causes_of_circle(const Eigen::MatrixXd& rows, const Eigen::VectorXd& parameters,
                                          const std::vector<CauseParameters>& causes,
                                          const FitResult* identified) {
  const auto count = static_cast<double>(rows.rows());
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(rows.rows());
  std::vector<std::pair<CircleCause, Eigen::VectorXd>> parts;
  for (const CauseParameters& cause : causes) {
    const Eigen::MatrixXd own = rows(Eigen::all, cause.here);
    const Eigen::VectorXd values = own * parameters(cause.here);
    whole += values;
    Eigen::Index high = 0, low = 0;
    CircleCause part;
    part.name = cause.name;
    part.range = values.maxCoeff(&high) - values.minCoeff(&low);
    part.rms = std::sqrt(values.squaredNorm() / count);
    if (part.range < kNothing) continue;
    if (identified != nullptr && cause.fitted.size() == cause.here.size()) {
      const Eigen::VectorXd between = own.row(high) - own.row(low);
      const Eigen::MatrixXd covariance = covariance_of(*identified, cause.fitted);
      part.range_u = std::sqrt(std::max(0.0, between.dot(covariance * between)));
    }
    parts.emplace_back(std::move(part), values);
  }
  std::vector<CircleCause> result;
  const double square = whole.squaredNorm();
  for (auto& [part, values] : parts) {
    part.share = square > 0.0 ? values.dot(whole) / square : 0.0;
    result.push_back(std::move(part));
  }
  std::ranges::stable_sort(result, std::greater<>(),
                           [](const CircleCause& cause) { return std::abs(cause.share); });
  return result;
}

}  // namespace

std::vector<std::vector<CircleCause>> circle_causes(const Campaign& campaign, const ModelSpec& model,
                                                    const Eigen::VectorXd& parameters,
                                                    const FitResult* identified,
                                                    std::span<const CircleTest> circles) {
  std::vector<std::vector<CircleCause>> all;
  if (circles.empty()) return all;
  MeasurementModel measurement(campaign, frozen_model(model));
  measurement.expand_effects(parameters);
  const std::vector<CauseParameters> causes = causes_of(measurement.layout(), identified);
  for (const CircleTest& circle : circles) {
    const std::vector<std::size_t> places = even_sample(circle.rows.size(), kMostReadings);
    if (places.empty()) {
      all.emplace_back();
      continue;
    }
    all.push_back(causes_of_circle(radius_rows(measurement, parameters, circle, places), parameters, causes,
                                   identified));
  }
  return all;
}

}  // namespace volcal
