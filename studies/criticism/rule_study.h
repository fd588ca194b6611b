#pragma once
/// What the rules of the search are worth: one fixed set of campaigns of all rows, diagnosed with every rule
/// and then without each in turn; resumable: every finished campaign is a line of rules.jsonl in the output
/// folder.
///
/// A campaign in which a rule decided nothing is diagnosed alike without it, to the bit (search_rules.h), and
/// is not diagnosed again. Rows and indices are those of criticism.h, in turn, so that a part of the set
/// holds all rows.

#include <map>
#include <string>
#include <vector>

#include "volcal/studies/criticism/criticism.h"
#include "volcal/studies/criticism/criticism_record.h"

namespace volcal::studies {

struct RuleCampaign {
  CampaignRecord all;                             ///< every rule followed
  double seconds = 0.0;                           ///< of a processor, for the diagnosis
  std::vector<std::string> decided;               ///< rules that decided something in it
  std::map<std::string, CampaignRecord> without;  ///< by each of these
  std::map<std::string, double> seconds_without;
};

struct RuleStudyOptions : CriticisedCampaigns {
  std::vector<std::string> rules;  ///< that are left out in turn
};

/// Throws InputError for an output folder that holds campaigns already (without `resume`), or campaigns of
/// another seed, size or rules (with it).
std::vector<RuleCampaign> rule_study(const RuleStudyOptions& options);

/// What diagnoses of a set of campaigns report.
struct RuleCounts {
  int right = 0;    ///< names, sets of up to three; of what no catalogue holds its variables and axis
  int wrong = 0;    ///< a name is wrong, and what is reported leaves 4 sigma or more of what is hidden
  int alarms = 0;   ///< nothing was hidden, and something is reported
  int removed = 0;  ///< campaigns whose systematic error the offered model removes to 0.9
  int of_removed = 0;
  double seconds = 0.0;
};

struct RuleRow {
  std::string rule;  ///< empty: every rule followed
  int decided = 0;   ///< campaigns in which it decided something
  int changed = 0;   ///< of them, those that are diagnosed otherwise without it
  RuleCounts counts;
};

/// The first row with every rule, then one a rule.
std::vector<RuleRow> rows_of(const std::vector<RuleCampaign>& campaigns,
                             const std::vector<std::string>& rules);

}  // namespace volcal::studies
