#include "volcal/studies/criticism/criticism_record.h"

#include <nlohmann/json.hpp>

namespace volcal::studies {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AmplitudeRecord, value, u, mdb, truth)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AnswerRecord, name, hidden, by_name, resolution, scanned, explains,
                                   log10_p, gain, amplitudes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HiddenRecord, text, right, signal, visible_fraction, rms_um, drivers,
                                   companions, directions)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LawRecord, text, explains, remainder)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(UnknownRecord, variables, direction, log10_p)

namespace {
struct Fields : CampaignRecord {};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Fields, row, index, seed, wanted_readings, readings, structure, layout,
                                   noise, failure, hidden, verdict, named, sets, ranking, unknown,
                                   model_changes, noise_terms, families, removed_readings, named_explain,
                                   told_explain, recovery, ms_given, ms_named, ms_told, ms_oracle, drawn,
                                   ms_offered, laws, band_inside, band_of)
}  // namespace

void to_json(nlohmann::json& json, const CampaignRecord& record) {
  to_json(json, Fields{record});
  if (!record.without.empty()) json["without"] = record.without;
}

void from_json(const nlohmann::json& json, CampaignRecord& record) {
  Fields fields;
  from_json(json, fields);
  if (json.contains("without")) json.at("without").get_to(fields.without);
  record = fields;
}

}  // namespace volcal::studies
