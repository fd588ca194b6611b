/// Everything that had to be estimated along with the machine's errors: stations, dead paths, effects, tools.

#include <cmath>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/result/identified_expansions.h"
#include "volcal/identify/result/surface_values.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/parameter_names.h"

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

/// The coefficient that the machine file states, which the parameter corrects.
double stated_value(const FitResult& result, const ParameterBlock& block) {
  for (const IdentifiedExpansion& each : identified_expansions(result)) {
    if (expansion_parameter(each.axis) == block.name) return each.stated;
  }
  return 0.0;
}

Json parameter_row(const FitResult& result, const ParameterBlock& block, int i) {
  const int index = block.offset + i;
  const double per_si = 1.0 / block.si_per_unit[static_cast<std::size_t>(i)];
  const double u = std::sqrt(parameter_variance(result, index));
  const double stated = block.kind == ParameterKind::Expansion ? stated_value(result, block) : 0.0;
  const double value = stated + result.parameters[index], guess = stated + block.guess[i];
  return {{"name", block.name},
          {"label", block.labels[static_cast<std::size_t>(i)]},
          {"kind", kind_name(block.kind)},
          {"unit", shown_unit(block.units[static_cast<std::size_t>(i)])},
          {"value", rounded(value * per_si, kDigitsBesideU)},
          {"u", rounded(u * per_si, 3)},
          {"guess", rounded(guess * per_si, kDigitsBesideU)},
          {"change", rounded((value - guess) * per_si, kDigitsBesideU)},
          {"prior_sigma", rounded(block.prior_sigma[i] > 0 ? block.prior_sigma[i] * per_si : NAN, 3)},
          {"weak_default_prior", block.weak_default_prior}};
}

/// Its largest value.
Json surface_row(const SurfaceValues& surface) {
  const double per_si = 1.0 / surface.si_per_unit;
  return {{"name", surface.label},
          {"label", "largest"},
          {"kind", kind_name(ParameterKind::Effect)},
          {"unit", shown_unit(surface.unit)},
          {"value", rounded(surface.largest * per_si, kDigitsBesideU)},
          {"u", rounded(surface.largest_u * per_si, 3)},
          {"guess", 0.0},
          {"change", rounded(surface.largest * per_si, kDigitsBesideU)},
          {"prior_sigma", nullptr},
          {"weak_default_prior", false}};
}

}  // namespace

Json nuisance_page(const PageInput& input) {
  const FitResult& result = input.result;
  Json rows = Json::array();
  std::size_t count = 0;
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location || is_surface(block)) continue;
    for (int i = 0; i < block.size(); ++i) {
      if (++count <= kListedParameters) rows.push_back(parameter_row(result, block, i));
    }
  }
  for (const SurfaceValues& surface : surface_values(result)) {
    ++count;
    rows.push_back(surface_row(surface));
  }
  return {
      {"count", count}, {"held_by_prior", sentences(result.rank.held_by_prior)}, {"rows", std::move(rows)}};
}

}  // namespace volcal::report
