#pragma once
/// The figures of the study, counted from its campaigns.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/studies/criticism/criticism_outcome.h"
#include "volcal/studies/criticism/criticism_record.h"

namespace volcal::studies {

/// Half width of a 95 % interval of the normal distribution, in standard deviations.
inline constexpr double kNormal95 = 1.959963984540054;

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

using CampaignTest = std::function<bool(const CampaignRecord&)>;
/// Of the campaigns that were diagnosed and are `among` those asked about, those `counted`.
Share share_of(const Campaigns& campaigns, const CampaignTest& counted, const CampaignTest& among);

/// One line of the table.
struct Figure {
  std::string what;
  Share share;
  std::string goal;
};
std::vector<Figure> figures_of(const Campaigns& campaigns);

/// What was hidden -> what was said -> how often.
std::map<std::string, std::map<std::string, int>> confusion_of(const Campaigns& campaigns);

}  // namespace volcal::studies
