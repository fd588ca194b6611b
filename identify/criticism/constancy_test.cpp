#include "volcal/identify/criticism/constancy_test.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace volcal {
namespace {

constexpr int kWaves = 8;
constexpr double kTests = 4.0;  // groups of variables, smooth and rough

std::set<std::string> own_variables(const Family& family) {
  std::set<std::string> own;
  for (const std::string& name : scan_variables_of(family.name())) own.insert(name);
  for (const EffectAmplitude& amplitude : family.effect->amplitudes()) {
    if (amplitude.target.kind != TargetKind::Motion) continue;
    own.insert(std::string(1, lower_letter_of(amplitude.target.symbol.axis)));
  }
  return own;
}

/// log10 p of a smooth or of a rough variation, whichever is less probable.
double log10_p_of(const ScanVariable& variable, const Eigen::VectorXd& moved, const Projector& projector) {
  const Eigen::MatrixXd powers = moved.asDiagonal() * scan_powers(variable);
  const double smooth = score_test(projector.project(powers), 0, powers.cols()).log10_p;
  if (variable.two_valued) return smooth;
  const Eigen::MatrixXd waves = moved.asDiagonal() * scan_waves(variable, kWaves);
  return std::min(smooth, kernel_test(projector.project(waves), 0, waves.cols()).log10_p);
}

}  // namespace

ConstancyTest least_constant(const Family& family, const Eigen::VectorXd& moved,
                             const std::vector<ScanVariable>& variables, const Projector& projector) {
  const std::set<std::string> own = own_variables(family);
  const auto count = static_cast<double>(variables.size());
  const double own_count = std::max(1.0, static_cast<double>(own.size()));
  ConstancyTest least;
  for (const ScanVariable& variable : variables) {
    const double tried = kTests * (own.contains(variable.name) ? own_count : count);
    const double log10_p = std::min(0.0, log10_p_of(variable, moved, projector) + std::log10(tried));
    if (log10_p < least.log10_p) least = {variable.name, log10_p};
  }
  return least;
}

}  // namespace volcal
