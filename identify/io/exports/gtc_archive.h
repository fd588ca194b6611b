#pragma once
/// Archive of the GUM Tree Calculator (GTC, Measurement Standards Laboratory of New Zealand), JSON schema
/// 1.5.0: uncertain real numbers with their correlations, read by `GTC.persistence.load_json`.

#include <string>
#include <vector>

#include "volcal/identify/io/exports/joint_values.h"

namespace volcal {

/// Values that are correlated are leaves of one ensemble, others leaves of their own. A leaf's label is its
/// name with its unit, its tag gtc_tags(). The same values make the same bytes; others have other identities,
/// so that archives of several fits can be read together.
std::string gtc_archive(const JointValues& joint);

/// Names as GTC takes them: letters, digits and underscores, no two alike.
std::vector<std::string> gtc_tags(const std::vector<std::string>& names);

}  // namespace volcal
