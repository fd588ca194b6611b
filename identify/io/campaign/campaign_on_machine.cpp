#include "volcal/identify/io/campaign/campaign_on_machine.h"

#include <fmt/format.h>

#include <string>

#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kSameOffset = 1e-9;  // m

std::string own_machine(const Campaign& campaign) {
  return campaign.machine.file.empty() ? "the machine of the campaign"
                                       : "the machine file of the campaign, " + campaign.machine.file;
}

std::string offset_text(const Tool& tool) {
  const Eigen::Vector3d mm = tool.offset / kMetrePerMillimetre;
  return fmt::format("[{:.9g}, {:.9g}, {:.9g}] mm", mm.x(), mm.y(), mm.z());
}

std::size_t tool_on_machine(const Setup& setup, const Campaign& campaign, const Machine& machine) {
  const Tool& own = campaign.machine.tools[setup.tool];
  const SourcePlace place{campaign.file, setup.source_line};
  const auto found = machine.tool_index(own.name);
  if (!found) {
    throw InputError(
        place, fmt::format("setup \"{}\": the machine that is given has no tool {}", setup.name, own.name),
        fmt::format("add [tools.{}] to it, or give {}", own.name, own_machine(campaign)));
  }
  const Tool& given = machine.tools[*found];
  if ((given.offset - own.offset).norm() > kSameOffset) {
    throw InputError(
        place,
        fmt::format("setup \"{}\": the tool {} has the offset {}, on the machine that is given {}",
                    setup.name, own.name, offset_text(own), offset_text(given)),
        "give " + own_machine(campaign));
  }
  return *found;
}

}  // namespace

Campaign campaign_on_machine(Campaign campaign, const Machine& machine) {
  const std::string difference = machine_difference(campaign.machine, machine);
  if (!difference.empty()) {
    throw InputError({campaign.file, 0}, "the campaign's machine is not the one that is given: " + difference,
                     "give " + own_machine(campaign));
  }
  for (Setup& setup : campaign.setups) setup.tool = tool_on_machine(setup, campaign, machine);
  campaign.machine = machine;
  return campaign;
}

}  // namespace volcal
