#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/io/results/result_json_parts.h"
#include "volcal/identify/text/json_input.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// null stands for what is not a number.
double number_or_nan(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}
double number_or_nan(const Json& json, const char* key) { return number_or_nan(json.at(key)); }
double metres_of(const Json& json, const char* key) { return number_or_nan(json, key) * kMicro; }
std::string text(const Json& json, const char* key) { return json.at(key).get<std::string>(); }

/// Of a unit as it is printed: "um/m/K" stands for the suffix um_per_m_K.
double si_per_unit(std::string unit) {
  const std::size_t first = unit.find('/');
  if (first != std::string::npos) unit.replace(first, 1, "_per_");
  std::ranges::replace(unit, '/', '_');
  return unit_of_key("amplitude_" + unit).si_per_unit;
}

EffectName name_from(const Json& json) {
  return EffectName::of_parts(text(json, "kind"), text(json, "target"), text(json, "driver"),
                              text(json, "shape"));
}

AmplitudeFigure amplitude_from(const Json& json) {
  AmplitudeFigure figure;
  figure.label = text(json, "label");
  figure.unit = text(json, "unit");
  figure.si_per_unit = si_per_unit(figure.unit);
  figure.value = number_or_nan(json, "amplitude") * figure.si_per_unit;
  figure.u = number_or_nan(json, "u") * figure.si_per_unit;
  figure.mdb = number_or_nan(json, "mdb") * figure.si_per_unit;
  figure.mib = number_or_nan(json, "mib") * figure.si_per_unit;
  figure.mib_rival = text(json, "mib_rival");
  if (std::isnan(figure.mib) && !figure.mib_rival.empty()) figure.mib = kInfinity;
  return figure;
}

EffectFinding effect_from(const Json& json) {
  EffectFinding effect;
  effect.name = name_from(json);
  effect.label = text(json, "label");
  if (json.contains("amplitudes")) {
    for (const Json& each : json.at("amplitudes")) effect.amplitudes.push_back(amplitude_from(each));
  } else if (json.contains("amplitude")) {
    effect.amplitudes.push_back(amplitude_from(json));
  }
  effect.log10_p = number_or_nan(json, "log10_p");
  effect.visible_fraction = number_or_nan(json, "visible_fraction");
  effect.gain = number_or_nan(json, "gain");
  effect.lm = number_or_nan(json, "lm");
  effect.dof = json.at("dof").get<int>();
  if (json.contains("shape_value")) effect.shape_text = text(json, "shape_value");
  effect.resolution = !json.contains("spec");
  if (!effect.resolution) effect.spec = json_parts::effect_from(json.at("spec"));
  return effect;
}

FormulaFinding formula_from(const Json& json) {
  FormulaFinding formula;
  formula.label = text(json, "label");
  formula.unit = text(json, "unit");
  formula.si_per_unit = si_per_unit(formula.unit.substr(0, formula.unit.find_first_of(" /")));
  formula.amplitude = number_or_nan(json, "amplitude") * formula.si_per_unit;
  formula.u = number_or_nan(json, "u") * formula.si_per_unit;
  formula.shape_text = text(json, "shape_value");
  formula.log_evidence = number_or_nan(json, "log_evidence");
  if (json.contains("gain")) formula.gain = number_or_nan(json, "gain");
  if (json.contains("log10_p")) formula.log10_p = number_or_nan(json, "log10_p");
  formula.spec = json_parts::effect_from(json.at("spec"));
  return formula;
}

AskedLaws asked_from(const Json& json) {
  AskedLaws asked;
  asked.label = text(json, "label");
  asked.surface_evidence = number_or_nan(json, "surface_evidence");
  asked.tried = json.at("tried").get<std::size_t>();
  for (const Json& each : json.at("laws")) asked.laws.push_back(formula_from(each));
  return asked;
}

void read_heldout(const Json& json, MemberFinding& member) {
  member.rms_heldout = metres_of(json, "rms_heldout_um");
  member.systematic = metres_of(json, "systematic_um");
  member.systematic_low = metres_of(json, "systematic_low_um");
  member.systematic_high = metres_of(json, "systematic_high_um");
}

std::vector<Variable> variables_from(const Json& names) {
  std::vector<Variable> variables;
  for (const std::string& name : names.get<std::vector<std::string>>()) {
    const auto variable = Variable::parse(name);
    if (!variable) throw std::invalid_argument("\"" + printable(name) + "\" is not a variable");
    variables.push_back(*variable);
  }
  return variables;
}

ScanDirection direction_from(const Json& json) {
  const std::string name = text(json, "direction");
  const auto direction = scan_direction_from(name);
  if (!direction) throw std::invalid_argument("\"" + printable(name) + "\" is not a direction of a scan");
  return *direction;
}

/// Absent where the key is, or is empty: a displacement.
std::optional<ErrorSymbol> rotation_from(const Json& json) {
  const std::string name = json.value("rotation", "");
  const auto symbol = ErrorSymbol::parse(name);
  if (!symbol && !name.empty())
    throw std::invalid_argument("\"" + printable(name) + "\" is not an error motion");
  return symbol;
}

SurfaceFinding surface_from(const Json& json) {
  SurfaceFinding surface;
  surface.name = name_from(json);
  surface.label = text(json, "label");
  surface.drivers = variables_from(json.at("drivers"));
  surface.unit = text(json, "unit");
  surface.si_per_unit = si_per_unit(surface.unit);
  surface.largest = number_or_nan(json, "largest") * surface.si_per_unit;
  surface.largest_u = number_or_nan(json, "u") * surface.si_per_unit;
  surface.at = json.at("at").get<std::vector<double>>();
  surface.rms = number_or_nan(json, "rms") * surface.si_per_unit;
  surface.log_evidence = number_or_nan(json, "log_evidence");
  surface.effective_parameters = number_or_nan(json, "effective_parameters");
  surface.free = json.at("free").get<std::vector<std::string>>();
  for (const Json& each : json.at("formulas")) surface.formulas.push_back(formula_from(each));
  surface.spec = json_parts::effect_from(json.at("spec"));
  return surface;
}

std::optional<std::size_t> place_from(const Json& json, const char* key) {
  return json.at(key).is_null() ? std::nullopt : std::optional(json.at(key).get<std::size_t>());
}

SetFinding set_from(const Json& json) {
  SetFinding set;
  set.chosen = place_from(json, "chosen");
  set.farthest = place_from(json, "farthest");
  set.matters = json.at("matters").get<bool>();
  for (const Json& each : json.at("members")) {
    MemberFinding& member = set.members.emplace_back();
    read_heldout(each, member);
    member.difference = metres_of(each, "difference_um");
    member.difference_u = metres_of(each, "difference_u_um");
    for (const Json& at : each.at("at_mm")) member.at.push_back(at.get<double>() * kMetrePerMillimetre);
    const Json conditions = each.value("conditions", Json::object());
    for (const auto& [column, value] : conditions.items()) {
      const auto variable = Variable::parse_column(column);
      if (!variable) throw std::invalid_argument("\"" + printable(column) + "\" is no condition");
      member.conditions.emplace_back(*variable, value.get<double>());
    }
  }
  return set;
}

/// Every index is one of a set's members.
void check_sets(const Diagnosis& diagnosis) {
  const auto lists = sets_of_alternatives(diagnosis);
  if (!diagnosis.sets.empty() && diagnosis.sets.size() != lists.size())
    throw std::invalid_argument("there is not one entry of \"sets\" for each set");
  for (std::size_t i = 0; i < diagnosis.sets.size(); ++i) {
    const SetFinding& set = diagnosis.sets[i];
    const bool fits = set.members.size() == lists[i]->size() && set.chosen.value_or(0) < set.members.size() &&
                      set.farthest.value_or(0) < set.members.size();
    if (!fits) throw std::invalid_argument("\"sets\" names members that its set does not have");
  }
}

std::vector<EffectFinding> list_from(const Json& json) {
  std::vector<EffectFinding> effects;
  for (const Json& each : json) effects.push_back(effect_from(each));
  return effects;
}

DetectableEffect detectable_from(const Json& json) {
  DetectableEffect effect;
  effect.name = name_from(json);
  effect.label = text(json, "label");
  effect.shape_text = text(json, "shape_value");
  effect.unit = text(json, "unit");
  effect.si_per_unit = si_per_unit(effect.unit);
  effect.visible = json.at("visible").get<bool>();
  effect.visible_fraction = number_or_nan(json, "visible_fraction");
  effect.mdb = number_or_nan(json, "mdb") * effect.si_per_unit;
  effect.volumetric = metres_of(json, "volumetric_um");
  return effect;
}

EffectName name_from(const std::string& text) {
  std::optional<EffectName> name = EffectName::parse(text);
  if (!name) throw std::invalid_argument("\"" + printable(text) + "\" is not KIND:TARGET:DRIVER:SHAPE");
  return *std::move(name);
}

std::vector<EffectName> names_from(const Json& json) {
  std::vector<EffectName> names;
  for (const Json& each : json) names.push_back(name_from(each.get<std::string>()));
  return names;
}

/// A gain over nothing is infinite, and null in the file.
double gain_from(const Json& json, const char* key) {
  return json.at(key).is_null() ? kInfinity : json.at(key).get<double>();
}

MeasurementProposal proposal_from(const Json& json) {
  MeasurementProposal proposal;
  proposal.action = text(json, "action");
  proposal.setup = text(json, "setup");
  proposal.separates = names_from(json.at("separates"));
  proposal.makes_visible = names_from(json.at("makes_visible"));
  proposal.readings = json.at("readings").get<std::size_t>();
  proposal.separation = number_or_nan(json, "separation");
  proposal.reached = number_or_nan(json, "separation_reached");
  proposal.plain = number_or_nan(json, "separation_plain");
  proposal.gain = gain_from(json, "gain");
  proposal.plain_gain = gain_from(json, "plain_gain");
  const Finding in_words = verbatim(text(json, "words"));
  proposal.finding = json.contains("finding") ? finding_from(json.at("finding"), in_words) : in_words;
  return proposal;
}

Confounding confounding_from(const Json& json) {
  Confounding confounding;
  confounding.names = names_from(json.at("effects"));
  confounding.labels = json.at("labels").get<std::vector<std::string>>();
  const auto count = static_cast<Eigen::Index>(confounding.names.size());
  const Json& rows = json.at("cosine");
  confounding.cosine.resize(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      confounding.cosine(i, j) =
          number_or_nan(rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)));
    }
  }
  return confounding;
}

LadderStep step_from(const Json& json) {
  LadderStep step;
  step.model = text(json, "model");
  step.added = text(json, "added");
  step.rms_fit = metres_of(json, "rms_fit_um");
  step.rms_heldout = metres_of(json, "rms_heldout_um");
  step.reduced_chi2 = number_or_nan(json, "reduced_chi2");
  step.noise_floor = metres_of(json, "noise_floor_um");
  step.systematic = metres_of(json, "systematic_um");
  step.systematic_low = metres_of(json, "systematic_low_um");
  step.systematic_high = metres_of(json, "systematic_high_um");
  step.heldout_loglik_gain = number_or_nan(json, "heldout_loglik_gain");
  return step;
}

void read_noise(const Json& json, Diagnosis& diagnosis) {
  for (const Json& each : json) {
    const std::string instrument = text(each, "instrument");
    auto& names = diagnosis.noise_instruments;
    const auto known = std::ranges::find(names, instrument);
    const auto place = static_cast<std::size_t>(known - names.begin());
    if (known == names.end()) names.push_back(instrument);
    diagnosis.noise.push_back({place, text(each, "term"), text(each, "unit"), number_or_nan(each, "value"),
                               number_or_nan(each, "low"), number_or_nan(each, "high"),
                               number_or_nan(each, "likelihood_ratio"), text(each, "remark")});
  }
}

/// Files written before waves were looked for have none.
double wave_period(const Json& unknown) {
  const auto found = unknown.find("period_mm");
  return found == unknown.end() || found->is_null() ? 0.0 : found->get<double>() * kMetrePerMillimetre;
}

Diagnosis diagnosis_from(const Json& json) {
  if (const std::string format = text(json, "format"); format != kDiagnosisFormat) {
    throw std::invalid_argument("format is \"" + printable(format) + "\"");
  }
  Diagnosis diagnosis;
  diagnosis.verdict = verdict_from(text(json, "verdict"));
  diagnosis.findings =
      findings_from(value_or_null(json, "findings"), json.at("words").get<std::vector<std::string>>());
  diagnosis.effects = list_from(json.at("effects"));
  diagnosis.one_of = list_from(json.at("one_of"));
  for (const Json& set : json.at("further_one_of")) diagnosis.further_one_of.push_back(list_from(set));
  for (const Json& each : json.value("sets", Json::array())) diagnosis.sets.push_back(set_from(each));
  check_sets(diagnosis);
  for (const Json& each : json.value("surfaces", Json::array()))
    diagnosis.surfaces.push_back(surface_from(each));
  for (const Json& each : json.at("unknown")) {
    diagnosis.unknown.push_back({variables_from(each.at("variables")),
                                 variables_from(each.value("with_one_of", Json::array())),
                                 direction_from(each), rotation_from(each), metres_of(each, "rms_um"),
                                 number_or_nan(each, "log10_p"), wave_period(each)});
  }
  diagnosis.tried = list_from(json.value("tried", Json::array()));
  for (const Json& each : json.value("tried_errors", Json::array()))
    read_heldout(each, diagnosis.tried_errors.emplace_back());
  for (const Json& each : json.value("asked_laws", Json::array()))
    diagnosis.asked_laws.push_back(asked_from(each));
  diagnosis.not_visible = list_from(json.at("not_visible"));
  for (const Json& each : json.at("next_measurement")) {
    diagnosis.proposals.push_back(proposal_from(each));
  }
  diagnosis.confounding = confounding_from(json.at("confounding"));
  for (const Json& each : json.at("ladder")) diagnosis.ladder.push_back(step_from(each));
  diagnosis.model_changes = list_from(json.at("model_changes"));
  read_noise(json.at("noise"), diagnosis);
  diagnosis.not_looked_for = findings_from(value_or_null(json, "not_looked_for_findings"),
                                           json.value("not_looked_for", std::vector<std::string>{}));
  diagnosis.notes =
      findings_from(value_or_null(json, "notes_findings"), json.value("notes", std::vector<std::string>{}));
  for (const Json& each : json.at("removed_readings")) {
    diagnosis.removed_readings.push_back({each.at("setup").get<std::string>(),
                                          each.at("line").get<std::int64_t>(),
                                          each.at("reading").get<std::string>()});
  }
  diagnosis.ranking = list_from(json.at("ranking"));
  diagnosis.families = json.at("families").get<std::size_t>();
  diagnosis.generic_tests = json.at("generic_tests").get<std::size_t>();
  for (const Json& each : json.at("detectable")) diagnosis.detectable.push_back(detectable_from(each));
  return diagnosis;
}

}  // namespace

Diagnosis diagnosis_from_json(const std::string& text, const std::string& file) {
  return read_json(text, file, "diagnosis",
                   "give a folder that volcal diagnose wrote, or run the diagnosis again",
                   [](const Json& json) {
                     json_parts::require_no_control(json);
                     return diagnosis_from(json);
                   });
}

Diagnosis read_diagnosis(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::exists(path, error)) {
    throw InputError({path, 0}, "there is no such diagnosis",
                     missing_remedy(path, "give the folder that volcal diagnose wrote with -o"));
  }
  const bool folder = fs::is_directory(path, error);
  const std::string file = folder ? (fs::path(path) / "diagnosis.json").string() : path;
  if (folder && !fs::exists(file, error)) {
    throw InputError({path, 0}, "the folder holds no diagnosis.json",
                     "give a folder that volcal diagnose -o wrote");
  }
  return diagnosis_from_json(read_text_file(file), file);
}

}  // namespace volcal
