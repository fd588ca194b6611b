/// Everything that had to be estimated along with the machine's errors: stations, dead paths, effects, tools.

#include <cmath>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

constexpr std::size_t kListedParameters = 600;

const char* kind_name(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::Effect:
      return "effect";
    case ParameterKind::EffectShape:
      return "shape of an effect";
    case ParameterKind::Expansion:
      return "expansion";
    case ParameterKind::ToolOffset:
      return "tool offset";
    default:
      return "setup";
  }
}

Json parameter_row(const FitResult& result, const ParameterBlock& block, int i) {
  const int index = block.offset + i;
  const double per_si = 1.0 / block.si_per_unit[static_cast<std::size_t>(i)];
  const double u = std::sqrt(std::max(0.0, result.covariance(index, index)));
  const double value = result.parameters[index];
  return {{"name", block.name},
          {"label", block.labels[static_cast<std::size_t>(i)]},
          {"kind", kind_name(block.kind)},
          {"unit", shown_unit(block.units[static_cast<std::size_t>(i)])},
          {"value", rounded(value * per_si, 9)},
          {"u", rounded(u * per_si, 3)},
          {"guess", rounded(block.guess[i] * per_si, 7)},
          {"change", rounded((value - block.guess[i]) * per_si, 4)},
          {"prior_sigma", rounded(block.prior_sigma[i] > 0 ? block.prior_sigma[i] * per_si : NAN, 3)},
          {"weak_default_prior", block.weak_default_prior}};
}

}  // namespace

Json nuisance_page(const PageInput& input) {
  const FitResult& result = input.result;
  Json rows = Json::array();
  std::size_t count = 0;
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location) continue;
    for (int i = 0; i < block.size(); ++i) {
      if (++count <= kListedParameters) rows.push_back(parameter_row(result, block, i));
    }
  }
  return {
      {"count", count}, {"held_by_prior", sentences(result.rank.held_by_prior)}, {"rows", std::move(rows)}};
}

}  // namespace volcal::report
