#include "volcal/model/instruments/nuisance.h"

#include <algorithm>
#include <utility>

#include "volcal/model/description/parameter_names.h"

namespace volcal {

NuisanceBlock scalar_nuisance(std::string name, double guess, double prior_sigma, bool is_angle) {
  NuisanceBlock block;
  block.name = std::move(name);
  block.labels = {""};
  block.is_angle = {is_angle};
  block.guess = Eigen::VectorXd::Constant(1, guess);
  block.prior_mean = block.guess;
  block.prior_sigma = Eigen::VectorXd::Constant(1, prior_sigma);
  return block;
}

NuisanceBlock point_nuisance(std::string name, const Eigen::Vector3d& guess_w, double prior_sigma) {
  NuisanceBlock block;
  block.name = std::move(name);
  block.labels = {"x", "y", "z"};
  block.is_angle = {false, false, false};
  block.guess = guess_w;
  block.prior_mean = guess_w;
  block.prior_sigma = Eigen::VectorXd::Constant(3, prior_sigma);
  return block;
}

std::optional<NuisanceBlock> length_scale_nuisance(const Setup& setup) {
  const auto sigma = setup.options.number("scale_sigma");
  if (!sigma || *sigma == 0.0) return std::nullopt;
  const std::string group = setup.options.text("scale_group").value_or(setup.instrument);
  NuisanceBlock block = scalar_nuisance(length_scale_parameter(group), 0.0, *sigma, true);
  block.prior_mean.setZero();
  return block;
}

std::vector<KeySchema> length_scale_keys() {
  return {{.key = "scale_sigma_um_per_m",
           .help = "standard uncertainty of the length scale (wavelength), one error for all its readings",
           .plausible_max = 1e4},
          {.key = "scale_group",
           .type = KeyType::Text,
           .help = "setups with the same name share one scale error; default: all of the instrument"}};
}

std::vector<KeySchema> length_noise_keys() {
  return {{.key = "constant_um", .help = "standard deviation, constant part", .plausible_max = 1e3},
          {.key = "per_metre_um", .help = "standard deviation per metre of length", .plausible_max = 1e3}};
}

std::optional<Eigen::Vector3d> line_direction(const std::vector<Eigen::Vector3d>& points) {
  const auto distance = [&](const Eigen::Vector3d& point) { return (point - points.front()).norm(); };
  const auto farthest = std::ranges::max_element(points, {}, distance);
  const double reach = distance(*farthest);
  if (reach < 1e-6) return std::nullopt;
  const Eigen::Vector3d last = points.back() - points.front();
  if (last.norm() > 0.5 * reach) return last.normalized();
  return (*farthest - points.front()).normalized();
}

Eigen::Vector3d unit_direction(const SetupContext& context, const std::string& stem) {
  const Eigen::Vector3d direction = *context.setup.options.vector(stem);
  if (direction.norm() < 1e-9) context.fail(stem + " has no length", "give a vector such as [1, 0, 0]");
  return direction.normalized();
}

}  // namespace volcal
