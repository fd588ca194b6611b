#include "volcal/studies/five_axis.h"

#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/studies/files/finished_campaigns.h"
#include "volcal/studies/files/five_axis_machines.h"
#include "volcal/studies/five_axis_campaign.h"

namespace volcal::studies {
namespace {

constexpr std::uint64_t kNoiseSeed = 500000, kPoseSeed = 900000;
constexpr double kResidualLength = 1e-6;  // m, of linear axes
constexpr double kResidualAngle = 2e-6;   // rad

/// Rotary errors alone: linear axes are known.
ModelSpec rotary_errors(const Machine& machine) {
  ModelSpec model;
  for (const ErrorSymbol symbol : linear_axis_motions(machine)) model.functions[symbol].basis = "zero";
  model.locations_off = squareness_errors(machine);
  return model;
}

ModelSpec rotary_locations(const Machine& machine) {
  ModelSpec model = rotary_errors(machine);
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    for (const Component component : kAllComponents) model.functions[{component, axis.name}].basis = "zero";
  }
  return model;
}

FitResult identified_by(const Campaign& campaign, const ModelSpec& model) {
  FitOptions options;
  options.threads = 1;
  return fit(campaign, model, options);
}

/// What the datums of a set-up leave of errors less prediction, with the prediction's covariance.
struct Judged {
  double rms = 0.0;
  double coverage = 0.0;
};

class FreshJudge {
 public:
  FreshJudge(const sim::TruthMachine& truth, std::uint64_t seed)
      : truth_(truth),
        poses_(fresh_poses(truth.machine(), seed)),
        datums_(setup_datums(truth.machine(), poses_)),
        errors_(datums_.rows()) {
    for (std::size_t pose = 0; pose < poses_.size(); ++pose)
      errors_.segment<3>(row(pose)) =
          truth.point_error(state_of(poses_[pose].position, poses_[pose].tool), tool_of(pose).offset);
  }

  double before() const { return rms_of(freed(errors_)); }

  Judged of(const FitResult& result) const {
    std::vector<ErrorField> fields;
    for (const Tool& tool : truth_.machine().tools) fields.emplace_back(result, tool);
    Eigen::MatrixXd rows(errors_.size(), result.layout.size);
    for (std::size_t pose = 0; pose < poses_.size(); ++pose)
      rows.middleRows<3>(row(pose)) = fields[poses_[pose].tool].rows(poses_[pose].position).topRows<3>();
    rows -= datums_ * (datums_.transpose() * rows).eval();
    const Eigen::VectorXd left = freed(errors_) - rows * result.parameters;
    const Eigen::VectorXd variance = (rows * result.covariance).cwiseProduct(rows).rowwise().sum();
    const auto inside = (left.array().abs() <= kCoverageFactor * variance.array().max(0.0).sqrt()).count();
    return {rms_of(left), static_cast<double>(inside) / static_cast<double>(left.size())};
  }

 private:
  static Eigen::Index row(std::size_t pose) { return 3 * static_cast<Eigen::Index>(pose); }
  const Tool& tool_of(std::size_t pose) const { return truth_.machine().tools[poses_[pose].tool]; }
  Eigen::VectorXd freed(const Eigen::VectorXd& values) const {
    return values - datums_ * (datums_.transpose() * values).eval();
  }
  double rms_of(const Eigen::VectorXd& values) const {
    return std::sqrt(values.squaredNorm() / static_cast<double>(poses_.size()));
  }

  const sim::TruthMachine& truth_;
  std::vector<FreshPose> poses_;
  Eigen::MatrixXd datums_;
  Eigen::VectorXd errors_;
};

FiveAxisCampaign counted(const FiveAxisStudyOptions& options, int number) {
  FiveAxisCampaign campaign;
  campaign.structure =
      five_axis_structures()[static_cast<std::size_t>(number) % five_axis_structures().size()];
  campaign.seed = options.seed + static_cast<std::uint64_t>(number);
  const Machine machine = five_axis_machine(campaign.structure);
  GridPlan plan;
  plan.turns = options.turns;
  plan.tilts = options.tilts;
  const std::uint64_t noise = kNoiseSeed + campaign.seed, poses = kPoseSeed + campaign.seed;

  const sim::TruthMachine alone = five_axis_truth(machine, {}, campaign.seed);
  const FitResult of_alone = identified_by(r_test_campaign(alone, plan, noise), rotary_errors(machine));
  const FreshJudge judge(alone, poses);
  campaign.before = judge.before();
  const Judged judged = judge.of(of_alone);
  campaign.after = judged.rms;
  campaign.coverage = judged.coverage;
  campaign.chi2 = of_alone.sigma0 * of_alone.sigma0;

  FiveAxisErrors beside;
  beside.linear_displacement = kResidualLength;
  beside.linear_rotation = kResidualAngle;
  const sim::TruthMachine residual = five_axis_truth(machine, beside, campaign.seed);
  const Campaign readings = r_test_campaign(residual, plan, noise);
  const FreshJudge beside_judge(residual, poses);
  campaign.before_beside = beside_judge.before();
  const Judged judged_beside = beside_judge.of(identified_by(readings, rotary_errors(machine)));
  campaign.after_beside = judged_beside.rms;
  campaign.coverage_beside = judged_beside.coverage;
  campaign.locations_only = beside_judge.of(identified_by(readings, rotary_locations(machine))).rms;

  GridPlan cycle = plan;
  cycle.spheres_w.resize(1);
  cycle.tools = 1;
  cycle.singly = true;
  campaign.one_sphere_singly =
      beside_judge.of(identified_by(r_test_campaign(residual, cycle, noise), rotary_locations(machine))).rms;
  return campaign;
}

// ---- Finished campaigns, one line of JSON each

constexpr std::array<std::pair<const char*, double FiveAxisCampaign::*>, 9> kFigures = {
    {{"before", &FiveAxisCampaign::before},
     {"after", &FiveAxisCampaign::after},
     {"coverage", &FiveAxisCampaign::coverage},
     {"chi2", &FiveAxisCampaign::chi2},
     {"before_beside", &FiveAxisCampaign::before_beside},
     {"after_beside", &FiveAxisCampaign::after_beside},
     {"coverage_beside", &FiveAxisCampaign::coverage_beside},
     {"locations_only", &FiveAxisCampaign::locations_only},
     {"one_sphere_singly", &FiveAxisCampaign::one_sphere_singly}}};

nlohmann::json json_of(const FiveAxisStudyOptions& options, std::size_t number,
                       const FiveAxisCampaign& campaign) {
  nlohmann::json json = {{"number", number},
                         {"seed", campaign.seed},
                         {"grid", {options.turns, options.tilts}},
                         {"structure", campaign.structure}};
  for (const auto& [name, member] : kFigures) {
    json[name] = campaign.*member;
  }
  return json;
}

std::pair<std::size_t, FiveAxisCampaign> numbered_campaign(const nlohmann::json& json,
                                                           const FiveAxisStudyOptions& options,
                                                           const SourcePlace& place) {
  const auto number = json.at("number").get<std::size_t>();
  FiveAxisCampaign campaign;
  campaign.seed = json.at("seed").get<std::uint64_t>();
  campaign.structure = json.at("structure").get<std::string>();
  for (const auto& [name, member] : kFigures) {
    campaign.*member = json.at(name).get<double>();
  }
  if (campaign.seed != options.seed + number ||
      json.at("grid") != nlohmann::json({options.turns, options.tilts}))
    throw InputError(place, "it holds campaigns of another seed or grid",
                     "give the same, or choose another folder");
  return {number, campaign};
}

}  // namespace

std::vector<FiveAxisCampaign> five_axis_study(const FiveAxisStudyOptions& options) {
  std::map<std::size_t, FiveAxisCampaign> known;
  FinishedCampaigns finished(options.output, "campaigns.jsonl", options.resume,
                             [&](const nlohmann::json& json, const SourcePlace& place) {
                               known.insert(numbered_campaign(json, options, place));
                             });
  return all_campaigns<FiveAxisCampaign>(
      static_cast<std::size_t>(options.campaigns), options.threads, options.progress,
      [&](std::size_t number) { return finished_before(known, number); },
      [&](std::size_t number) { return counted(options, static_cast<int>(number)); },
      [&](std::size_t number, const FiveAxisCampaign& campaign) {
        finished.append(json_of(options, number, campaign));
      });
}

}  // namespace volcal::studies
