#pragma once
/// The figures of the study, counted from its campaigns.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
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

/// The right one is in a set of more than three, and more than three of its members leave less than
/// kUndetectable of the one effect that is hidden: no judge of these readings chooses fewer.
bool readings_leave_many(const CampaignRecord& record);

/// A share with its 95 % interval (Wilson 1927, JASA 22, 209).
struct Share {
  int count = 0;
  int of = 0;
  /// In place of Wilson's, where what is counted comes in campaigns and is alike in each.
  std::optional<std::pair<double, double>> between_campaigns = {};

  double value() const { return of > 0 ? static_cast<double>(count) / of : 0.0; }
  std::pair<double, double> interval() const;
  std::string text() const;  ///< "97.0 % (94.3 to 98.4), 388 of 400"
};

using Campaigns = std::vector<CampaignRecord>;
Share share_of(const Campaigns& campaigns, const std::function<bool(const CampaignRecord&)>& counted,
               const std::function<bool(const CampaignRecord&)>& among);

/// One line of the table.
struct Figure {
  std::string what;
  Share share;
  std::string goal;
};
std::vector<Figure> figures_of(const Campaigns& campaigns);

/// (MS_given - left) / (MS_given - MS_oracle); needs `recovery`. `left`: ms_named, or ms_told.
double recovered_share(const CampaignRecord& record, double left);

/// Amplitude found with 80 % power over the stated one, by a probit line through all campaigns.
struct Detection {
  std::string effect;
  int campaigns = 0;
  double ratio = 0.0;  ///< NaN when it is unknown
  double low = 0.0;    ///< 95 % interval
  double high = 0.0;
};
std::vector<Detection> detections_of(const Campaigns& campaigns);

/// What was hidden -> what was said -> how often.
std::map<std::string, std::map<std::string, int>> confusion_of(const Campaigns& campaigns);

}  // namespace volcal::studies
