#include "volcal/identify/criticism/generic_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "volcal/identify/criticism/score_test.h"
#include "volcal/identify/stats/chi_squared.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr int kSingleWaves = 10;
constexpr int kPairWaves = 4;
constexpr int kDirections = 4;

using Columns = std::vector<Eigen::VectorXd>;

Columns powers(const ScanVariable& a) {
  if (a.two_valued) return {a.value};
  return {a.value, a.value.array().square(), a.value.array().cube()};
}

Columns products(const ScanVariable& a, const ScanVariable& b) {
  Columns columns = {a.value.cwiseProduct(b.value)};
  if (!a.two_valued) columns.emplace_back(columns[0].cwiseProduct(a.value));
  if (!b.two_valued) columns.emplace_back(columns[0].cwiseProduct(b.value));
  return columns;
}

/// cos(k pi (v + 1) / 2) / k: a Brownian-like prior, rough enough for kinks.
Columns waves(const ScanVariable& a, int count) {
  if (a.two_valued) return {a.value};
  Columns columns;
  for (int k = 1; k <= count; ++k) {
    columns.emplace_back(((a.value.array() + 1.0) * (0.5 * k * std::numbers::pi)).cos() / k);
  }
  return columns;
}

Columns wave_products(const ScanVariable& a, const ScanVariable& b) {
  Columns columns;
  const Columns of_b = waves(b, kPairWaves);
  for (const Eigen::VectorXd& left : waves(a, kPairWaves)) {
    for (const Eigen::VectorXd& right : of_b) columns.emplace_back(left.cwiseProduct(right));
  }
  return columns;
}

void add_variable(std::vector<ScanVariable>& variables, const std::string& name, Eigen::VectorXd value) {
  const double low = value.minCoeff(), high = value.maxCoeff();
  if (!(high - low > 1e-9 * std::max(1.0, std::abs(high)))) return;
  value = ((value.array() - low) * (2.0 / (high - low)) - 1.0).matrix();
  const bool two_valued = (value.array().abs() > 1.0 - 1e-9).all();
  if (two_valued) value.array() -= value.mean();
  variables.push_back({name, std::move(value), two_valued});
}

class GenericScanner {
 public:
  GenericScanner(const LinearModel& model, const std::vector<ScanVariable>& variables,
                 const Projector& projector)
      : model_(model), variables_(variables), projector_(projector) {
    for (int k = 0; k < kDirections; ++k) direction_[k] = model.direction(k);
    log_count_ = std::log(static_cast<double>(projector.observations()));
  }

  std::vector<GenericTest> run() {
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      const ScanVariable& a = variables_[i];
      test({a.name}, powers(a), waves(a, kSingleWaves));
      for (std::size_t j = i + 1; j < variables_.size(); ++j) {
        const ScanVariable& b = variables_[j];
        if (exclude_each_other(a, b)) continue;
        test({a.name, b.name}, products(a, b), wave_products(a, b));
      }
    }
    return std::move(tests_);
  }

 private:
  /// Indicators of tools, and of stations, do not meet in one reading.
  static bool exclude_each_other(const ScanVariable& a, const ScanVariable& b) {
    const auto family = [](const std::string& name) { return name.substr(0, name.find(' ')); };
    return a.name.find(' ') != std::string::npos && family(a.name) == family(b.name);
  }

  void test(const std::vector<std::string>& names, const Columns& polynomials, const Columns& features) {
    const auto count = static_cast<Eigen::Index>(polynomials.size());
    const auto wide = static_cast<Eigen::Index>(features.size());
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(model_.size()), kDirections * (count + wide));
    for (int d = 0; d < kDirections; ++d) {
      Eigen::Index at = d * (count + wide);
      for (const Eigen::VectorXd& column : polynomials)
        columns.col(at++) = column.cwiseProduct(direction_[d]);
      for (const Eigen::VectorXd& column : features) columns.col(at++) = column.cwiseProduct(direction_[d]);
    }
    const ProjectedColumns projected = projector_.project(std::move(columns));
    for (int d = 0; d < kDirections; ++d) {
      const Eigen::Index at = d * (count + wide);
      add_polynomial(names, d, score_test(projected, at, count));
      add_kernel(names, d, projected, at + count, wide);
    }
  }

  /// The best fit's size follows from the test: LM = |g~ a|^2 in units of the noise.
  double explained_rms(double lm) const {
    return std::sqrt(std::max(0.0, lm) / static_cast<double>(projector_.observations())) * typical_sigma();
  }

  double typical_sigma() const {
    double sum = 0.0;
    std::size_t count = 0;
    for (const double sigma : model_.problem().data.sigma) {
      if (!std::isfinite(sigma)) continue;
      sum += sigma * sigma;
      ++count;
    }
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
  }

  void add_polynomial(const std::vector<std::string>& names, int direction, const ScoreTest& score) {
    tests_.push_back({names, kScanDirections[direction], false, score.log10_p, score.lm,
                      static_cast<double>(score.dof), score.lm - score.dof * log_count_,
                      explained_rms(score.lm)});
  }

  void add_kernel(const std::vector<std::string>& names, int direction, const ProjectedColumns& projected,
                  Eigen::Index first, Eigen::Index columns) {
    const Eigen::MatrixXd gram = projected.gram(first, columns);
    const double trace = gram.trace();
    const double floor = kInvisibleShare * projected.norm.segment(first, columns).squaredNorm();
    GenericTest test{names, kScanDirections[direction], true, 0.0, 0.0, 0.0, 0.0, 0.0};
    if (trace > floor) {
      const double squares = gram.squaredNorm();
      test.dof = trace * trace / squares;
      test.lm = projected.score.segment(first, columns).squaredNorm() * trace / squares;
      test.log10_p = log10_chi_squared_exceedance(test.lm, test.dof);
      test.rms = explained_rms(test.lm - test.dof);
    }
    tests_.push_back(test);
  }

  const LinearModel& model_;
  const std::vector<ScanVariable>& variables_;
  const Projector& projector_;
  Eigen::VectorXd direction_[kDirections];
  std::vector<GenericTest> tests_;
  double log_count_ = 0.0;
};

}  // namespace

std::vector<ScanVariable> scan_variables(const LinearModel& model) {
  const Campaign& campaign = model.campaign();
  std::vector<ScanVariable> variables;
  const auto over_observations = [&](const auto& of_reading) {
    Eigen::VectorXd value(static_cast<Eigen::Index>(model.size()));
    for (std::size_t i = 0; i < model.size(); ++i) {
      const auto& [setup, row, channel] = model.observations()[i];
      value[static_cast<Eigen::Index>(i)] = of_reading(campaign.setups[setup], setup, row);
    }
    return value;
  };
  const auto add = [&](const std::string& name, const auto& of_reading) {
    add_variable(variables, name, over_observations(of_reading));
  };
  for (const Axis& axis : campaign.machine.axes) {
    const std::size_t k = index_of(axis.name);
    const std::string letter(1, lower_letter_of(axis.name));
    add(letter,
        [k](const Setup& setup, std::size_t, std::size_t row) { return setup.readings.position[k][row]; });
    add("dir_" + letter, [k](const Setup& setup, std::size_t, std::size_t row) {
      const auto& direction = setup.readings.direction[k];
      return direction.empty() ? 0.0 : static_cast<double>(direction[row]);
    });
  }
  const double start = time_span(campaign).first;
  add("time", [start](const Setup& setup, std::size_t, std::size_t row) {
    return setup.readings.time.empty() ? start : setup.readings.time[row];
  });
  for (const std::string& channel : temperature_channels(campaign)) {
    add("T_" + channel, [&channel](const Setup& setup, std::size_t, std::size_t row) {
      const auto found = setup.readings.temperature.find(channel);
      return found == setup.readings.temperature.end() ? kEffectReferenceTemperature_degC
                                                       : found->second[row];
    });
  }
  add("length", [&model](const Setup&, std::size_t setup, std::size_t row) {
    return model.views()[setup].length[static_cast<Eigen::Index>(row)];
  });
  add("feed", [](const Setup& setup, std::size_t, std::size_t row) {
    return setup.readings.feed.empty() ? 0.0 : setup.readings.feed[row];
  });
  for (const std::string& tool : tools_in_use(campaign)) {
    add("tool " + tool, [&](const Setup& setup, std::size_t, std::size_t) {
      return campaign.machine.tools[setup.tool].name == tool ? 1.0 : 0.0;
    });
  }
  for (const std::string& station : station_names(campaign)) {
    add("station " + station, [&station](const Setup& setup, std::size_t, std::size_t) {
      return station_of(setup) == station ? 1.0 : 0.0;
    });
  }
  return variables;
}

std::vector<GenericTest> generic_scan(const LinearModel& model, const std::vector<ScanVariable>& variables,
                                      const Projector& projector) {
  return GenericScanner(model, variables, projector).run();
}

}  // namespace volcal
