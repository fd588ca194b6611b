#include "volcal/studies/criticism/criticism_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "volcal/studies/criticism/criticism_plan.h"

namespace volcal::studies {
namespace {

constexpr std::size_t kLargestSet = 3;
constexpr double kRecovered = 0.9;
constexpr double kNormal95 = 1.959963984540054;
constexpr double kPowerQuantile = 0.8416212335729143;  // of the normal distribution at 80 %

bool all_right(const std::vector<AnswerRecord>& answers) {
  return std::ranges::all_of(answers, [](const AnswerRecord& answer) { return answer.hidden >= 0; });
}

bool any_right(const std::vector<AnswerRecord>& answers) {
  return std::ranges::any_of(answers, [](const AnswerRecord& answer) { return answer.hidden >= 0; });
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

double signal_of(const CampaignRecord& record) {
  double least = std::numeric_limits<double>::infinity();
  for (const HiddenRecord& hidden : record.hidden) least = std::min(least, hidden.signal);
  return record.hidden.empty() ? 0.0 : least;
}

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

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

struct Trial {
  double ratio = 0.0;  ///< amplitude over the stated detectable one
  bool found = false;
};

/// Maximum likelihood of P = Phi(b0 + b1 ratio) by Fisher scoring (Finney 1971, Probit Analysis), and the
/// ratio at 80 %.
Detection probit(const std::vector<Trial>& trials) {
  constexpr int kSteps = 50;
  Detection out;
  out.campaigns = static_cast<int>(trials.size());
  out.ratio = out.low = out.high = std::numeric_limits<double>::quiet_NaN();
  double b0 = -3.0, b1 = 4.0;
  double i00 = 0.0, i01 = 0.0, i11 = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    double g0 = 0.0, g1 = 0.0;
    i00 = i01 = i11 = 0.0;
    for (const Trial& trial : trials) {
      const double line = std::clamp(b0 + b1 * trial.ratio, -6.0, 6.0);
      const double p = normal_distribution(line);
      const double density = std::exp(-0.5 * line * line) / std::sqrt(2.0 * std::numbers::pi);
      const double score = density * ((trial.found ? 1.0 : 0.0) - p) / (p * (1.0 - p));
      const double weight = density * density / (p * (1.0 - p));
      g0 += score;
      g1 += score * trial.ratio;
      i00 += weight;
      i01 += weight * trial.ratio;
      i11 += weight * trial.ratio * trial.ratio;
    }
    const double determinant = i00 * i11 - i01 * i01;
    if (!(determinant > 1e-9)) return out;
    b0 += std::clamp((i11 * g0 - i01 * g1) / determinant, -2.0, 2.0);
    b1 += std::clamp((i00 * g1 - i01 * g0) / determinant, -2.0, 2.0);
  }
  if (!(b1 > 0.0)) return out;
  const double determinant = i00 * i11 - i01 * i01;
  out.ratio = (kPowerQuantile - b0) / b1;
  const double variance =
      (i11 - 2.0 * out.ratio * i01 + out.ratio * out.ratio * i00) / determinant / (b1 * b1);
  out.low = out.ratio - kNormal95 * std::sqrt(variance);
  out.high = out.ratio + kNormal95 * std::sqrt(variance);
  return out;
}

const AnswerRecord* answer_for(const CampaignRecord& record) {
  std::vector<const std::vector<AnswerRecord>*> lists = {&record.named};
  for (const auto& set : record.sets) lists.push_back(&set);
  lists.push_back(&record.ranking);
  for (const auto* list : lists) {
    for (const AnswerRecord& answer : *list) {
      if (answer.by_name && !answer.amplitudes.empty()) return &answer;
    }
  }
  return nullptr;
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

Share share_of(const Campaigns& campaigns, const std::function<bool(const CampaignRecord&)>& counted,
               const std::function<bool(const CampaignRecord&)>& among) {
  Share share;
  for (const CampaignRecord& record : campaigns) {
    if (!record.failure.empty() || !among(record)) continue;
    ++share.of;
    share.count += counted(record) ? 1 : 0;
  }
  return share;
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

std::vector<Figure> figures_of(const Campaigns& campaigns) {
  std::vector<Figure> figures;
  const auto outcome = [](std::initializer_list<Outcome> which) {
    return [set = std::set<Outcome>(which)](const CampaignRecord& record) {
      return set.contains(outcome_of(record));
    };
  };
  const auto row = [](const std::string& name, double least = 0.0, double most = 1e9) {
    return [=](const CampaignRecord& record) {
      const double signal = signal_of(record);
      return record.row == name && signal >= least - 1e-6 && signal <= most + 1e-6;
    };
  };
  const auto add = [&](const std::string& what, const auto& counted, const auto& among, const char* goal) {
    const Share share = share_of(campaigns, counted, among);
    if (share.of > 0) figures.push_back({what, share, goal});
  };
  const auto right = outcome({Outcome::Right, Outcome::RightInSet});
  const auto wrong = outcome({Outcome::Wrong});
  add("right name or in a set of up to 3, s >= 7", right, row("listed", 7.0), ">= 97 %");
  for (const double s : {5.0, 7.0, 10.0, 12.0, 15.0, 20.0, 30.0}) {
    add(fmt::format("  s = {:g}", s), right, row("listed", s, s), s >= 7.0 ? ">= 97 %" : "");
  }
  const auto right_in_classes = outcome({Outcome::Right, Outcome::RightInSet, Outcome::RightInClasses});
  add("  the same in these readings counted once", right_in_classes, row("listed", 7.0), ">= 97 %");
  add(
      "  or in a set of which over 3 leave under 4 sigma of it",
      [&](const CampaignRecord& record) { return right_in_classes(record) || readings_leave_many(record); },
      row("listed", 7.0), "");
  add("right name, but more is said to remain, s >= 7", outcome({Outcome::MoreRemains}), row("listed", 7.0),
      "");
  add("wrong confident name, any s", wrong, row("listed"), "<= 1 %");
  const auto alarm = [](const CampaignRecord& record) { return outcome_of(record) != Outcome::Right; };
  add("false alarm, nothing hidden", alarm, row("null"), "<= 1 %");
  for (const std::string& noise : criticism_noises()) {
    add(
        "  noise: " + noise, alarm,
        [&](const CampaignRecord& record) { return record.row == "null" && record.noise == noise; },
        "<= 1 %");
  }
  add("rotary axes: right name or in a set of up to 3, s >= 7", right, row("rotary", 7.0), ">= 97 %");
  add("  a wrong name, any s", wrong, row("rotary"), "<= 1 %");
  add("rotary axes, nothing hidden: false alarm", alarm, row("rotary-null"), "<= 1 %");
  const auto told_missing = outcome({Outcome::Right, Outcome::RightInSet, Outcome::MoreRemains});
  add("rotary errors missing from the model: reported", told_missing, row("rotary-missing"), ">= 97 %");
  add("  a wrong name", wrong, row("rotary-missing"), "<= 1 %");
  const auto misnamed = [](const CampaignRecord& record) {
    return outcome_of(record) == Outcome::Wrong && remainder_of(record) >= kUndetectable;
  };
  const auto misnamed_plainly = [&](const CampaignRecord& record) {
    return misnamed(record) && record.verdict == "NAMED";
  };
  const auto as_good = [](const CampaignRecord& record) {
    return outcome_of(record) == Outcome::Wrong && remainder_of(record) < kUndetectable;
  };
  const auto unknown = outcome({Outcome::Unknown});
  const auto reported = [&](const CampaignRecord& record) {
    const bool by_names = !record.named.empty() || record.verdict == "ONE_OF";
    return unknown(record) || (by_names && remainder_of(record) < kUndetectable);
  };
  const auto any_unknown = outcome({Outcome::Unknown, Outcome::UnknownOther});
  const std::pair<const char*, const char*> strangers[] = {{"unlisted", "not in the catalogue"},
                                                           {"left-out", "kind left out on purpose"}};
  for (const auto& [name, title] : strangers) {
    add(std::string(title) + ": unknown, right variables and axis", unknown, row(name), ">= 90 %");
    add("  or explained by names that leave under 4 sigma of it", reported, row(name), "");
    add(std::string(title) + ": unknown", any_unknown, row(name), "");
    add(std::string(title) + ": misnamed", misnamed, row(name), "<= 3 %");
    add("  without saying that more remains", misnamed_plainly, row(name), "");
    add(std::string(title) + ": named by what leaves under 4 sigma of it", as_good, row(name), "");
    add(std::string(title) + ": one of several",
        outcome({Outcome::WrongSet, Outcome::LargeSet, Outcome::RightInSet, Outcome::RightInClasses}),
        row(name), "");
    add(std::string(title) + ": nothing above", outcome({Outcome::NothingExceeds, Outcome::NotVisible}),
        row(name), "");
  }
  add("one cause in several places: right name or in a set of up to 3", right, row("shared"), ">= 90 %");
  add("  its driver alone: right name", outcome({Outcome::Right}), row("shared"), ">= 90 %");
  add("  a wrong name", wrong, row("shared"), "");
  add("one cause on all axes: right name or in a set of up to 3", right, row("axes"), ">= 90 %");
  add("  a wrong name", wrong, row("axes"), "");
  add(
      "a law in the grammar: proposed, or one equal in the readings",
      [](const CampaignRecord& record) { return std::ranges::any_of(record.laws, is_true_law); }, has_law,
      ">= 80 %");
  add(
      "  a law that leaves 4 sigma or more as the sole proposal",
      [](const CampaignRecord& record) {
        return record.laws.size() == 1 && !is_true_law(record.laws.front());
      },
      row("unlisted"), "<= 3 %");
  if (const Share band = band_coverage(campaigns); band.of > 0)
    figures.push_back({"readings inside the 95 % band of what was drawn", band, "93 to 97 %"});
  add("behind what is in no catalogue: name found, or in a set of up to 3", found_behind, row("behind", 12.0),
      ">= 90 %");
  add("  a wrong name", wrong, row("behind"), "");
  add("two hidden, both and nothing else", outcome({Outcome::Right}), row("pairs"), ">= 97 %");
  add("  by name or in a set of up to 3", right, row("pairs"), ">= 97 %");
  add("  the same in these readings counted once", right_in_classes, row("pairs"), ">= 97 %");
  add("two hidden, a wrong name", wrong, row("pairs"), "");
  const auto recovered = [](const CampaignRecord& record) {
    return recovered_share(record, record.ms_named) >= kRecovered;
  };
  const auto recovered_by_sets = [](const CampaignRecord& record) {
    return recovered_share(record, record.ms_told) >= kRecovered;
  };
  add("recovered share >= 0.9, s >= 12", recovered, row("listed", 12.0), ">= 97 %");
  add(
      "  verdict NAMED", recovered,
      [&](const CampaignRecord& record) { return row("listed", 12.0)(record) && record.verdict == "NAMED"; },
      ">= 97 %");
  add("  the first name of every set added as well", recovered_by_sets, row("listed", 12.0), ">= 97 %");
  const auto offered = [](const CampaignRecord& record) {
    return recovered_share(record, record.ms_offered) >= kRecovered;
  };
  for (const char* name : {"listed", "unlisted", "left-out", "pairs", "shared", "axes", "behind", "rotary"})
    add(fmt::format("the model offered recovers >= 0.9, s >= 12: {}", name), offered, row(name, 12.0),
        ">= 97 %");
  add("  rotary errors missing from the model", offered, row("rotary-missing"), ">= 97 %");
  figures.push_back({"amplitude inside its 95 % interval, s >= 5", coverage(campaigns, false), "93 to 97 %"});
  figures.push_back({"  effects whose shape was scanned", coverage(campaigns, true), "93 to 97 %"});
  std::erase_if(figures, [](const Figure& figure) { return figure.share.of == 0; });
  for (const char* layout : {"ball-bar only", "diagonals only"}) {
    const auto among = [layout](const CampaignRecord& record) {
      return record.row == "partial" && record.layout == layout;
    };
    add(std::string(layout) + ": wrong confident name", wrong, among, "");
    add(std::string(layout) + ": right name or in a set of up to 3", right, among, "");
    add(std::string(layout) + ": not visible, or nothing above",
        outcome({Outcome::NotVisible, Outcome::NothingExceeds}), among, "");
  }
  return figures;
}

std::vector<Detection> detections_of(const Campaigns& campaigns) {
  std::map<std::string, std::vector<const CampaignRecord*>> by_effect;
  for (const CampaignRecord& record : campaigns) {
    if (record.row == "mdb" && record.failure.empty())
      by_effect[record.hidden.front().right].push_back(&record);
  }
  std::vector<Detection> detections;
  for (const auto& [effect, records] : by_effect) {
    // Signal of the stated amplitude; where the family is not among those kept, the median of the others.
    std::vector<double> stated;
    const auto stated_signal = [](const CampaignRecord& record) {
      const AnswerRecord* answer = answer_for(record);
      if (answer == nullptr) return std::numeric_limits<double>::quiet_NaN();
      const AmplitudeRecord& amplitude = answer->amplitudes.front();
      return record.hidden.front().signal * amplitude.mdb / std::abs(amplitude.truth);
    };
    for (const CampaignRecord* record : records) {
      if (const double signal = stated_signal(*record); std::isfinite(signal)) stated.push_back(signal);
    }
    if (stated.empty()) continue;
    std::ranges::nth_element(stated, stated.begin() + static_cast<std::ptrdiff_t>(stated.size() / 2));
    const double median = stated[stated.size() / 2];
    std::vector<Trial> trials;
    for (const CampaignRecord* record : records) {
      const double own = stated_signal(*record);
      trials.push_back({record->hidden.front().signal / (std::isfinite(own) ? own : median),
                        any_right(record->named) || std::ranges::any_of(record->sets, any_right)});
    }
    Detection detection = probit(trials);
    detection.effect = effect;
    detections.push_back(detection);
  }
  return detections;
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
