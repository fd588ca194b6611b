#include "volcal/identify/io/results/diagnosis_folder.h"

#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal {

void write_diagnosis_folder(const Diagnosis& diagnosis, const Machine& machine,
                            const std::vector<OfferedModel>& models, const std::string& target,
                            const std::map<std::string, std::string>& more) {
  AtomicFolder folder(target);
  folder.write("diagnosis.json", diagnosis_json(diagnosis));
  for (const auto& [name, content] : more) folder.write(name, content);
  folder.write("machine.toml", machine_toml(machine));
  for (const OfferedModel& offered : models)
    folder.write(offered.file, model_toml(offered.model, "machine.toml", offered.about));
  folder.commit();
}

}  // namespace volcal
