#pragma once
/// What could be measured next. A candidate makes, from a campaign, setups that were not measured:
/// plain data with nominal readings. A new entry is one file with a function and one line in
/// candidate_measurements.cpp.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// One thing that could be measured.
struct ExtraMeasurement {
  std::string action;         ///< name of the entry
  std::string setup;          ///< setup or station that it continues; empty = a new one
  std::string words;          ///< "measure P1 again with tool short after 3 h"
  std::vector<Setup> setups;  ///< names that the campaign does not have
  std::vector<Tool> tools;    ///< new ones; setups refer to them from Machine::tools.size() on
  bool is_path = true;        ///< readings follow one another; false: poses that have no order

  std::size_t readings() const;
};

struct CandidateContext {
  const Campaign& campaign;
  const KinematicChain& chain;
  std::size_t readings = 48;  ///< about as many as each entry may take
};

struct CandidateKind {
  std::string_view action;
  std::string_view summary;
  std::vector<ExtraMeasurement> (*make)(const CandidateContext& context);
};

std::span<const CandidateKind> candidate_kinds();
/// The measurements of all candidates, in their order.
std::vector<ExtraMeasurement> candidate_measurements(const CandidateContext& context);

}  // namespace volcal
