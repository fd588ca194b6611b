#include "volcal/sim/known/known_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "volcal/sim/known/known_spline.h"

namespace volcal::sim {
namespace {

/// sum c_n P_n(t), t from -1 to 1 over the travel.
struct KnownLegendre {
  double low = 0.0;
  double high = 1.0;
  std::vector<double> coefficients;

  double operator()(double q) const {
    const double t = (2.0 * q - low - high) / (high - low);
    double before = 0.0, now = 1.0, sum = 0.0;
    for (std::size_t n = 0; n < coefficients.size(); ++n) {
      sum += coefficients[n] * now;
      const auto number = static_cast<double>(n);
      const double next = ((2.0 * number + 1.0) * t * now - number * before) / (number + 1.0);
      before = std::exchange(now, next);
    }
    return sum;
  }
};

/// c_0 + c_1 cos q + c_2 sin q + c_3 cos 2q ...
struct KnownFourier {
  std::vector<double> coefficients;

  double operator()(double q) const {
    double sum = coefficients.front();
    for (std::size_t i = 1; i < coefficients.size(); ++i) {
      const double angle = q * static_cast<double>((i + 1) / 2);
      sum += coefficients[i] * (i % 2 == 1 ? std::cos(angle) : std::sin(angle));
    }
    return sum;
  }
};

std::vector<double> breakpoints_of(const FunctionSpec& spec, const Axis& axis) {
  if (spec.knots != KnotChoice::IntervalCount) return spec.breakpoints;
  return equal_pieces(axis.travel_min, axis.travel_max, spec.intervals);
}

ErrorFunction known_function(const FunctionSpec& spec, ErrorSymbol symbol, const Axis& axis,
                             const std::string& file) {
  if (spec.basis == "bspline") return KnownSpline(spec.degree, breakpoints_of(spec, axis), spec.coefficients);
  if (spec.basis == "legendre") return KnownLegendre{axis.travel_min, axis.travel_max, spec.coefficients};
  if (spec.basis == "fourier") return KnownFourier{spec.coefficients};
  throw InputError(
      {file, 0}, symbol.name() + " has the basis \"" + spec.basis + "\", which is not simulated",
      "state it in one of bspline, legendre, fourier, or as tables (volcal tables --format csv)");
}

/// Whether errors state one value for positions a turn apart: series, and polylines that close after a turn.
bool turns_round(const ModelSpec& errors, const Axis& axis) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kSameEnd = 1e-9;
  if (!is_rotary(axis.name) || axis.travel_max - axis.travel_min < kTurn - 1e-6) return false;
  int series = 0, closed = 0, others = 0;
  for (const auto& [symbol, spec] : errors.functions) {
    if (symbol.axis != axis.name || spec.coefficients.empty()) continue;
    if (spec.basis == "fourier") {
      ++series;
    } else if (spec.basis == "bspline" && spec.degree == 1 && spec.breakpoints.size() > 1) {
      const double turns = (spec.breakpoints.back() - spec.breakpoints.front()) / kTurn;
      const bool whole = turns > 0.5 && std::abs(turns - std::round(turns)) * kTurn < kSameEnd;
      const double gap = std::abs(spec.coefficients.back() - spec.coefficients.front());
      ++(whole && gap < kSameEnd ? closed : others);
    } else {
      ++others;
    }
  }
  return others == 0 && series + closed > 0;
}

}  // namespace

void set_known_functions(const std::map<ErrorSymbol, FunctionSpec>& functions, const std::string& file,
                         TruthMachine& truth) {
  for (const auto& [symbol, spec] : functions) {
    if (spec.coefficients.empty()) continue;
    truth.set_error(symbol, known_function(spec, symbol, truth.machine().axis(symbol.axis), file));
  }
}

void set_known_errors(const ModelSpec& errors, TruthMachine& truth) {
  set_known_functions(errors.functions, errors.file, truth);
  for (const auto& [symbol, value] : errors.locations) truth.set_location(symbol, value);
  for (const auto& [axis, ends] : errors.measured)
    truth.hold_beyond(axis, ends.first, ends.second, turns_round(errors, truth.machine().axis(axis)));
}

}  // namespace volcal::sim
