#include "volcal/studies/criticism/criticism_outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace volcal::studies {
namespace {

bool all_right(const std::vector<AnswerRecord>& answers) {
  return std::ranges::all_of(answers, [](const AnswerRecord& answer) { return answer.hidden >= 0; });
}

/// Effects that are one and the same in the readings have the same gain.
std::size_t distinguishable(const std::vector<AnswerRecord>& answers) {
  constexpr double kSameGain = 0.02;
  std::vector<double> gains;
  for (const AnswerRecord& answer : answers) {
    const bool known =
        std::ranges::any_of(gains, [&](double gain) { return std::abs(gain - answer.gain) < kSameGain; });
    if (!known) gains.push_back(answer.gain);
  }
  return gains.size();
}

bool everything_named(const CampaignRecord& record) {
  std::set<int> found;
  for (const AnswerRecord& answer : record.named) found.insert(answer.hidden);
  found.erase(-1);
  return found.size() == record.hidden.size();
}

/// By its name or as one of a set, nothing else and nothing twice.
bool everything_found(const CampaignRecord& record) {
  std::set<int> found;
  for (const AnswerRecord& answer : record.named) found.insert(answer.hidden);
  for (const auto& set : record.sets) {
    for (const AnswerRecord& answer : set) found.insert(answer.hidden);
  }
  found.erase(-1);
  return found.size() == record.hidden.size() &&
         record.named.size() + record.sets.size() == record.hidden.size();
}

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::ranges::find(list, text) != list.end();
}

/// The leading finding names a driver of what is hidden and nothing that has no part in it.
bool right_variables(const CampaignRecord& record) {
  if (record.unknown.empty()) return false;
  const UnknownRecord& unknown = record.unknown.front();
  return std::ranges::any_of(record.hidden, [&](const HiddenRecord& hidden) {
    const bool driver = std::ranges::any_of(
        unknown.variables, [&](const std::string& name) { return contains(hidden.drivers, name); });
    const bool only = std::ranges::all_of(unknown.variables, [&](const std::string& name) {
      return contains(hidden.drivers, name) || contains(hidden.companions, name);
    });
    return driver && only && contains(hidden.directions, unknown.direction);
  });
}

/// Every set must hold something that is there; the largest counts.
Outcome outcome_of_sets(const CampaignRecord& record) {
  const auto& sets = record.sets;
  if (!std::ranges::all_of(sets, any_right)) return Outcome::WrongSet;
  if (record.named.size() + sets.size() < record.hidden.size()) return Outcome::Part;
  const auto up_to_largest = [](std::size_t size) { return size <= kLargestSet; };
  if (std::ranges::all_of(sets, up_to_largest, &std::vector<AnswerRecord>::size)) return Outcome::RightInSet;
  return std::ranges::all_of(sets, up_to_largest, distinguishable) ? Outcome::RightInClasses
                                                                   : Outcome::LargeSet;
}

}  // namespace

std::string to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::Right:
      return "right";
    case Outcome::RightInSet:
      return "right, in a set of up to 3";
    case Outcome::RightInClasses:
      return "right, in a set of up to 3 that differ";
    case Outcome::MoreRemains:
      return "right, more remains";
    case Outcome::LargeSet:
      return "in a set of over 3";
    case Outcome::WrongSet:
      return "set without it";
    case Outcome::Part:
      return "right, one missed";
    case Outcome::Unknown:
      return "unknown, right variables";
    case Outcome::UnknownOther:
      return "unknown, other variables";
    case Outcome::NothingExceeds:
      return "nothing above";
    case Outcome::NotVisible:
      return "not visible";
    case Outcome::Wrong:
      return "wrong name";
    case Outcome::NoDiagnosis:
      return "no diagnosis";
  }
  return "";
}

Outcome outcome_of(const CampaignRecord& record) {
  if (!record.failure.empty()) return Outcome::NoDiagnosis;
  if (!all_right(record.named)) return Outcome::Wrong;
  const bool silent = record.verdict == "NOTHING_ABOVE" || record.verdict == "NOT_VISIBLE";
  if (record.hidden.empty() && silent) return Outcome::Right;
  if (record.verdict == "NOTHING_ABOVE") return Outcome::NothingExceeds;
  if (record.verdict == "NOT_VISIBLE") return Outcome::NotVisible;
  if (record.verdict == "UNKNOWN") return right_variables(record) ? Outcome::Unknown : Outcome::UnknownOther;
  if (record.verdict == "ONE_OF") return outcome_of_sets(record);
  if (record.verdict == "NAMED_MORE_REMAINS") {
    return record.unknown.empty() && everything_found(record) ? outcome_of_sets(record)
                                                              : Outcome::MoreRemains;
  }
  return everything_named(record) ? Outcome::Right : Outcome::Part;
}

double remainder_of(const CampaignRecord& record) {
  double squares = 0.0;
  for (const HiddenRecord& hidden : record.hidden) squares += hidden.signal * hidden.signal;
  return std::sqrt(squares * std::max(0.0, 1.0 - record.told_explain));
}

bool any_right(const std::vector<AnswerRecord>& answers) {
  return std::ranges::any_of(answers, [](const AnswerRecord& answer) { return answer.hidden >= 0; });
}

double signal_of(const CampaignRecord& record) {
  double least = std::numeric_limits<double>::infinity();
  for (const HiddenRecord& hidden : record.hidden) least = std::min(least, hidden.signal);
  return record.hidden.empty() ? 0.0 : least;
}

bool readings_leave_many(const CampaignRecord& record) {
  if (record.hidden.size() != 1 || outcome_of(record) != Outcome::LargeSet) return false;
  const double signal = record.hidden.front().signal;
  return std::ranges::all_of(record.sets, [&](const std::vector<AnswerRecord>& set) {
    const auto as_good = std::ranges::count_if(set, [&](const AnswerRecord& answer) {
      return signal * std::sqrt(std::max(0.0, 1.0 - answer.explains)) < kUndetectable;
    });
    return as_good > static_cast<std::ptrdiff_t>(kLargestSet);
  });
}

double recovered_share(const CampaignRecord& record, double left) {
  const double possible = record.ms_given - record.ms_oracle;
  return possible > 0.0 ? (record.ms_given - left) / possible : 0.0;
}

}  // namespace volcal::studies
