#include "volcal/studies/planning.h"

#include <fmt/format.h>

#include <cmath>

#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::studies {
namespace {

constexpr std::size_t kPlannedMachines[] = {0, 1, 3};  // of the reference machines
constexpr int kVolumePoints = 5;                       // per axis
constexpr int kRefits = 2;

sim::Study study_of_layout(const PlanLayout& layout, const PlanSettings& settings, std::uint64_t seed) {
  sim::Tracking tracking;
  tracking.instrument = settings.instrument;
  tracking.noise.constant = settings.noise.constant;
  tracking.noise.per_metre = settings.noise.per_metre;
  tracking.noise.repeatability = settings.noise.repeatability;
  for (std::size_t i = 0; i < layout.stations_w.size(); ++i)
    tracking.stations.push_back({layout.station_names[i], layout.stations_w[i]});
  for (const PlanRun& run : layout.runs) {
    sim::Tracking::Run& own = tracking.runs.emplace_back();
    own.station = layout.station_names[run.station];
    own.tool = settings.machine.tools[run.tool].name;
    for (const PlanReading& reading : readings_of(run)) {
      sim::CommandedPoint point;
      point.position = reading.position;
      point.direction = reading.direction;
      point.line = reading.line;
      point.run = reading.run;
      own.points.push_back(point);
    }
  }
  sim::Study study;
  study.machine = settings.machine;
  study.seed = seed;
  study.measurements.emplace_back().settings = tracking;
  for (const Tool& tool : settings.machine.tools) study.validation.tools.push_back(tool.name);
  return study;
}

/// sqrt(mean over points and tools of u_ex^2 + u_ey^2 + u_ez^2) of the draws.
double drawn_u(const Campaign& campaign, const FitResult& result, const PlanningStudyOptions& options) {
  MonteCarloOptions drawing;
  drawing.path = DrawPath::Linear;
  drawing.draws = options.draws;
  drawing.seed = options.seed;
  drawing.threads = options.threads;
  drawing.refits = kRefits;
  drawing.grid_per_axis = kVolumePoints;
  MonteCarloStudy study(campaign, result, drawing);
  while (!study.done()) study.run_block();
  double squares = 0.0;
  for (const QuantityResult& each : study.result().quantities) {
    if (each.quantity.kind == QuantityKind::VolumetricError) squares += each.u * each.u;
  }
  const double vectors = std::pow(kVolumePoints, 3) * static_cast<double>(result.machine.tools.size());
  return std::sqrt(squares / vectors);
}

LayoutFigures figures_of(const std::string& name, const PlanLayout& layout, const PlanSettings& settings,
                         const PlanningStudyOptions& options) {
  LayoutFigures figures;
  figures.name = name;
  const FitResult expected =
      expected_result(campaign_of(layout, settings), {}, settings.roughness, options.threads);
  figures.predicted_u = volumetric_uncertainty(expected, settings.machine.tools, kVolumePoints).rms;
  double fitted = 0.0, drawn = 0.0, truth = 0.0;
  for (int i = 0; i < options.campaigns; ++i) {
    const sim::SimulatedCampaign simulated =
        sim::simulate(study_of_layout(layout, settings, options.seed + static_cast<std::uint64_t>(i)));
    FitOptions fitting;
    fitting.threads = options.threads;
    const FitResult result = fit(simulated.campaign, {}, fitting);
    if (result.status == FitStatus::RankDeficient) ++figures.invisible;
    fitted += std::pow(volumetric_uncertainty(result, settings.machine.tools, kVolumePoints).rms, 2);
    drawn += std::pow(drawn_u(simulated.campaign, result, options), 2);
    truth += std::pow(validate(simulated.validation, result, options.threads).figures.rms_after, 2);
  }
  figures.fitted_u = std::sqrt(fitted / options.campaigns);
  figures.montecarlo_u = std::sqrt(drawn / options.campaigns);
  figures.true_error = std::sqrt(truth / options.campaigns);
  return figures;
}

}  // namespace

std::vector<PlannedMachine> planning_study(const PlanningStudyOptions& options) {
  const std::vector<Machine> machines = sim::reference_machines();
  std::vector<PlannedMachine> planned;
  for (const std::size_t which : kPlannedMachines) {
    PlanSettings settings;
    settings.machine = machines[which];
    settings.budget.readings = options.readings;
    settings.seed = options.seed;
    settings.threads = options.threads;
    const double done =
        static_cast<double>(planned.size()) / static_cast<double>(std::size(kPlannedMachines));
    const auto tell = [&](const std::string& stage, double share) {
      const std::string words = fmt::format("{}: {}", settings.machine.structure.code, stage);
      if (options.progress)
        options.progress(words, done + share / static_cast<double>(std::size(kPlannedMachines)));
    };
    tell("plan", 0.0);
    const LineOfSight sight(settings);
    const PlanProblem problem(settings);
    const SearchedPlan searched = search_plan(settings, problem, sight);
    tell("campaigns of the plan", 0.4);
    PlannedMachine machine{settings.machine.structure.code, {}, {}};
    machine.plan = figures_of("plan", searched.layout, settings, options);
    tell("campaigns of the textbook", 0.7);
    machine.textbook = figures_of("textbook", textbook_layout(settings, sight), settings, options);
    planned.push_back(std::move(machine));
  }
  return planned;
}

}  // namespace volcal::studies
