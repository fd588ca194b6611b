#pragma once
/// What one setup more would bring: every tool at every station that there is, every tool at a new station,
/// and a sideways tool that the machine does not have where an error is not visible.

#include <vector>

#include "volcal/identify/planning/campaign_plan.h"

namespace volcal {

struct SetupOptions {
  std::vector<PlanOption> options;     ///< best first
  PlanLayout best;                     ///< one run on an even grid, or all that are taken whole
  Machine machine;                     ///< with the tool that the best needs
  std::size_t hypothetical_tools = 0;  ///< of it
};

/// `settings.existing` is what there is, `now` what it tells. An error that it tells stays visible in every
/// option: the rank analysis of more readings may have finer functions and a longer stretch of an axis, over
/// which it asks more, but they take nothing away of what is known. An option is better the fewer errors it
/// leaves invisible, then the smaller the target. The twelve best are listed. `settings.progress` is called
/// from any thread.
SetupOptions setup_options(const PlanSettings& settings, const ExpectedCampaign& now);

/// The positions of a layout's runs chosen anew among a fine grid, as many as there are; runs that are taken
/// whole as they are.
PlanLayout with_chosen_positions(const PlanSettings& settings, const PlanLayout& layout);

/// Adds stations and runs of `more`; stations of one name are one.
void append(const PlanLayout& more, PlanLayout& layout);

}  // namespace volcal
