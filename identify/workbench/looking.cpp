#include "volcal/identify/workbench/looking.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/report/rotary_json.h"
#include "volcal/identify/report/values/volume_causes.h"
#include "volcal/identify/session/proposed_measurements.h"
#include "volcal/identify/session/session_command.h"
#include "volcal/identify/standards/standard_figures.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/identify/workbench/columns.h"
#include "volcal/identify/workbench/session_json.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/expression.h"
#include "volcal/model/effects/recorded_variable.h"

namespace volcal::workbench {
namespace {

constexpr std::size_t kCompared = 12;                   // suspects whose fall and rivals are told
constexpr std::size_t kListed = 80;                     // suspects
constexpr std::size_t kHidden = 60;                     // effects of which nothing shows
constexpr std::size_t kProductsAtOnce = 2'000'000'000;  // a second of a processor
constexpr std::size_t kFrequencies = 1200;
constexpr double kWavesPerRange = 300.0;  // finest of the periodogram
constexpr double kPeriodogramRisk = 0.01;

Json fall_json(const Session& session, double rms) {
  return {{"from_um", number(session.current().figures.rms_heldout * kPerMicro)},
          {"to_um", number(rms * kPerMicro)}};
}

Json rivals_json(const Rivalry& rivalry, const std::map<EffectName, std::string>& labels,
                 const EffectName& effect) {
  Json rivals = Json::array();
  const auto own = std::ranges::find(rivalry.names, effect);
  if (own == rivalry.names.end()) return rivals;
  const auto row = own - rivalry.names.begin();
  for (std::size_t k = 0; k < rivalry.names.size(); ++k) {
    const double cosine = rivalry.cosine(row, static_cast<Eigen::Index>(k));
    if (static_cast<std::ptrdiff_t>(k) == row || cosine < kRivalCosine) continue;
    rivals.push_back({{"name", full_name(rivalry.names[k])},
                      {"label", labels.at(rivalry.names[k])},
                      {"cosine", number(cosine)}});
  }
  return rivals;
}

std::map<EffectName, std::string> labels_of(const std::vector<EffectFinding>& effects) {
  std::map<EffectName, std::string> labels;
  for (const EffectFinding& effect : effects) labels[effect.name] = effect.label;
  return labels;
}

Json suspects_json(Session& session, const std::vector<EffectFinding>& ranking) {
  const Rivalry rivalry = session.rivals(kCompared);
  const std::map<EffectName, std::string> labels = labels_of(ranking);
  Json suspects = Json::array();
  for (const EffectFinding& effect : ranking) {
    if (suspects.size() == kListed) break;
    Json suspect = effect_json(effect);
    suspect["rivals"] = rivals_json(rivalry, labels, effect.name);
    suspect["fall"] = nullptr;
    if (!effect.resolution && suspects.size() < kCompared)
      suspect["fall"] = fall_json(session, session.preview(effect.name).rms_heldout);
    suspects.push_back(std::move(suspect));
  }
  return suspects;
}

/// Cosines to the leading effects.
Json all_cosines_json(Session& session, const EffectPreview& preview, const Eigen::VectorXd& before) {
  Json rivals = Json::array();
  const Eigen::VectorXd sigma = session.sigma(session.current().number);
  const auto weighed = [&](const Eigen::VectorXd& change) -> Eigen::VectorXd {
    return (sigma.array().isFinite()).select(change.array() / sigma.array(), 0.0);
  };
  const Eigen::VectorXd own = weighed(before - preview.residual);
  std::size_t compared = 0;
  for (const EffectFinding& other : session.rank()) {
    if (other.resolution || other.name == preview.effect.name) continue;
    if (++compared > kCompared) break;
    const Eigen::VectorXd theirs = weighed(before - session.preview(other.name).residual);
    const double size = own.norm() * theirs.norm();
    if (size > 0.0)
      rivals.push_back({{"name", full_name(other.name)},
                        {"label", other.label},
                        {"cosine", number(std::abs(own.dot(theirs)) / size)}});
  }
  return rivals;
}

std::string remedy_text(const Explanation& why) {
  return "The readings do not show it: " + why.reason + "; " + why.remedy + ".";
}

Json preview_json(Session& session, const EffectPreview& preview) {
  Json suspect = effect_json(preview.effect);
  if (preview.effect.dof == 0)
    suspect["remedy"] = remedy_text(session.why_not_visible({preview.effect}).front());
  suspect["fall"] = fall_json(session, preview.rms_heldout);
  return {{"model", session.current().number}, {"effect", std::move(suspect)}};
}

/// Least and largest of the values that were recorded.
std::pair<double, double> range_of(const Eigen::VectorXd& values) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return low > high ? std::pair{0.0, 0.0} : std::pair{low, high};
}

/// Letters, those outside ASCII as well, digits and underscores that end at a place.
std::size_t word_begin(const std::string& text, std::size_t at) {
  const auto belongs = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 || std::isalnum(byte) != 0 || c == '_';
  };
  std::size_t begin = std::min(at, text.size());
  while (begin > 0 && belongs(text[begin - 1])) --begin;
  return begin;
}

/// Name and meaning of what may stand in a formula.
std::vector<std::pair<std::string, std::string>> formula_words(const Session& session) {
  std::vector<std::pair<std::string, std::string>> words;
  const Campaign& campaign = session.campaign();
  for (const Axis& axis : campaign.machine.axes) {
    const std::string letter(1, lower_letter_of(axis.name)),
        called = std::string("axis ") + letter_of(axis.name);
    words.emplace_back(letter, "position of " + called + (is_rotary(axis.name) ? ", deg" : ", mm"));
    words.emplace_back(direction_of_approach(axis.name).written(),
                       "direction of approach of " + called + ", -1 or +1");
  }
  for (const ColumnInfo& column : recorded_columns(session)) {
    if (column.kind == "temperature") words.emplace_back(column.name, column.label + ", degC");
  }
  for (const Variable& variable : plain_variables())
    words.emplace_back(variable.written(), "recorded with the readings");
  for (const std::string& name : Expression::function_names()) words.emplace_back(name + "(", "function");
  return words;
}

std::vector<std::pair<std::string, std::string>> target_words(const Session& session) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const Axis& axis : session.campaign().machine.axes) {
    for (const char* component : {"X", "Y", "Z", "A", "B", "C"})
      words.emplace_back("E" + std::string(component) + letter_of(axis.name),
                         std::string("error motion of axis ") + letter_of(axis.name));
  }
  return words;
}

/// Row and channel, by setup.
std::vector<std::set<std::pair<std::size_t, int>>> left_out_readings(const Campaign& campaign) {
  std::vector<std::set<std::pair<std::size_t, int>>> left_out(campaign.setups.size());
  for (std::size_t setup = 0; setup < campaign.setups.size(); ++setup) {
    for (const LeftOutReading& reading : campaign.setups[setup].left_out)
      left_out[setup].emplace(reading.row, static_cast<int>(reading.channel));
  }
  return left_out;
}

std::vector<ResidualRecord> records_of(const Session& session, std::size_t model) {
  const auto& places = session.linear().observations();
  const Eigen::VectorXd& residual = session.residual(model);
  const std::vector<double>& sigma = session.linear().problem().data.sigma;
  const std::vector<std::set<std::pair<std::size_t, int>>> left_out = left_out_readings(session.campaign());
  std::vector<ResidualRecord> records;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& [setup, row, channel] = places[i];
    const Readings& readings = session.campaign().setups[setup].readings;
    ResidualRecord& record = records.emplace_back();
    record.setup = setup;
    record.row = row;
    record.channel = channel;
    record.source_line = readings.source_line[row];
    record.reading = readings.value[static_cast<std::size_t>(channel)][row];
    record.predicted = record.reading - residual[static_cast<Eigen::Index>(i)];
    record.removed = !std::isfinite(sigma[i]);
    record.left_out = left_out[setup].contains({row, channel});
  }
  return records;
}

Json radial_json(const std::vector<CircleReading>& readings) {
  Json json = Json::array();
  for (const CircleReading& reading : readings) json.push_back(number(reading.deviation * kPerMicro));
  return json;
}

Json circle_json(const CircleTest& now, const CircleTest& before) {
  Json angle = Json::array(), sense = Json::array();
  for (const CircleReading& reading : now.radial.readings) {
    angle.push_back(reading.angle / kRadianPerDegree);
    sense.push_back(reading.sense);
  }
  const auto deviation = [](const CircularFigures& figures) {
    return number(figures.bidirectional.value_or(std::numeric_limits<double>::quiet_NaN()) * kPerMicro);
  };
  return {{"name", now.setup},
          {"plane", std::string(1, letter_of(now.first)) + letter_of(now.second)},
          {"radius_mm", now.radius * kPerMilli},
          {"setup", now.setup_index},
          {"rows", now.rows},
          {"angle_deg", std::move(angle)},
          {"sense", std::move(sense)},
          {"measured_um", radial_json(now.radial.readings)},
          {"predicted_um", radial_json(now.radial.model)},
          {"before_um", radial_json(before.radial.model)},
          {"G_measured_um", deviation(now.figures.readings)},
          {"G_predicted_um", deviation(now.figures.model)}};
}

/// Since the last full fit, which does not hold them.
std::vector<EffectFinding> added_since_fit(const Session& session) {
  std::vector<EffectFinding> added;
  for (const EffectFinding& effect : session.current().effects) {
    if (session.is_preview(effect.name)) added.push_back(effect);
  }
  return added;
}

/// Whether a cause is an effect that was added in this session.
bool was_added(const Session& session, const VolumeCause& cause) {
  return cause.effect && !session.was_given(*cause.effect);
}

/// Of a machine that is compensated by the tables of the last full fit: how uncertain they are, and what none
/// holds.
Json left_json(const Session& session) {
  const FitResult& result = session.fitted_result();
  const ErrorBudget budget = error_budget(result, result.machine.tools.front(), default_conditions(result),
                                          kVolumeCells, RotaryPoses::AtRest);
  double squares = 0.0;
  Json held_by_none = Json::array();
  for (const BudgetLine& line : budget.contributions) {
    if (std::ranges::none_of(line.depends_on, &Variable::changes_at_rest)) continue;
    squares += line.rms * line.rms;
    held_by_none.push_back(line.name);
  }
  return {{"before_um", number(budget.total.rms * kPerMicro)},
          {"by_uncertainty_um", number(budget.total.u_rms * kPerMicro)},
          {"by_time_and_temperature_um", number(std::sqrt(squares) * kPerMicro)},
          {"held_by_no_table", std::move(held_by_none)}};
}

/// Of every kind the effect that is seen best.
Json detectable_json(const std::vector<EffectFinding>& ranking) {
  std::map<std::string, std::pair<const EffectFinding*, const AmplitudeFigure*>> best;
  for (const EffectFinding& effect : ranking) {
    for (const AmplitudeFigure& figure : effect.amplitudes) {
      if (effect.resolution || !std::isfinite(figure.mdb)) continue;
      auto& known = best[effect.name.kind + " " + figure.unit];
      if (known.second == nullptr || figure.mdb < known.second->mdb) known = {&effect, &figure};
    }
  }
  Json json = Json::array();
  for (const auto& [kind, found] : best) {
    json.push_back({{"kind", found.first->name.kind},
                    {"label", found.first->label},
                    {"detectable", number(found.second->mdb / found.second->si_per_unit)},
                    {"unit", found.second->unit}});
  }
  return json;
}

/// What the readings cannot show, with what to do about it: of as many as are explained at once.
Json hidden_json(Session& session) {
  std::vector<EffectFinding> hidden = session.not_visible();
  hidden.resize(std::min(hidden.size(), kHidden));
  const auto parameters = static_cast<std::size_t>(session.linear().problem().jacobian.cols());
  const std::size_t most = kProductsAtOnce / std::max<std::size_t>(1, session.linear().size() * parameters);
  std::vector<EffectFinding> named;
  std::ranges::copy_if(hidden, std::back_inserter(named), std::not_fn(&EffectFinding::resolution));
  named.resize(std::min(named.size(), most));
  const std::vector<Explanation> why = session.why_not_visible(named);
  Json json = Json::array();
  for (const EffectFinding& effect : hidden) {
    json.push_back(effect_json(effect));
    const auto place = std::ranges::find(named, effect.name, &EffectFinding::name) - named.begin();
    if (static_cast<std::size_t>(place) < why.size())
      json.back()["remedy"] = remedy_text(why[static_cast<std::size_t>(place)]);
  }
  return json;
}

}  // namespace

Json rank_json(Session& session) {
  const std::vector<EffectFinding>& ranking = session.rank();
  Json hidden = hidden_json(session);
  return {{"model", session.current().number},
          {"tests", ranking.size()},
          {"tried", session.tried()},
          {"effects", suspects_json(session, ranking)},
          {"not_visible", std::move(hidden)}};
}

Json unknown_json(Session& session) {
  const bool ready = session.is_scanned();
  Json unknown = Json::array(), drawn = Json::array();
  if (ready) {
    for (const UnknownFinding& finding : session.unknown())
      unknown.push_back(unknown_json(finding, unknown.size()));
  }
  for (const SurfaceFinding& surface : session.drawn()) drawn.push_back(surface_json(surface));
  return {{"model", session.current().number},
          {"ready", ready},
          {"unknown_leads", ready && session.unknown_leads()},
          {"unknown", std::move(unknown)},
          {"drawn", std::move(drawn)},
          {"next", ready ? Json(sentences(findings_of(session.next_measurements()))) : Json()}};
}

std::string preview_frame(Session& session, const std::string& effect) {
  const EffectName name = effect_name_from(effect);
  try {
    const EffectPreview preview = session.preview(name);
    return frame(preview_json(session, preview), {"residual"}, {preview.residual * kPerMicro});
  } catch (const std::invalid_argument& error) {
    throw InputError({}, error.what(), "choose one of the list of this model");
  }
}

std::string formula_frame(Session& session, const std::string& text,
                          const std::vector<std::string>& parameters) {
  const WrittenEffect written = written_effect(kFormulaBox, text, parameters);
  const EffectPreview preview =
      at_its_column(kFormulaBox, text, [&] { return session.formula(written.spec); });
  Json json = preview_json(session, preview);
  json["tried"] = session.tried();
  json["rivals"] = all_cosines_json(session, preview, session.residual());
  return frame(std::move(json), {"residual", "driver"},
               {preview.residual * kPerMicro, session.driver(preview.effect.name)});
}

Json completion_json(const Session& session, const std::string& text, std::size_t at) {
  const std::size_t from = word_begin(text, at);
  const std::string begun = text.substr(from, std::min(at, text.size()) - from);
  const bool in_target = text.find("+=") == std::string::npos && text.find(':') == std::string::npos;
  Json words = Json::array();
  for (const auto& [word, meaning] : in_target ? target_words(session) : formula_words(session)) {
    if (word.starts_with(begun)) words.push_back({{"word", word}, {"meaning", meaning}});
  }
  return {{"from", from}, {"words", std::move(words)}};
}

Json periodogram_json(const Session& session, const std::string& variable) {
  const Eigen::VectorXd at = column(session, variable), sigma = session.sigma(session.current().number);
  const Eigen::VectorXd& residual = session.residual();
  const auto [low, high] = range_of(at);
  const double begin = low, width = high > low ? high - low : 1.0;
  const double step = kWavesPerRange / static_cast<double>(kFrequencies) / width;
  std::vector<std::complex<double>> sums(kFrequencies, 0.0);
  double weights = 0.0;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    if (!std::isfinite(sigma[i]) || !std::isfinite(at[i])) continue;
    const double weight = 1.0 / (sigma[i] * sigma[i]);
    const std::complex<double> turn = std::polar(1.0, 2.0 * std::numbers::pi * step * (at[i] - begin));
    std::complex<double> wave = residual[i] * weight;
    for (std::complex<double>& sum : sums) sum += (wave *= turn);
    weights += weight;
  }
  Json period = Json::array(), power = Json::array();
  std::size_t peak = 0;
  for (std::size_t k = 0; k < kFrequencies; ++k) {
    period.push_back(1.0 / (step * static_cast<double>(k + 1)));
    power.push_back(number(std::norm(sums[k]) / weights));
    if (std::norm(sums[k]) > std::norm(sums[peak])) peak = k;
  }
  return {{"model", session.current().number},
          {"variable", variable},
          {"period", period},
          {"power", std::move(power)},
          {"level", std::log(kWavesPerRange / kPeriodogramRisk)},
          {"peak", period[peak]}};
}

Json polar_json(const Session& session) {
  const StandardFigures now =
      standard_figures(session.campaign(), records_of(session, session.current().number));
  const StandardFigures before = standard_figures(session.campaign(), records_of(session, 0));
  Json circles = Json::array();
  for (std::size_t i = 0; i < now.circles.size(); ++i)
    circles.push_back(circle_json(now.circles[i], before.circles[std::min(i, before.circles.size() - 1)]));
  return {{"model", session.current().number}, {"circles", std::move(circles)}};
}

Json rotary_axes_json(const Session& session) {
  const auto pictures = rotary_pictures(session.fitted_result(), session.campaign());
  return {{"model", session.current().number},
          {"rotary", pictures ? report::rotary_json(*pictures) : Json()}};
}

Json meaning_json(Session& session) {
  const VolumeCauses causes = volume_causes(session.fitted_result(), added_since_fit(session));
  Json share = Json::array();
  for (const VolumeCause& cause : causes.causes) {
    share.push_back({{"label", cause.name},
                     {"found", cause.found || was_added(session, cause)},
                     {"um", number(cause.rms * kPerMicro)},
                     {"u95_um", cause.u ? number(kCoverageFactor * *cause.u * kPerMicro) : Json()},
                     {"percent", number(100.0 * cause.share)}});
  }
  return {{"model", session.current().number},
          {"tool", causes.tool},
          {"rms_um", number(causes.total_rms * kPerMicro)},
          {"share", std::move(share)},
          {"not_in_volume", causes.not_in_volume},
          {"left", left_json(session)},
          {"detectable", detectable_json(session.rank())}};
}

}  // namespace volcal::workbench
