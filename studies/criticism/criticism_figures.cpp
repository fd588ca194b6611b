#include "volcal/studies/criticism/criticism_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>

#include "volcal/studies/criticism/criticism_plan.h"

namespace volcal::studies {
namespace {

constexpr double kRecovered = 0.9;
constexpr const char* kNamedGoal = ">= 97 %";
constexpr const char* kWrongGoal = "<= 1 %";
constexpr const char* kIntervalGoal = "93 to 97 %";

/// First word: the kind.
std::string kind_of(const std::string& text) { return text.substr(0, text.find_first_of(" :")); }

/// Amplitudes of effects that were named rightly by their name, with parameters of the shape or without.
Share coverage(const Campaigns& campaigns, bool scanned) {
  Share share;
  for (const CampaignRecord& record : campaigns) {
    if (record.row != "listed" || signal_of(record) < 4.999) continue;
    for (const AnswerRecord& answer : record.named) {
      if (!answer.by_name || answer.scanned != scanned) continue;
      for (const AmplitudeRecord& amplitude : answer.amplitudes) {
        share.count += std::abs(amplitude.value - amplitude.truth) <= kNormal95 * amplitude.u ? 1 : 0;
        ++share.of;
      }
    }
  }
  return share;
}

/// Readings inside the band of what was drawn, one surface that stands for all that is hidden; the interval
/// is that of the mean over campaigns.
Share band_coverage(const Campaigns& campaigns) {
  Share share;
  std::vector<double> shares;
  for (const CampaignRecord& record : campaigns) {
    if (record.band_of == 0) continue;
    share.count += record.band_inside;
    share.of += record.band_of;
    shares.push_back(static_cast<double>(record.band_inside) / record.band_of);
  }
  if (shares.size() < 2) return share;
  double squares = 0.0;
  for (const double each : shares) squares += std::pow(each - share.value(), 2);
  const auto count = static_cast<double>(shares.size());
  const double half = kNormal95 * std::sqrt(squares / (count * (count - 1.0)));
  share.between_campaigns = {std::max(0.0, share.value() - half), std::min(1.0, share.value() + half)};
  return share;
}

/// Of what has no name and is a product of elementary functions.
bool has_law(const CampaignRecord& record) {
  static const std::set<std::string> kKinds = {
      "temperature-squared", "cross-kink", "backlash-kink", "position-step",
      "thermal-tilt",        "cross-wave", "air-index"};
  return record.row == "unlisted" && !record.hidden.empty() &&
         kKinds.contains(kind_of(record.hidden.front().text));
}

bool is_true_law(const LawRecord& law) { return law.remainder < kUndetectable; }

/// The second of row behind, by its name or as one of few.
bool found_behind(const CampaignRecord& record) {
  const auto is_it = [](const AnswerRecord& answer) { return answer.hidden == 1; };
  if (std::ranges::any_of(record.named, is_it)) return true;
  return std::ranges::any_of(record.sets, [&](const std::vector<AnswerRecord>& set) {
    return set.size() <= kLargestSet && std::ranges::any_of(set, is_it);
  });
}

CampaignTest has_outcome(std::initializer_list<Outcome> which) {
  return [set = std::set<Outcome>(which)](const CampaignRecord& record) {
    return set.contains(outcome_of(record));
  };
}

CampaignTest in_row(const std::string& name, double least_signal = 0.0, double most_signal = 1e9) {
  return [=](const CampaignRecord& record) {
    const double signal = signal_of(record);
    return record.row == name && signal >= least_signal - 1e-6 && signal <= most_signal + 1e-6;
  };
}

CampaignTest is_right() { return has_outcome({Outcome::Right, Outcome::RightInSet}); }

CampaignTest is_right_in_classes() {
  return has_outcome({Outcome::Right, Outcome::RightInSet, Outcome::RightInClasses});
}

CampaignTest is_unknown() { return has_outcome({Outcome::Unknown}); }

bool is_wrong(const CampaignRecord& record) { return outcome_of(record) == Outcome::Wrong; }

bool is_alarm(const CampaignRecord& record) { return outcome_of(record) != Outcome::Right; }

bool is_misnamed(const CampaignRecord& record) {
  return is_wrong(record) && remainder_of(record) >= kUndetectable;
}

bool is_misnamed_plainly(const CampaignRecord& record) {
  return is_misnamed(record) && record.verdict == "NAMED";
}

/// Other names explain what is hidden as well as the right ones.
bool is_explained_otherwise(const CampaignRecord& record) {
  return is_wrong(record) && remainder_of(record) < kUndetectable;
}

bool is_reported(const CampaignRecord& record) {
  const bool by_names = !record.named.empty() || record.verdict == "ONE_OF";
  return outcome_of(record) == Outcome::Unknown || (by_names && remainder_of(record) < kUndetectable);
}

/// Share of the systematic error that a model removes; `left`: what it leaves, um^2.
CampaignTest recovers(double CampaignRecord::*left) {
  return [left](const CampaignRecord& record) { return recovered_share(record, record.*left) >= kRecovered; };
}

/// The lines of the table that have campaigns.
class FigureTable {
 public:
  explicit FigureTable(const Campaigns& campaigns) : campaigns_(campaigns) {}

  void add(const std::string& what, const CampaignTest& counted, const CampaignTest& among,
           const char* goal) {
    add(what, share_of(campaigns_, counted, among), goal);
  }
  void add(const std::string& what, const Share& share, const char* goal) {
    if (share.of > 0) figures_.push_back({what, share, goal});
  }

  void add_listed();
  void add_nothing_hidden();
  void add_rotary_axes();
  void add_outside_catalogue(const std::string& row, const std::string& title);
  void add_common_causes();
  void add_laws();
  void add_two_effects();
  void add_removed_error();
  void add_intervals_of_amplitudes();
  void add_partial(const std::string& layout);

  std::vector<Figure> figures() && { return std::move(figures_); }

 private:
  const Campaigns& campaigns_;
  std::vector<Figure> figures_;
};

void FigureTable::add_listed() {
  add("right name or in a set of up to 3, s >= 7", is_right(), in_row("listed", 7.0), kNamedGoal);
  for (const double s : {5.0, 7.0, 10.0, 12.0, 15.0, 20.0, 30.0}) {
    add(fmt::format("  s = {:g}", s), is_right(), in_row("listed", s, s), s >= 7.0 ? kNamedGoal : "");
  }
  add("  the same in these readings counted once", is_right_in_classes(), in_row("listed", 7.0), kNamedGoal);
  add(
      "  or in a set of which over 3 leave under 4 sigma of it",
      [right = is_right_in_classes()](const CampaignRecord& record) {
        return right(record) || readings_leave_many(record);
      },
      in_row("listed", 7.0), "");
  add("right name, but more is said to remain, s >= 7", has_outcome({Outcome::MoreRemains}),
      in_row("listed", 7.0), "");
  add("wrong confident name, any s", is_wrong, in_row("listed"), kWrongGoal);
}

void FigureTable::add_nothing_hidden() {
  add("false alarm, nothing hidden", is_alarm, in_row("null"), kWrongGoal);
  for (const std::string& noise : criticism_noises()) {
    add(
        "  noise: " + noise, is_alarm,
        [&](const CampaignRecord& record) { return record.row == "null" && record.noise == noise; },
        kWrongGoal);
  }
}

void FigureTable::add_rotary_axes() {
  add("rotary axes: right name or in a set of up to 3, s >= 7", is_right(), in_row("rotary", 7.0),
      kNamedGoal);
  add("  a wrong name, any s", is_wrong, in_row("rotary"), kWrongGoal);
  add("rotary axes, nothing hidden: false alarm", is_alarm, in_row("rotary-null"), kWrongGoal);
  add("rotary errors missing from the model: reported",
      has_outcome({Outcome::Right, Outcome::RightInSet, Outcome::MoreRemains}), in_row("rotary-missing"),
      kNamedGoal);
  add("  a wrong name", is_wrong, in_row("rotary-missing"), kWrongGoal);
}

void FigureTable::add_outside_catalogue(const std::string& row, const std::string& title) {
  const CampaignTest among = in_row(row);
  add(title + ": unknown, right variables and axis", is_unknown(), among, ">= 90 %");
  add("  or explained by names that leave under 4 sigma of it", is_reported, among, "");
  add(title + ": unknown", has_outcome({Outcome::Unknown, Outcome::UnknownOther}), among, "");
  add(title + ": misnamed", is_misnamed, among, "<= 3 %");
  add("  without saying that more remains", is_misnamed_plainly, among, "");
  add(title + ": named by what leaves under 4 sigma of it", is_explained_otherwise, among, "");
  add(title + ": one of several",
      has_outcome({Outcome::WrongSet, Outcome::LargeSet, Outcome::RightInSet, Outcome::RightInClasses}),
      among, "");
  add(title + ": nothing above", has_outcome({Outcome::NothingExceeds, Outcome::NotVisible}), among, "");
}

void FigureTable::add_common_causes() {
  add("one cause in several places: right name or in a set of up to 3", is_right(), in_row("shared"),
      ">= 90 %");
  add("  its driver alone: right name", has_outcome({Outcome::Right}), in_row("shared"), ">= 90 %");
  add("  a wrong name", is_wrong, in_row("shared"), "");
  add("one cause on all axes: right name or in a set of up to 3", is_right(), in_row("axes"), ">= 90 %");
  add("  a wrong name", is_wrong, in_row("axes"), "");
}

void FigureTable::add_laws() {
  add(
      "a law in the grammar: proposed, or one equal in the readings",
      [](const CampaignRecord& record) { return std::ranges::any_of(record.laws, is_true_law); }, has_law,
      ">= 80 %");
  add(
      "  a law that leaves 4 sigma or more as the sole proposal",
      [](const CampaignRecord& record) {
        return record.laws.size() == 1 && !is_true_law(record.laws.front());
      },
      in_row("unlisted"), "<= 3 %");
  add("readings inside the 95 % band of what was drawn", band_coverage(campaigns_), kIntervalGoal);
}

void FigureTable::add_two_effects() {
  add("behind what is in no catalogue: name found, or in a set of up to 3", found_behind,
      in_row("behind", 12.0), ">= 90 %");
  add("  a wrong name", is_wrong, in_row("behind"), "");
  add("two hidden, both and nothing else", has_outcome({Outcome::Right}), in_row("pairs"), kNamedGoal);
  add("  by name or in a set of up to 3", is_right(), in_row("pairs"), kNamedGoal);
  add("  the same in these readings counted once", is_right_in_classes(), in_row("pairs"), kNamedGoal);
  add("two hidden, a wrong name", is_wrong, in_row("pairs"), "");
}

void FigureTable::add_removed_error() {
  const CampaignTest listed = in_row("listed", 12.0);
  const CampaignTest by_names = recovers(&CampaignRecord::ms_named),
                     by_all_offered = recovers(&CampaignRecord::ms_offered);
  add("recovered share >= 0.9, s >= 12", by_names, listed, kNamedGoal);
  add(
      "  verdict NAMED", by_names,
      [&](const CampaignRecord& record) { return listed(record) && record.verdict == "NAMED"; }, kNamedGoal);
  add("  the first name of every set added as well", recovers(&CampaignRecord::ms_told), listed, kNamedGoal);
  for (const char* row : {"listed", "unlisted", "left-out", "pairs", "shared", "axes", "behind", "rotary"}) {
    add(fmt::format("the model offered recovers >= 0.9, s >= 12: {}", row), by_all_offered, in_row(row, 12.0),
        kNamedGoal);
  }
  add("  rotary errors missing from the model", by_all_offered, in_row("rotary-missing"), kNamedGoal);
}

void FigureTable::add_intervals_of_amplitudes() {
  add("amplitude inside its 95 % interval, s >= 5", coverage(campaigns_, false), kIntervalGoal);
  add("  effects whose shape was scanned", coverage(campaigns_, true), kIntervalGoal);
}

void FigureTable::add_partial(const std::string& layout) {
  const auto among = [&](const CampaignRecord& record) {
    return record.row == "partial" && record.layout == layout;
  };
  add(layout + ": wrong confident name", is_wrong, among, "");
  add(layout + ": right name or in a set of up to 3", is_right(), among, "");
  add(layout + ": not visible, or nothing above", has_outcome({Outcome::NotVisible, Outcome::NothingExceeds}),
      among, "");
}

}  // namespace

std::pair<double, double> Share::interval() const {
  if (of == 0) return {0.0, 1.0};
  if (between_campaigns) return *between_campaigns;
  const double z = kNormal95 * kNormal95;
  const double n = of, p = value();
  const double centre = (p + 0.5 * z / n) / (1.0 + z / n);
  const double half = kNormal95 / (1.0 + z / n) * std::sqrt(p * (1.0 - p) / n + 0.25 * z / (n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

std::string Share::text() const {
  if (of == 0) return "-";
  const auto [low, high] = interval();
  return fmt::format("{:.1f} % ({:.1f} to {:.1f}), {} of {}", 100.0 * value(), 100.0 * low, 100.0 * high,
                     count, of);
}

Share share_of(const Campaigns& campaigns, const CampaignTest& counted, const CampaignTest& among) {
  Share share;
  for (const CampaignRecord& record : campaigns) {
    if (!record.failure.empty() || !among(record)) continue;
    ++share.of;
    share.count += counted(record) ? 1 : 0;
  }
  return share;
}

std::vector<Figure> figures_of(const Campaigns& campaigns) {
  FigureTable table(campaigns);
  table.add_listed();
  table.add_nothing_hidden();
  table.add_rotary_axes();
  table.add_outside_catalogue("unlisted", "not in the catalogue");
  table.add_outside_catalogue("left-out", "kind left out on purpose");
  table.add_common_causes();
  table.add_laws();
  table.add_two_effects();
  table.add_removed_error();
  table.add_intervals_of_amplitudes();
  for (const char* layout : {"ball-bar only", "diagonals only"}) table.add_partial(layout);
  return std::move(table).figures();
}

std::map<std::string, std::map<std::string, int>> confusion_of(const Campaigns& campaigns) {
  std::map<std::string, std::map<std::string, int>> confusion;
  for (const CampaignRecord& record : campaigns) {
    std::string hidden;
    for (const HiddenRecord& each : record.hidden)
      hidden += (hidden.empty() ? "" : " + ") + kind_of(each.text);
    if (hidden.empty()) hidden = "nothing, " + record.noise + " noise";
    if (record.row == "pairs" || record.row == "behind") hidden = "two effects";
    const Outcome outcome = outcome_of(record);
    std::string said = to_string(outcome);
    if (outcome == Outcome::Wrong) {
      for (const AnswerRecord& answer : record.named) {
        if (answer.hidden >= 0) continue;
        said += ": " + kind_of(answer.name);
        break;
      }
    }
    ++confusion[record.row + " | " + hidden][said];
  }
  return confusion;
}

}  // namespace volcal::studies
