#include "volcal/studies/criticism/criticism_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <numeric>

#include "volcal/model/description/units.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/studies/criticism/criticism_hidden.h"
#include "volcal/studies/criticism/rotary_campaigns.h"

namespace volcal::studies {
namespace {

constexpr std::array<double, 7> kSignals = {5.0, 7.0, 10.0, 12.0, 15.0, 20.0, 30.0};
constexpr std::array<double, 3> kPairSignals = {12.0, 15.0, 20.0};
constexpr std::array<double, 3> kUnlistedSignals = {15.0, 20.0, 30.0};
constexpr std::array<double, 4> kPartialRms = {0.5e-6, 1e-6, 2e-6, 4e-6};
/// Around the signal at which some four hundred families and four fifths of the readings detect with 80 %.
constexpr double kDetectedSignal = 5.4;
constexpr std::array<double, 3> kDetectionFactors = {0.7, 1.0, 1.3};
constexpr std::uint64_t kSeedsPerRow = 1'000'000;

template <class Values>
auto drawn(sim::RandomStream& random, const Values& values) {
  return values[static_cast<std::size_t>(random.uniform() * static_cast<double>(std::size(values)))];
}

int whole(sim::RandomStream& random, int low, int high) {
  return low + static_cast<int>(random.uniform() * (high - low + 1));
}

void set_noise(const std::string& kind, sim::RandomStream& random, sim::NoiseLevel& noise) {
  const double drift = random.uniform(0.2e-6, 0.6e-6), time = random.uniform(300.0, 1200.0);
  const double line = random.uniform(0.15e-6, 0.4e-6);
  const bool mixed = kind == "mixed";
  if (mixed || kind.starts_with("drift")) {
    noise.drift = drift;
    noise.drift_time = time;
  }
  if (mixed || kind.ends_with("line")) noise.line = line;
  if (mixed) noise.outlier_share = 0.003;
}

sim::Environment environment(sim::RandomStream& random) {
  sim::Environment environment;
  for (const char* name : {"air", "column", "spindle"}) {
    sim::TemperatureChannel channel;
    channel.name = name;
    channel.start = 20.0 + random.uniform(-1.0, 1.0);
    channel.drift = random.uniform(-0.3, 0.3) / kSecondsPerHour;
    channel.amplitude = random.uniform(0.2, 1.0);
    channel.period = random.uniform(kSecondsPerHour, 4.0 * kSecondsPerHour);
    channel.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    environment.channels.push_back(channel);
  }
  if (random.uniform() < 0.5) environment.channels.pop_back();
  return environment;
}

/// 3 to 6 stations around the volume, one or two tools at each.
class Layout {
 public:
  Layout(const Machine& machine, std::uint64_t seed, int least_tools)
      : machine_(machine), random_(seed, "layout") {
    stations_ = whole(random_, 3, 6);
    tools_ = std::max(least_tools, whole(random_, 1, 3));
    shuffled_ = random_.uniform() < 0.5;
    jittered_ = random_.uniform() < 0.8;
    revisits_ = random_.uniform() < 0.3 ? 1 : 0;
  }

  sim::Measurement measurement(int readings, const sim::NoiseLevel& noise) {
    sim::Tracking tracking;
    tracking.noise = noise;
    add_stations(tracking);
    add_runs(tracking);
    tracking.revisits = revisits_;
    tracking.jitter = jittered_ ? 0.3 : 0.0;
    const auto runs = static_cast<double>(tracking.runs.size()) * (1 + revisits_);
    const double scale = std::cbrt(readings / (2.0 * runs) / (9.0 * 7.0 * 6.0));
    const auto positions = [scale](double most) {
      return std::max(3, static_cast<int>(std::lround(scale * most)));
    };
    tracking.grid = {positions(9.0), positions(7.0), positions(6.0)};
    sim::Measurement measurement;
    measurement.settings = tracking;
    measurement.shuffled = shuffled_;
    return measurement;
  }

  std::string text() const {
    return fmt::format("{} stations, {} tools{}{}{}", stations_, tools_, shuffled_ ? ", shuffled" : "",
                       jittered_ ? "" : ", regular grid", revisits_ > 0 ? ", revisited" : "");
  }

 private:
  void add_stations(sim::Tracking& tracking) {
    const std::array<Eigen::Vector3d, 6> shares = {{{-0.25, -0.2, -0.13},
                                                    {1.25, -0.3, -0.3},
                                                    {1.2, 1.3, -0.25},
                                                    {-0.2, 1.25, -0.45},
                                                    {0.5, -0.45, -0.35},
                                                    {0.45, 1.4, -0.15}}};
    for (int i = 0; i < stations_; ++i) {
      Eigen::Vector3d position;
      for (int k = 0; k < 3; ++k) {
        const Axis& axis =
            machine_.axis(std::array{AxisName::X, AxisName::Y, AxisName::Z}[static_cast<std::size_t>(k)]);
        const double share = shares[static_cast<std::size_t>(i)][k] + random_.uniform(-0.08, 0.08);
        position[k] = axis.travel_min + share * axis.travel();
      }
      tracking.stations.push_back({"P" + std::to_string(i + 1), position});
    }
  }

  void add_runs(sim::Tracking& tracking) {
    for (int i = 0; i < stations_; ++i) {
      for (int second = 0; second < std::min(2, tools_); ++second) {
        const auto tool = static_cast<std::size_t>((i + second) % tools_);
        tracking.runs.push_back({"P" + std::to_string(i + 1), machine_.tools[tool].name});
      }
    }
  }

  const Machine& machine_;
  sim::RandomStream random_;
  int stations_ = 4;
  int tools_ = 3;
  int revisits_ = 0;
  bool shuffled_ = false;
  bool jittered_ = true;
};

class Planner {
 public:
  Planner(std::string row, int index, std::uint64_t seed, int readings, int attempt)
      : readings_(readings), attempt_(attempt) {
    plan_.row = std::move(row);
    plan_.index = index;
    const auto rows = criticism_rows();
    const auto at = static_cast<std::uint64_t>(std::ranges::find(rows, plan_.row) - rows.begin());
    plan_.study.seed = seed + static_cast<std::uint64_t>(index) + at * kSeedsPerRow;
  }

  PlannedCampaign plan() {
    sim::Study& study = plan_.study;
    const std::vector<Machine> machines = sim::reference_machines();
    const auto index = static_cast<std::size_t>(plan_.index);
    study.machine = plan_.row == "mdb" ? machines[0] : machines[(index + index / 20) % machines.size()];
    if (has_rotary_axes()) study.machine = rotary_machine(plan_.index);
    choose_kinds();
    sim::RandomStream random(is("mdb") ? 1 : study.seed, "environment");
    study.environment = environment(random);
    plan_.noise = is_null_row(plan_.row) ? criticism_noises()[index % criticism_noises().size()] : "mixed";
    if (is("rotary-missing")) plan_.given = without_rotary_errors(study.machine);
    study.unseen = true;
    measure();
    hide();
    return std::move(plan_);
  }

 private:
  bool is(const char* row) const { return plan_.row == row; }
  bool has_rotary_axes() const { return plan_.row.starts_with("rotary"); }

  void choose_kinds() {
    const int shift = attempt_ / kAttemptsPerKind;
    if (is_null_row(plan_.row) || is("rotary-missing")) return;
    if (is("mdb")) {
      kinds_ = {std::array{"reversal", "squareness-drift",
                           "scale-expansion"}[static_cast<std::size_t>(plan_.index) % 3]};
      return;
    }
    const bool starts_unlisted = is("unlisted") || is("behind");
    const auto list = starts_unlisted ? unlisted_kinds()
                      : is("shared")  ? shared_kinds()
                      : is("rotary")  ? rotary_kinds()
                      : is("axes")    ? kinds_over_axes()
                                      : listed_kinds();
    const auto count = static_cast<int>(list.size());
    kinds_.push_back(list[static_cast<std::size_t>((plan_.index + shift) % count)]);
    if (is("behind")) {
      const auto others = listed_kinds();
      const auto at = static_cast<std::size_t>(7 * plan_.index + plan_.index / count + shift);
      kinds_.push_back(others[at % others.size()]);
    }
    if (!is("pairs")) return;
    // Another kind; all distances come in turn.
    const int distance = 1 + (plan_.index / count + plan_.index * 7 + shift) % (count - 1);
    kinds_.push_back(list[static_cast<std::size_t>((plan_.index + shift + distance) % count)]);
  }

  bool hides(std::initializer_list<const char*> any_of) const {
    return std::ranges::any_of(
        any_of, [&](const char* kind) { return std::ranges::find(kinds_, kind) != kinds_.end(); });
  }

  void measure() {
    sim::Study& study = plan_.study;
    sim::RandomStream random(study.seed, "noise levels");
    if (is("partial")) return measure_partly(random);
    sim::NoiseLevel noise = sim::Tracking{}.noise;
    set_noise(plan_.noise, random, noise);
    if (is("mdb")) {
      measure_standard(noise);
      return;
    }
    const bool tells_tools =
        is("shared") || hides({"tool-load", "tool-load by", "tool-offset", "tool-clamping"});
    if (has_rotary_axes()) {
      measure_rotary_axes(study, readings_, noise);
      plan_.layout = "tracer and spheres";
      return;
    }
    Layout layout(study.machine, study.seed, tells_tools ? 2 : 1);
    study.measurements.push_back(layout.measurement(readings_, noise));
    plan_.layout = layout.text();
    // A foundation that tilts is separated from an axis that tilts by what does not stand on it.
    if (!hides({"bar-length", "servo-mismatch", "foundation-tilt"})) return;
    sim::BallBarCircles circles;
    circles.planes = {"XY"};
    if (hides({"bar-length"})) circles.length_sigma = 0.0;
    circles.records_feed = true;
    sim::Measurement& bar = study.measurements.emplace_back();
    bar.settings = circles;
    plan_.layout += ", ball-bar";
  }

  /// The same for every campaign, so that the detectable amplitude is one.
  void measure_standard(const sim::NoiseLevel& noise) {
    sim::Tracking tracking;
    tracking.noise = noise;
    tracking.noise.drift = 0.4e-6;
    tracking.noise.drift_time = 600.0;
    tracking.noise.line = 0.25e-6;
    const double scale = std::cbrt(readings_ / 6048.0);
    for (Eigen::Index k = 0; k < 3; ++k) {
      tracking.grid[k] = std::max(3, static_cast<int>(std::lround(scale * tracking.grid[k])));
    }
    plan_.study.measurements.emplace_back().settings = tracking;
    plan_.layout = "4 stations, 3 tools";
  }

  void measure_partly(sim::RandomStream& random) {
    sim::Measurement& measurement = plan_.study.measurements.emplace_back();
    if (plan_.index % 2 == 0) {
      sim::BallBarCircles circles;
      set_noise(plan_.noise, random, circles.noise);
      measurement.settings = circles;
      plan_.layout = "ball-bar only";
    } else {
      sim::Diagonals diagonals;
      diagonals.runs = 3;
      set_noise(plan_.noise, random, diagonals.noise);
      measurement.settings = diagonals;
      plan_.layout = "diagonals only";
    }
  }

  void hide() {
    sim::RandomStream random(plan_.study.seed, "hidden, attempt " + std::to_string(attempt_));
    for (const std::string& kind : kinds_) {
      PlannedEffect effect;
      effect.effect = is("mdb")      ? first_of_kind(kind, plan_.study)
                      : is("rotary") ? random_rotary_effect(kind, plan_.study, random)
                                     : random_effect(kind, plan_.study, random);
      set_size(effect, random);
      plan_.hidden.push_back(std::move(effect));
    }
    if (is("left-out")) {
      for (const PlannedEffect& hidden : plan_.hidden)
        plan_.leave_out.push_back(catalogue_kind(hidden.effect.kind));
    }
  }

  void set_size(PlannedEffect& effect, sim::RandomStream& random) const {
    if (is("listed") || is("rotary")) effect.signal = drawn(random, kSignals);
    if (is("pairs") || is("shared") || is("axes") || is("behind"))
      effect.signal = drawn(random, kPairSignals);
    if (is("unlisted") || is("left-out")) effect.signal = drawn(random, kUnlistedSignals);
    if (is("partial")) effect.rms = drawn(random, kPartialRms);
    if (is("mdb")) {
      effect.signal = kDetectedSignal * kDetectionFactors[static_cast<std::size_t>(plan_.index / 3) % 3];
    }
  }

  int readings_;
  int attempt_;
  PlannedCampaign plan_;
  std::vector<std::string> kinds_;
};

}  // namespace

std::span<const std::string> criticism_rows() {
  static const std::vector<std::string> kRows = {
      "null",   "listed", "unlisted", "pairs",  "left-out",    "partial",       "mdb",
      "shared", "axes",   "behind",   "rotary", "rotary-null", "rotary-missing"};
  return kRows;
}

bool is_null_row(const std::string& row) { return row == "null" || row == "rotary-null"; }

std::span<const std::string> criticism_noises() {
  static const std::vector<std::string> kNoises = {"white", "drift", "line", "drift+line", "mixed"};
  return kNoises;
}

PlannedCampaign plan_campaign(const std::string& row, int index, std::uint64_t seed, int readings,
                              int attempt) {
  return Planner(row, index, seed, readings, attempt).plan();
}

}  // namespace volcal::studies
