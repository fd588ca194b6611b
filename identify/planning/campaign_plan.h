#pragma once
/// Which campaign to measure: stations, tools and positions that make what the user names as certain as the
/// budget allows, what it will show, and what the textbook's layout and the user's own would show instead.
///
/// The search works on a small linear problem (plan_problem.h); figures come from the adjustment of the whole
/// campaign (expected_result.h), so that they are those that `fit` will state. When an error is not visible
/// whatever the budget's tools and stations do, everything that could be added is tried: tools of the machine
/// that the plan does not use, sideways ones that it does not have, further stations.

#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/planning/expected_result.h"
#include "volcal/identify/planning/plan_search.h"

namespace volcal {

/// A campaign and what it would tell. SI.
struct ExpectedCampaign {
  std::string name;  ///< "plan", "textbook", "given"
  Campaign campaign;
  FitResult result;
  VolumetricUncertainty volumetric;
  double target_u = 0.0;        ///< standard uncertainty of the target; PlanTarget::Separate: see separation
  double worst_length = 0.0;    ///< largest u of a table value, m
  double worst_angle = 0.0;     ///< rad
  std::string worst_length_at;  ///< "EXX at 400 mm"
  std::string worst_angle_at;
  double duration = 0.0;  ///< s; NaN when not planned here
  std::vector<DetectableEffect> detectable;

  std::vector<MachineError> invisible() const;
};

/// One setup more.
struct PlanOption {
  Finding what;  ///< "plan.setup-more"
  bool new_station = false;
  bool new_tool = false;  ///< that the machine file does not have
  std::size_t readings = 0;
  double volumetric_rms = 0.0;  ///< m, with it
  std::vector<MachineError> made_visible;
  std::vector<MachineError> still_invisible;
};

/// What the search found, where the textbook's layout turned out surer and took its place.
struct ReplacedPlan {
  double target_ratio = 0.0;            ///< of its uncertainty of the target to the textbook's
  std::vector<MachineError> invisible;  ///< what it would not determine
};

struct CampaignPlan {
  PlanSettings settings;  ///< with the tools that an option added
  SearchedPlan searched;
  ExpectedCampaign plan;
  ExpectedCampaign textbook;              ///< without existing readings; of no use when the plan extends some
  std::optional<ExpectedCampaign> given;  ///< the user's plan, or what there is before it is extended
  std::optional<ReplacedPlan> replaced;   ///< the plan is the textbook's
  std::vector<PlanOption> options;        ///< best first; when an error is not visible, or when extending
  std::vector<Finding> findings;          ///< what the plan takes as known
  std::vector<Finding> notes;             ///< on the files of the given campaign (Campaign::notes)
};

/// Stage of the progress in which OptionsNotWanted may be thrown.
inline constexpr const char* kLookingForOptions = "what would make errors visible";

/// The plan that the search found is the better one on the small problem that it works on. Where figures of
/// the whole campaigns say otherwise, the textbook's layout, of the same tools and within the same budget,
/// becomes the plan: where that alone determines every error, which a plan for one error or for two effects
/// may give up, or the target is surer.
void keep_the_surer(const PlanLayout& textbook, CampaignPlan& plan);

/// `given`: a campaign to compare with, or null. Throws InputError.
CampaignPlan plan_campaign(const PlanSettings& settings, const Campaign* given);

/// Adds to settings.existing as many setups as the budget has stations, each the one that makes most errors
/// visible and then the target most certain, of: every tool at every station that there is, the machine's
/// tools and a sideways one at a new station.
CampaignPlan extend_campaign(const PlanSettings& settings);

ExpectedCampaign expected_campaign(const std::string& name, const Campaign& campaign,
                                   const PlanSettings& settings, bool effects);

}  // namespace volcal
