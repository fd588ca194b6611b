#include "volcal/identify/report/numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "volcal/model/description/units.h"

namespace volcal::report {

Json rounded(double value, int digits) {
  constexpr int kLeastDecimals = 3;
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0;
  const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  digits = std::clamp(before_point + kLeastDecimals, digits, std::max(digits, 15));
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return std::strtod(text, nullptr);
}

Json rounded_micrometres(double metres, int digits) {
  constexpr double kPicometre = 1e-12;
  return std::abs(metres) < kPicometre ? Json(0) : rounded(metres * kPerMicro, digits);
}

Json rounded_array(const std::vector<double>& values, double factor, int digits) {
  Json array = Json::array();
  for (const double value : values) array.push_back(rounded(value * factor, digits));
  return array;
}

Json rounded_triangle(const Eigen::MatrixXd& symmetric, int digits, bool with_diagonal) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < symmetric.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < (with_diagonal ? i + 1 : i); ++k) {
      row.push_back(rounded(symmetric(i, k), digits));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Json rounded_vector(const Eigen::Vector3d& vector, double factor, int digits) {
  return {rounded(vector.x() * factor, digits), rounded(vector.y() * factor, digits),
          rounded(vector.z() * factor, digits)};
}

double position_factor(AxisName axis) { return 1.0 / position_unit(axis).si_per_unit; }

std::string axis_letter(AxisName axis) { return std::string(1, letter_of(axis)); }

namespace {

/// "mm2" as "mm²".
std::string with_raised_powers(const std::string& unit) {
  constexpr std::array<const char*, 8> kRaised = {"²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string raised;
  for (const char letter : unit) {
    const bool is_power = letter >= '2' && letter <= '9' && !raised.empty();
    raised += is_power ? kRaised[static_cast<std::size_t>(letter - '2')] : std::string(1, letter);
  }
  return raised;
}

}  // namespace

std::string shown_unit(const std::string& edge_unit) {
  std::string shown = edge_unit;
  if (shown.starts_with("um") || shown.starts_with("urad")) shown.replace(0, 1, "µ");
  if (const std::size_t at = shown.find(" or urad"); at != std::string::npos) shown.replace(at + 4, 1, "µ");
  const std::size_t first = shown.find('/');
  if (first != std::string::npos && shown.find('/', first + 1) != std::string::npos) {
    std::string below = shown.substr(first + 1);
    std::ranges::replace(below, '/', ' ');
    shown = shown.substr(0, first + 1) + "(" + below + ")";
  }
  return with_raised_powers(shown);
}

std::string axis_letter_of(const MachineError& error) {
  const std::optional<AxisName> axis = error.axis();
  return axis ? axis_letter(*axis) : "";
}

const Observability* find_observability(const FitResult& result, const MachineError& error) {
  const auto found = std::ranges::find(result.rank.errors, error, &Observability::symbol);
  return found == result.rank.errors.end() ? nullptr : &*found;
}

}  // namespace volcal::report
