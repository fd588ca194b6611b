#include "volcal/identify/io/results/diagnosis_folder.h"

#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/result/left_out_findings.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

std::string head_of(const OfferedModel& offered, const Diagnosis& diagnosis) {
  std::string text = offered.about;
  for (const std::string& words : sentences(left_out_among(diagnosis.findings))) text += "\n" + words;
  return text;
}

}  // namespace

void write_diagnosis_folder(const Diagnosis& diagnosis, const Machine& machine,
                            const std::vector<OfferedModel>& models, const std::string& target,
                            const std::map<std::string, std::string>& more) {
  AtomicFolder folder(target);
  folder.write("diagnosis.json", diagnosis_json(diagnosis));
  for (const auto& [name, content] : more) folder.write(name, content);
  folder.write("machine.toml", machine_toml(machine));
  for (const OfferedModel& offered : models)
    folder.write(offered.file, model_toml(offered.model, "machine.toml", head_of(offered, diagnosis)));
  folder.commit();
}

}  // namespace volcal
