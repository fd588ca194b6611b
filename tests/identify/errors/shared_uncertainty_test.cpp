// Uncertainties against normal equations written down by hand, two unknowns at a time: what readings share is
// not averaged away.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

constexpr double kNoise = 1e-6;    // m
constexpr double kScale = 0.5e-6;  // relative
constexpr double kTool = 2e-6;     // m

/// `w X b Y Z t` with travel 0 to 1 m in X; one tool of length 0.2 m.
Campaign campaign_on_x() {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine = sim::machine_from_code("w X b Y Z t", {{{0.0, 1.0}, {0.0, 0.6}, {0.0, 0.5}}});
  campaign.machine.tools = {{"long", {0.0, 0.0, -0.2}, 0.0}};
  return campaign;
}

volcal::Setup setup_at(const std::string& name, const std::string& instrument, const std::vector<double>& x,
                       std::size_t channels) {
  volcal::Setup setup;
  setup.name = name;
  setup.instrument = instrument;
  setup.noise.set("constant", kNoise);
  setup.has_noise = true;
  for (std::size_t row = 0; row < x.size(); ++row) {
    setup.readings.position[0].push_back(x[row]);
    setup.readings.position[1].push_back(0.0);
    setup.readings.position[2].push_back(0.0);
    setup.readings.source_line.push_back(static_cast<std::int64_t>(row) + 2);
  }
  setup.readings.value.assign(channels, std::vector<double>(x.size(), 0.0));
  return setup;
}

/// A length along X that is right; the beam lies in X.
volcal::Setup line(const std::string& name, const std::vector<double>& x, const std::string& group) {
  volcal::Setup setup = setup_at(name, "displacement", x, 1);
  setup.options.set("direction", Eigen::Vector3d(1.0, 0.0, 0.0));
  setup.options.set("scale_sigma", kScale);
  setup.options.set("scale_group", group);
  for (std::size_t row = 0; row < x.size(); ++row) setup.readings.value[0][row] = x[row] - x[0];
  return setup;
}

/// Straight lines for the functions named, nothing else.
ModelSpec straight_lines(const Machine& machine, const std::vector<std::string>& symbols) {
  ModelSpec model;
  model.default_function.basis = "zero";
  for (const std::string& symbol : symbols) {
    FunctionSpec& function = model.functions[*ErrorSymbol::parse(symbol)];
    function.basis = "legendre";
    function.degree = 1;
  }
  for (const LocationSymbol symbol : machine.datum.squareness()) model.locations_off.push_back(symbol);
  return model;
}

FitResult fitted(const Campaign& campaign, const std::vector<std::string>& symbols) {
  FitOptions options;
  options.variance_components = false;
  return fit(campaign, straight_lines(campaign.machine, symbols), options);
}

double u_at(const FitResult& result, const std::string& symbol, double position) {
  for (const ErrorTableRow& row : error_table(result, {.positions = 11})) {
    if (row.symbol.name() == symbol && std::abs(row.position - position) < 1e-9) return row.u;
  }
  throw std::out_of_range(symbol);
}

const std::vector<double> kLine = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};

double sum_of_squares(const std::vector<double>& x) {
  double mean = 0.0, sum = 0.0;
  for (const double value : x) mean += value / static_cast<double>(x.size());
  for (const double value : x) sum += (value - mean) * (value - mean);
  return sum;
}

// reading = a x + scale x + offset: var(a) = scale^2 + noise^2 / sum (x - mean)^2.
TEST(SharedUncertainty, LengthScaleOfOneLaserIsNotAveragedAway) {
  Campaign campaign = campaign_on_x();
  for (const char* name : {"L1", "L2", "L3", "L4"}) campaign.setups.push_back(line(name, kLine, "laser"));
  const FitResult result = fitted(campaign, {"EXX"});
  const double slope = std::sqrt(kScale * kScale + kNoise * kNoise / (4.0 * sum_of_squares(kLine)));
  for (const double x : {0.3, 0.8, 1.0}) EXPECT_NEAR(u_at(result, "EXX", x) / (slope * x), 1.0, 1e-6);
}

// With four lasers each line has its own scale: the variances of four independent slopes average.
TEST(SharedUncertainty, LengthScalesOfSeveralLasersAre) {
  Campaign campaign = campaign_on_x();
  for (const char* name : {"L1", "L2", "L3", "L4"}) campaign.setups.push_back(line(name, kLine, name));
  const FitResult result = fitted(campaign, {"EXX"});
  const double slope = 0.5 * std::sqrt(kScale * kScale + kNoise * kNoise / sum_of_squares(kLine));
  EXPECT_NEAR(u_at(result, "EXX", 1.0) / slope, 1.0, 1e-6);
}

TEST(SharedUncertainty, RowsOutsideTheReadingsAreMarked) {
  Campaign campaign = campaign_on_x();
  campaign.setups.push_back(line("L1", kLine, "laser"));
  for (const ErrorTableRow& row : error_table(fitted(campaign, {"EXX"}), {.positions = 11})) {
    EXPECT_EQ(row.extrapolated, row.position < 0.1 - 1e-9 || row.position > 0.8 + 1e-9) << row.position;
  }
}

/// Error vectors in place, without alignment: ex = a x + b x (z_tool) + t, with EXX = a x, EBX = b x, and t
/// the shared error of a tool's offset.
struct VectorsOfTwoTools {
  Campaign campaign = campaign_on_x();
  std::vector<double> tool_z = {-0.2, -0.4};
  double tool_sigma;

  explicit VectorsOfTwoTools(double sigma) : tool_sigma(sigma) {
    campaign.machine.tools = {{"a", {0.0, 0.0, tool_z[0]}, sigma}, {"b", {0.0, 0.0, tool_z[1]}, sigma}};
    for (std::size_t tool = 0; tool < 2; ++tool) {
      volcal::Setup setup = setup_at("S" + std::to_string(tool), "volumetric-points", kLine, 3);
      setup.options.set("alignment", std::string("none"));
      setup.tool = tool;
      campaign.setups.push_back(setup);
    }
  }

  /// Covariance of (a, b, t_1, t_2).
  Eigen::Matrix4d covariance() const {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    for (std::size_t tool = 0; tool < 2; ++tool) {
      for (const double x : kLine) {
        Eigen::Vector4d row = Eigen::Vector4d::Zero();
        row << x, x * tool_z[tool], 0.0, 0.0;
        if (tool_sigma > 0.0) row[2 + static_cast<Eigen::Index>(tool)] = 1.0;
        normal += row * row.transpose() / (kNoise * kNoise);
      }
    }
    for (int k = 2; k < 4; ++k) normal(k, k) += tool_sigma > 0.0 ? 1.0 / (tool_sigma * tool_sigma) : 1.0;
    return normal.inverse();
  }
};

TEST(SharedUncertainty, ErrorsOfToolOffsetsAreSharedByTheirReadings) {
  for (const double sigma : {0.0, kTool}) {
    const VectorsOfTwoTools vectors(sigma);
    const FitResult result = fitted(vectors.campaign, {"EXX"});
    // a alone: one unknown slope, one constant per tool
    double information = 0.0;
    for (std::size_t tool = 0; tool < 2; ++tool) {
      double sx = 0.0, sxx = 0.0;
      for (const double x : kLine) {
        sx += x / (kNoise * kNoise);
        sxx += x * x / (kNoise * kNoise);
      }
      const double n = static_cast<double>(kLine.size()) / (kNoise * kNoise);
      information += sigma > 0.0 ? sxx - sx * sx / (n + 1.0 / (sigma * sigma)) : sxx;
    }
    EXPECT_NEAR(u_at(result, "EXX", 0.8) * std::sqrt(information) / 0.8, 1.0, 1e-6) << sigma;
  }
}

TEST(SharedUncertainty, VolumetricErrorOfAnyToolFollowsFromTheJointCovariance) {
  VectorsOfTwoTools vectors(0.0);
  // EBX moves ex and ez; read ex alone, as a plate in x and y does
  for (volcal::Setup& setup : vectors.campaign.setups) {
    setup.readings.column_set = 1;
    setup.readings.value.resize(2);
  }
  const FitResult result = fitted(vectors.campaign, {"EXX", "EBX"});
  const Eigen::Matrix4d covariance = vectors.covariance();
  for (const double z : {-0.1, -0.3, -0.5}) {
    for (const double x : {0.4, 0.9}) {
      AxisPosition position{};
      position[0] = x;
      const VolumetricError error = volumetric_error(result, position, {"other", {0.0, 0.0, z}, 0.0});
      const Eigen::Vector4d row(x, x * z, 0.0, 0.0);
      EXPECT_NEAR(error.u[0] / std::sqrt(row.dot(covariance * row)), 1.0, 1e-6) << x << " " << z;
      EXPECT_NEAR(error.u[4] / (x * std::sqrt(covariance(1, 1))), 1.0, 1e-6);
      EXPECT_EQ(error.u[1], 0.0);
      EXPECT_EQ(error.extrapolated, x > 0.8);
      // an offset that is itself uncertain adds its own
      const VolumetricError worse =
          volcal::volumetric_error(result, position, {"other", {0.0, 0.0, z}, kTool});
      EXPECT_NEAR(worse.u[0], std::hypot(error.u[0], kTool), 1e-12);
    }
  }
}

/// Unknown (a, t_1, t_2): readings of the first tool are 3 um everywhere, those of the second 0. What the
/// tool point does is a x + t, and its uncertainty follows from both together: smaller than that of t as
/// stated.
TEST(SharedUncertainty, VolumetricErrorOfAMeasuredToolHoldsItsFittedOffset) {
  VectorsOfTwoTools vectors(kTool);
  for (double& value : vectors.campaign.setups[0].readings.value[0]) value = 3e-6;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int tool = 0; tool < 2; ++tool) {
    for (const double x : kLine) {
      const Eigen::Vector3d row(x, tool == 0 ? 1.0 : 0.0, tool == 1 ? 1.0 : 0.0);
      normal += row * row.transpose() / (kNoise * kNoise);
      right += row * (tool == 0 ? 3e-6 : 0.0) / (kNoise * kNoise);
    }
    normal(1 + tool, 1 + tool) += 1.0 / (kTool * kTool);
  }
  const Eigen::Matrix3d covariance = normal.inverse();
  const Eigen::Vector3d solution = covariance * right;
  const FitResult result = fitted(vectors.campaign, {"EXX"});
  AxisPosition position{};
  position[0] = 0.7;
  const VolumetricError error = volumetric_error(result, position, vectors.campaign.machine.tools[0]);
  const Eigen::Vector3d row(0.7, 1.0, 0.0);
  EXPECT_NEAR(error.value[0], row.dot(solution), 1e-11);
  EXPECT_NEAR(error.u[0] / std::sqrt(row.dot(covariance * row)), 1.0, 1e-6);
  EXPECT_LT(error.u[0], kTool);
}

}  // namespace
}  // namespace volcal
