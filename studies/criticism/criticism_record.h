#pragma once
/// What is kept of one campaign of the study: one line of JSON. Units at the edge are in the names, signals
/// are in units of the noise.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace volcal::studies {

/// An amplitude that the diagnosis stated, in the unit of the catalogue.
struct AmplitudeRecord {
  double value = 0.0;
  double u = 0.0;
  double mdb = 0.0;
  double truth = 0.0;  ///< of the family at its stated shape that is nearest to what is hidden
};

/// An effect that the diagnosis named, or listed among alternatives.
struct AnswerRecord {
  std::string name;  ///< kind:target:driver:shape
  int hidden = -1;   ///< index of the hidden effect that it is; -1 = wrong
  bool by_name =
      false;  ///< right by its name, not only because the readings cannot tell it from the right one
  bool resolution = false;
  bool scanned = false;   ///< has parameters of its shape
  double explains = 0.0;  ///< cos^2 with what is hidden, after projection: 1 = all of it
  double log10_p = 0.0;
  double gain = 0.0;
  std::vector<AmplitudeRecord> amplitudes;
};

struct HiddenRecord {
  std::string text;               ///< kind and keys
  std::string right;              ///< name in the catalogue; empty when it is not there
  double signal = 0.0;            ///< |g~ a|
  double visible_fraction = 0.0;  ///< |g~| / |g_w|
  double rms_um = 0.0;            ///< on the readings
  std::vector<std::string> drivers;
  std::vector<std::string> companions;
  std::vector<std::string> directions;
};

/// A law that was proposed for what has no name.
struct LawRecord {
  std::string text;
  double explains = 0.0;   ///< cos^2 with what is hidden and has no name, after projection
  double remainder = 0.0;  ///< what it leaves of that, in units of the noise
};

struct UnknownRecord {
  std::vector<std::string> variables;
  std::string direction;
  double log10_p = 0.0;
};

struct CampaignRecord {
  std::vector<std::string> without;  ///< rules of the search that were left out; none as a rule
  std::string row;
  int index = 0;
  std::uint64_t seed = 0;  ///< of the study
  int wanted_readings = 0;
  int readings = 0;
  std::string structure;
  std::string layout;
  std::string noise;
  std::string failure;  ///< why there is no diagnosis; empty as a rule
  std::vector<HiddenRecord> hidden;
  std::string verdict;
  std::vector<AnswerRecord> named;
  std::vector<std::vector<AnswerRecord>> sets;  ///< of alternatives
  std::vector<AnswerRecord> ranking;            ///< the first five at the model reached
  std::vector<UnknownRecord> unknown;
  std::vector<std::string> model_changes;
  std::vector<std::string> noise_terms;  ///< as estimated
  int families = 0;
  int removed_readings = 0;
  double named_explain = 0.0;  ///< cos^2 of everything hidden with everything named
  double told_explain = 0.0;   ///< the same with the first of every set of alternatives
  bool recovery = false;       ///< the next were computed
  double ms_given = 0.0;       ///< um^2: noise-free prediction error at unseen positions, the given model
  double ms_named = 0.0;       ///< with the named effects, fitted again
  double ms_told = 0.0;        ///< the same with the first of every set of alternatives
  double ms_oracle = 0.0;  ///< with the hidden effects' kind and shape, fitted again; of what no catalogue
                           ///< holds: with nothing hidden
  std::vector<std::string> drawn;  ///< surfaces, curves and laws of the model that is offered
  double ms_offered = 0.0;  ///< with all that is offered: names, of every set the simplest, what was drawn
  std::vector<LawRecord> laws;  ///< of all surfaces
  int band_inside = 0;          ///< readings at which the band of what was drawn holds what is hidden
  double seconds = 0.0;         ///< of a processor for the diagnosis; not kept with the rest
  int band_of = 0;              ///< readings on which it acts; 0: names stand beside it, or nothing was drawn
};

using Campaigns = std::vector<CampaignRecord>;

void to_json(nlohmann::json& json, const CampaignRecord& record);
void from_json(const nlohmann::json& json, CampaignRecord& record);

}  // namespace volcal::studies
