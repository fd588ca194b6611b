#pragma once
/// The ranks among which mpirun started this process. Built with VOLCAL_MPI; else every process is alone.

#include <memory>

#include "volcal/identify/montecarlo/draw_team.h"

namespace volcal::cli {

/// Nothing for a process that mpirun did not start. Throws InputError for several that do not form a team: a
/// program without MPI under mpirun, or srun without its plugin.
std::unique_ptr<DrawTeam> draw_ranks();

}  // namespace volcal::cli
