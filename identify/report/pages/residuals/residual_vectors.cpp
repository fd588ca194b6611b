/// Residuals as displacements in the work volume: means of neighbouring readings, and single readings along
/// what they feel.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/statistics/even_sample.h"

namespace volcal::report {
namespace {

constexpr std::size_t kSingle = 600;

}  // namespace

Json residual_vectors_page(const DiagnosisInput& input) {
  const DiagnosisFigures& figures = input.diagnosis.figures;
  Json means = Json::array();
  for (const ResidualVector& vector : figures.vectors) {
    means.push_back({{"point_mm", rounded_vector(vector.point_w, kPerMilli, 6)},
                     {"given_um", rounded_vector(vector.given_w, kPerMicro, 4)},
                     {"reached_um", rounded_vector(vector.reached_w, kPerMicro, 4)},
                     {"u_um", rounded(vector.u * kPerMicro, 3)},
                     {"readings", vector.observations}});
  }
  Json single = Json::array();
  for (const std::size_t i : even_sample(figures.observations.size(), kSingle)) {
    const DrawnObservation& drawn = figures.observations[i];
    const double squares = drawn.direction_w.squaredNorm();
    if (drawn.angle || squares == 0.0) continue;
    const Eigen::Vector3d along = drawn.direction_w / squares;
    single.push_back({{"point_mm", rounded_vector(drawn.point_w, kPerMilli, 6)},
                      {"given_um", rounded_vector(along * drawn.given, kPerMicro, 3)},
                      {"reached_um", rounded_vector(along * drawn.reached, kPerMicro, 3)},
                      {"setup", input.campaign.setups[drawn.setup].name}});
  }
  return {{"two_models", input.diagnosis.ladder.size() > 1},
          {"means", std::move(means)},
          {"single", std::move(single)}};
}

}  // namespace volcal::report
