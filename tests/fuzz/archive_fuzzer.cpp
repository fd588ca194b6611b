#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/reader_harness.h"
#include "volcal/studies/criticism/criticism_record.h"
#include "volcal/studies/files/finished_campaigns.h"

/// A line of the campaigns that a study of criticism has finished.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string line(data, data + size);
  volcal::testing::accepts([&] {
    volcal::studies::take_campaign(line, {"campaigns.jsonl", 1}, [](const nlohmann::json& json, const auto&) {
      static_cast<void>(json.get<volcal::studies::CampaignRecord>());
    });
  });
  return 0;
}
