#include "tests/io/report/synthetic_fit.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"
#include "volcal/model/functions/registry.h"

namespace volcal::test {
namespace {

constexpr int kIntervals = 8;

Axis linear_axis(AxisName name, double low, double high) {
  Axis axis;
  axis.name = name;
  axis.travel_min = low;
  axis.travel_max = high;
  axis.home = low;
  return axis;
}

Machine machine() {
  Machine m;
  m.name = "VMC 800 <x> 500 & 450";
  m.structure = Structure::parse("w X' Y' b Z t");
  m.axes = {linear_axis(AxisName::X, -0.4, 0.4), linear_axis(AxisName::Y, -0.25, 0.25),
            linear_axis(AxisName::Z, -0.45, 0.0)};
  m.tools = {{"short", {0.0, 0.0, -0.15}, 0.0}, {"side", {0.11, 0.015, -0.24}, 0.0}};
  return m;
}

Setup setup(const std::string& name, const std::string& instrument, std::size_t tool) {
  Setup s;
  s.name = name;
  s.instrument = instrument;
  s.tool = tool;
  return s;
}

void add_reading(Setup& s, double x, double y, double z, double time, int line) {
  Readings& r = s.readings;
  if (r.value.empty()) r.value.resize(1);
  const double position[] = {x, y, z};
  for (std::size_t k = 0; k < 3; ++k) r.position[k].push_back(position[k]);
  r.value[0].push_back(0.0);
  r.time.push_back(time);
  r.line.push_back(line);
  r.source_line.push_back(static_cast<std::int64_t>(r.source_line.size()) + 2);
}

Setup tracer(const std::string& name, const std::string& station, std::size_t tool, int readings,
             double start_time, std::mt19937_64& random) {
  Setup s = setup(name, "laser-tracer", tool);
  s.options.set("station", station);
  s.options.set("station", Eigen::Vector3d(-0.6, -0.35, -0.5));
  std::uniform_real_distribution<double> place(0.0, 1.0);
  for (int i = 0; i < readings; ++i) {
    add_reading(s, -0.4 + 0.8 * place(random), -0.25 + 0.42 * place(random), -0.45 + 0.45 * place(random),
                start_time + 6.0 * i, i / 20);
  }
  return s;
}

Setup circle(const std::string& name, double x, double y, double z, double start_time) {
  Setup s = setup(name, "ball-bar", 0);
  for (int i = 0; i < 180; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 180.0;
    add_reading(s, x + 0.15 * std::cos(angle), y + 0.15 * std::sin(angle), z, start_time + i, 0);
  }
  return s;
}

Setup diagonal(const std::string& name, double sign_y, double start_time) {
  Setup s = setup(name, "displacement", 0);
  for (int i = 0; i <= 20; ++i) {
    const double t = i / 20.0;
    add_reading(s, -0.4 + 0.8 * t, sign_y * (-0.25 + 0.5 * t), -0.45 + 0.45 * t, start_time + 10.0 * i, 0);
  }
  return s;
}

Campaign campaign(int scale) {
  std::mt19937_64 random(7);
  Campaign c;
  c.machine = machine();
  c.setups = {tracer("T1", "P1", 0, 500 * scale, 0.0, random),
              tracer("T2", "P2", 1, 500 * scale, 4000.0, random),
              circle("bb1", 0.0, 0.0, -0.2, 8000.0),
              circle("bb2", 0.15, -0.05, -0.3, 8400.0),
              diagonal("diag1", 1.0, 9000.0),
              diagonal("diag2", -1.0, 9400.0)};
  return c;
}

void add_functions(FitResult& result) {
  for (const Axis& axis : result.machine.axes) {
    FunctionSpec spec;
    spec.knots = KnotChoice::Explicit;
    spec.breakpoints = uniform_breakpoints(axis, kIntervals);
    FunctionGroup group;
    group.axis = axis.name;
    group.basis = find_basis("bspline")->make(spec, axis);
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      if (symbol.name() == "EAX") {
        result.identified.functions[symbol].basis = "zero";
        continue;
      }
      group.symbols.push_back(symbol);
      result.identified.functions[symbol] = spec;
      const double measured_max = axis.name == AxisName::Y ? 0.17 : axis.travel_max;
      result.functions.push_back(
          {symbol, kIntervals, true, "geometric", 0.15, 7.3, axis.travel_min, measured_max});
      const bool visible = symbol.name() != "ECZ";
      std::optional<Finding> cause;
      if (!visible)
        cause = Finding{FindingCode::NotVisibleToolsOnOneAxis, {{"error", "ECZ"}, {"about", "Z"}}};
      result.rank.errors.push_back(
          {symbol, visible, visible ? 0.8 : 0.0, visible ? 0.3e-6 : 0.0, 7.3, cause});
    }
    group.offset = result.layout.function_size;
    result.layout.function_size += group.size();
    result.layout.groups.push_back(std::move(group));
  }
  result.layout.size = result.layout.function_size;
}

void add_block(FitResult& result, ParameterKind kind, const std::string& name, const std::string& unit,
               double si_per_unit, const std::vector<std::string>& labels, const Eigen::VectorXd& guess,
               double prior_sigma = 0.0) {
  ParameterBlock block;
  block.kind = kind;
  block.name = name;
  block.labels = labels;
  block.units.assign(labels.size(), unit);
  block.si_per_unit.assign(labels.size(), si_per_unit);
  block.location = LocationSymbol::parse(name);
  block.offset = result.layout.size;
  block.guess = guess;
  block.prior_mean = guess;
  block.prior_sigma = Eigen::VectorXd::Constant(guess.size(), prior_sigma);
  block.weak_default_prior = prior_sigma > 0.0;
  result.layout.size += block.size();
  result.layout.blocks.push_back(std::move(block));
}

void add_blocks(FitResult& result) {
  for (const LocationSymbol symbol : result.machine.datum.squareness()) {
    add_block(result, ParameterKind::Location, symbol.name(), "urad", kMicro, {""},
              Eigen::VectorXd::Constant(1, 0.0));
    result.rank.errors.push_back({symbol, true, 0.95, 0.2e-6, 1.0});
  }
  const std::vector<std::string> xyz = {"x", "y", "z"};
  add_block(result, ParameterKind::Nuisance, "station P1", "mm", 1e-3, xyz,
            Eigen::Vector3d(-0.6, -0.35, -0.5));
  add_block(result, ParameterKind::Nuisance, "T1: dead path", "mm", 1e-3, {""},
            Eigen::VectorXd::Constant(1, 0.3));
  add_block(result, ParameterKind::Nuisance, "station P2", "mm", 1e-3, xyz,
            Eigen::Vector3d(0.6, -0.4, -0.58));
  add_block(result, ParameterKind::Nuisance, "bb1: centre", "mm", 1e-3, xyz, Eigen::Vector3d(0.0, 0.0, -0.35),
            1e-4);
  result.rank.held_by_prior = {verbatim("bb1: centre z")};
}

void set_parameters(FitResult& result) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const int size = result.layout.size;
  result.parameters = Eigen::VectorXd::Zero(size);
  for (const FunctionGroup& group : result.layout.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const double size_of_error =
          is_rotation(group.symbols[static_cast<std::size_t>(slot)].component) ? 12e-6 : 6e-6;
      double value = 0.0;
      for (int j = 0; j < group.basis->size(); ++j) {
        result.parameters[group.index(j, slot)] = value;
        value += 0.5 * size_of_error * normal(random);
      }
    }
  }
  for (const ParameterBlock& block : result.layout.blocks) {
    for (int i = 0; i < block.size(); ++i) {
      const double step = block.location ? 15e-6 : 1e-3;
      result.parameters[block.offset + i] = block.guess[i] + step * normal(random);
    }
  }
  Eigen::MatrixXd mix(size, size);
  for (int a = 0; a < size; ++a) {
    for (int b = 0; b < size; ++b) mix(a, b) = (a == b ? 1.0 : 0.03 * normal(random));
  }
  result.covariance = 0.09e-12 * mix * mix.transpose();
  result.identified.locations_off = {LocationSymbol{Component::B, AxisName::X}};
}

void add_residuals(SyntheticFit& fit) {
  std::mt19937_64 random(13);
  std::normal_distribution<double> normal;
  FitResult& result = fit.result;
  const double sigma = 0.7e-6;
  const double redundancy = 0.9;
  result.outlier_critical_value = 3.29;
  for (std::size_t k = 0; k < fit.campaign.setups.size(); ++k) {
    const Setup& s = fit.campaign.setups[k];
    SetupSummary summary;
    summary.name = s.name;
    summary.instrument = s.instrument;
    summary.tool = fit.campaign.machine.tools[s.tool].name;
    summary.reading_unit = "um";
    for (std::size_t row = 0; row < s.readings.size(); ++row) {
      ResidualRecord record;
      record.setup = k;
      record.row = row;
      record.source_line = s.readings.source_line[row];
      record.sigma = sigma;
      record.redundancy = redundancy;
      record.w = normal(random) + (row == 17 ? 6.0 : 0.0);
      record.reading = record.w * sigma * std::sqrt(redundancy);
      record.flagged = std::abs(record.w) > result.outlier_critical_value;
      record.removed = row == 17 && k == 0;
      result.residuals.push_back(record);
      summary.observations += 1;
      summary.redundancy += redundancy;
      summary.chi2 += record.w * record.w * redundancy;
      summary.rms_residual += record.reading * record.reading;
      summary.max_residual = std::max(summary.max_residual, std::abs(record.reading));
    }
    summary.rms_residual = std::sqrt(summary.rms_residual / static_cast<double>(summary.observations));
    result.chi2 += summary.chi2;
    result.dof += summary.redundancy;
    result.setups.push_back(summary);
  }
  result.sigma0 = std::sqrt(result.chi2 / result.dof);
}

}  // namespace

SyntheticFit synthetic_fit(int scale) {
  SyntheticFit fit;
  fit.campaign = campaign(scale);
  FitResult& result = fit.result;
  result.status = FitStatus::RankDeficient;
  result.findings = {verbatim("T2: 3 readings lie outside the travel </script><b>")};
  result.machine = fit.campaign.machine;
  add_functions(result);
  add_blocks(result);
  set_parameters(result);
  add_residuals(fit);
  result.rank.parameters = result.layout.size - 36;
  result.rank.rank = result.rank.parameters - 10;
  result.rank.invisible = {verbatim("ECZ: not visible, every tool offset lies on Z")};
  result.variance_components = {{"laser-tracer", 1.02, 0.03, 900.0, 1000},
                                {"ball-bar", 1.31, 0.04, 320.0, 360},
                                {"displacement", 0.97, 0.12, 38.0, 42}};
  const double none = std::numeric_limits<double>::quiet_NaN();
  result.noise = {
      .estimated = true,
      .more_than_white = true,
      .groups = {"laser-tracer"},
      .rows = {{0, "white", "1", 1.02, 0.98, 1.06, none, ""},
               {0, "wander", "m or rad", 0.41e-6, 0.3e-6, 0.56e-6, 41.5, ""},
               {0, "tau", "s", 540.0, 280.0, 1040.0, 41.5, ""},
               {0, "line", "m or rad", 0.0, none, none, 1.1, "off: not supported by the readings"}},
      .chi2 = 905.0,
      .dof = 900.0};
  result.timings = {{"read", 0.012}, {"solve", 0.431}, {"covariance", 0.087}};
  result.iterations = 9;
  result.initial_cost = 4.1e7;
  result.final_cost = 702.5;
  return fit;
}

}  // namespace volcal::test
