#pragma once
/// What a diagnosis came to, judged against what was hidden.

#include <cstddef>
#include <string>
#include <vector>

#include "volcal/studies/criticism/criticism_record.h"

namespace volcal::studies {

/// What became of a campaign, against what was hidden.
enum class Outcome {
  Right,           ///< NAMED with all that is hidden and nothing else; with nothing hidden: silence
  RightInSet,      ///< ONE_OF of at most three, the right one among them
  RightInClasses,  ///< the same, effects that are one and the same in these readings counted once
  MoreRemains,     ///< NAMED_MORE_REMAINS, all names right
  LargeSet,        ///< ONE_OF of more than three, the right one among them
  WrongSet,        ///< ONE_OF without the right one
  Part,            ///< NAMED, all names right, something hidden is missing
  Unknown,         ///< UNKNOWN with the right variables and direction
  UnknownOther,    ///< UNKNOWN, with others
  NothingExceeds,  ///< NOTHING_ABOVE
  NotVisible,
  Wrong,  ///< a wrong effect stands among the named ones
  NoDiagnosis
};
std::string to_string(Outcome outcome);
Outcome outcome_of(const CampaignRecord& record);

/// What the names that were reported, and the first of every set of them, leave of what is hidden, in units
/// of the noise: below kUndetectable no test tells that they are not the whole truth.
inline constexpr double kUndetectable = 4.0;
double remainder_of(const CampaignRecord& record);

/// A set of up to this many alternatives counts as an answer.
inline constexpr std::size_t kLargestSet = 3;

/// The right one is in a set of more than three, and more than three of its members leave less than
/// kUndetectable of the one effect that is hidden: no judge of these readings chooses fewer.
bool readings_leave_many(const CampaignRecord& record);

/// Whether one of the answers at least is hidden.
bool any_right(const std::vector<AnswerRecord>& answers);

/// Visible signal to noise of the weakest of what is hidden; 0 with nothing hidden.
double signal_of(const CampaignRecord& record);

/// (MS_given - left) / (MS_given - MS_oracle); needs `recovery`. `left`: ms_named, or ms_told.
double recovered_share(const CampaignRecord& record, double left);

}  // namespace volcal::studies
