#pragma once
/// Readings that count from where the control believed the tool point to be (an R-test, centres and contacts
/// of a probe, error vectors), for a tool whose offset is stated anew.

#include <Eigen/Core>

#include "volcal/model/description/campaign.h"

namespace volcal {

/// Of `setup`, which was measured while the control knew the offset `former`: adds what its instrument reads
/// less, or more, when the nominal tool point of every reading follows from the offset `stated`. Readings
/// that do not count from it, as lengths from a station, stay as they are. m, in the machine's axes.
void restate_readings(const Machine& machine, const std::string& campaign_file, const Eigen::Vector3d& former,
                      const Eigen::Vector3d& stated, Setup& setup);

}  // namespace volcal
