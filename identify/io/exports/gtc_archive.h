#pragma once
/// Archive of the GUM Tree Calculator (GTC, Measurement Standards Laboratory of New Zealand), JSON schema
/// 1.5.0: uncertain real numbers with their correlations, read by `GTC.persistence.load_json`.

#include <string>
#include <vector>

#include "volcal/identify/io/exports/joint_values.h"

namespace volcal {

/// Values that are correlated are leaves of one ensemble, others leaves of their own. A leaf's label is its
/// name with its unit, its tag gtc_tags(). The same values make the same bytes; others have other identities,
/// so that archives of several fits can be read together. Rows of `table` are functions of the values
/// (IntermediateReal), by what each value contributes to their uncertainty, so that whatever is computed of
/// them in GTC keeps all correlations; their tags are those of gtc_row_names().
std::string gtc_archive(const JointValues& joint, const JointTable& table = {});

/// "EXX at 100 mm", "EXX at minus 50 mm towards plus", "EC0Y in tables".
std::vector<std::string> gtc_row_names(const JointTable& table);

/// Names as GTC takes them: letters, digits and underscores, no two alike.
std::vector<std::string> gtc_tags(const std::vector<std::string>& names);

}  // namespace volcal
