#pragma once
/// What tables of single axes keep of the errors that they are made of, and what is to be said of errors that
/// were read from such tables: they hold for one tool and its conditions (ISO/TR 16907:2015, 9.1).

#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"

namespace volcal {

struct TablesMadeFor {
  std::string tool;                         ///< empty where the values hold for every tool
  std::vector<Variable> conditions;         ///< that the values depend on
  std::vector<std::string> shared_effects;  ///< held as the nearest rigid body alone (rigid_compromise.h)
  std::vector<std::string> left_out;        ///< effects that act on no pose
};

/// Of tables for this tool at these conditions; of errors that were read from tables what holds of those.
TablesMadeFor tables_made_for(const FitResult& result, const Tool& tool, const Conditions& conditions);

/// Adds to errors that were read from tables the finding "errors.of-tables", with their conditions; nothing
/// where the tables hold for every tool and condition and leave nothing out.
void add_finding_of_tables(const TablesMadeFor& made_for, FitResult& result);

/// Of errors that were read from tables that finding, and "errors.tables-of-other-tool" of every tool here
/// that they were not made for; empty for other errors.
std::vector<Finding> findings_of_tables(const FitResult& result, const std::vector<std::string>& tools = {});

/// Names of the tools that a campaign's setups were measured with.
std::vector<std::string> tools_of_setups(const Campaign& campaign);

}  // namespace volcal
