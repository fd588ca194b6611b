#include "volcal/studies/criticism/criticism_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "volcal/studies/criticism/criticism_figures.h"
#include "volcal/studies/criticism/criticism_outcome.h"

namespace volcal::studies {
namespace {

constexpr double kPowerQuantile = 0.8416212335729143;  // of the normal distribution at 80 %

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

struct Trial {
  double ratio = 0.0;  ///< amplitude over the stated detectable one
  bool found = false;
};

/// Maximum likelihood of P = Phi(b0 + b1 ratio) by Fisher scoring (Finney 1971, Probit Analysis), and the
/// ratio at 80 %.
Detection probit(const std::vector<Trial>& trials) {
  constexpr int kSteps = 50;
  Detection out;
  out.campaigns = static_cast<int>(trials.size());
  out.ratio = out.low = out.high = std::numeric_limits<double>::quiet_NaN();
  double b0 = -3.0, b1 = 4.0;
  double i00 = 0.0, i01 = 0.0, i11 = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    double g0 = 0.0, g1 = 0.0;
    i00 = i01 = i11 = 0.0;
    for (const Trial& trial : trials) {
      const double line = std::clamp(b0 + b1 * trial.ratio, -6.0, 6.0);
      const double p = normal_distribution(line);
      const double density = std::exp(-0.5 * line * line) / std::sqrt(2.0 * std::numbers::pi);
      const double score = density * ((trial.found ? 1.0 : 0.0) - p) / (p * (1.0 - p));
      const double weight = density * density / (p * (1.0 - p));
      g0 += score;
      g1 += score * trial.ratio;
      i00 += weight;
      i01 += weight * trial.ratio;
      i11 += weight * trial.ratio * trial.ratio;
    }
    const double determinant = i00 * i11 - i01 * i01;
    if (!(determinant > 1e-9)) return out;
    b0 += std::clamp((i11 * g0 - i01 * g1) / determinant, -2.0, 2.0);
    b1 += std::clamp((i00 * g1 - i01 * g0) / determinant, -2.0, 2.0);
  }
  if (!(b1 > 0.0)) return out;
  const double determinant = i00 * i11 - i01 * i01;
  out.ratio = (kPowerQuantile - b0) / b1;
  const double variance =
      (i11 - 2.0 * out.ratio * i01 + out.ratio * out.ratio * i00) / determinant / (b1 * b1);
  out.low = out.ratio - kNormal95 * std::sqrt(variance);
  out.high = out.ratio + kNormal95 * std::sqrt(variance);
  return out;
}

const AnswerRecord* answer_for(const CampaignRecord& record) {
  std::vector<const std::vector<AnswerRecord>*> lists = {&record.named};
  for (const auto& set : record.sets) lists.push_back(&set);
  lists.push_back(&record.ranking);
  for (const auto* list : lists) {
    for (const AnswerRecord& answer : *list) {
      if (answer.by_name && !answer.amplitudes.empty()) return &answer;
    }
  }
  return nullptr;
}

}  // namespace

std::vector<Detection> detections_of(const Campaigns& campaigns) {
  std::map<std::string, std::vector<const CampaignRecord*>> by_effect;
  for (const CampaignRecord& record : campaigns) {
    if (record.row == "mdb" && record.failure.empty())
      by_effect[record.hidden.front().right].push_back(&record);
  }
  std::vector<Detection> detections;
  for (const auto& [effect, records] : by_effect) {
    // Signal of the stated amplitude; where the family is not among those kept, the median of the others.
    std::vector<double> stated;
    const auto stated_signal = [](const CampaignRecord& record) {
      const AnswerRecord* answer = answer_for(record);
      if (answer == nullptr) return std::numeric_limits<double>::quiet_NaN();
      const AmplitudeRecord& amplitude = answer->amplitudes.front();
      return record.hidden.front().signal * amplitude.mdb / std::abs(amplitude.truth);
    };
    for (const CampaignRecord* record : records) {
      if (const double signal = stated_signal(*record); std::isfinite(signal)) stated.push_back(signal);
    }
    if (stated.empty()) continue;
    std::ranges::nth_element(stated, stated.begin() + static_cast<std::ptrdiff_t>(stated.size() / 2));
    const double median = stated[stated.size() / 2];
    std::vector<Trial> trials;
    for (const CampaignRecord* record : records) {
      const double own = stated_signal(*record);
      trials.push_back({record->hidden.front().signal / (std::isfinite(own) ? own : median),
                        any_right(record->named) || std::ranges::any_of(record->sets, any_right)});
    }
    Detection detection = probit(trials);
    detection.effect = effect;
    detections.push_back(detection);
  }
  return detections;
}

}  // namespace volcal::studies
