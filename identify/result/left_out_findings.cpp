#include "volcal/identify/result/left_out_findings.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "volcal/model/description/finding_codes.h"

namespace volcal {

std::vector<Finding> left_out_findings(const Campaign& campaign) {
  std::vector<Finding> findings;
  for (const Setup& setup : campaign.setups) {
    std::map<std::string, std::set<std::int64_t>> rows_of_reason;
    for (const LeftOutReading& reading : setup.left_out)
      rows_of_reason[reading.reason].insert(setup.readings.source_line[reading.row]);
    for (const auto& [reason, rows] : rows_of_reason) {
      findings.push_back({FindingCode::ReadingsLeftOut,
                          {{"setup", setup.name},
                           {"rows", std::vector<std::int64_t>(rows.begin(), rows.end())},
                           {"reason", reason}}});
    }
  }
  return findings;
}

std::vector<Finding> left_out_among(const std::vector<Finding>& findings) {
  std::vector<Finding> left_out;
  std::ranges::copy_if(findings, std::back_inserter(left_out),
                       [](const Finding& each) { return each.code == FindingCode::ReadingsLeftOut; });
  return left_out;
}

}  // namespace volcal
