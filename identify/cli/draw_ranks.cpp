#include "volcal/identify/cli/draw_ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "volcal/model/description/errors.h"

#ifdef VOLCAL_HAVE_MPI
#include <mpi.h>

#include <exception>
#include <numeric>
#endif

namespace volcal::cli {
namespace {

/// Processes that mpirun or srun started together, by their marks in the environment; 1 without any.
int started_together() {
  int most = 1;
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    if (const char* count = std::getenv(name)) most = std::max(most, std::atoi(count));
  }
  return most;
}

/// Each of several processes that know nothing of each other would make the whole study, all of them into one
/// folder.
void require_known_to_each_other(std::size_t ranks, const std::string& remedy) {
  const int processes = started_together();
  if (processes == 1 || ranks > 1) return;
  throw InputError(
      {}, fmt::format("{} processes were started together but know nothing of each other", processes),
      remedy);
}

}  // namespace

#ifdef VOLCAL_HAVE_MPI
namespace {

/// Errors of MPI end all ranks with its message (MPI_ERRORS_ARE_FATAL, the default).
class MpiRanks final : public DrawTeam {
 public:
  MpiRanks() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;
  /// A rank that leaves with an error does not wait for the others: mpirun then ends them.
  ~MpiRanks() override {
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
  }

  std::size_t rank() const override { return static_cast<std::size_t>(rank_); }
  std::size_t size() const override { return static_cast<std::size_t>(size_); }

  std::vector<std::string> gather(const std::string& own) override {
    const int length = static_cast<int>(own.size());
    std::vector<int> lengths(size()), begins(size());
    MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, MPI_COMM_WORLD);
    std::exclusive_scan(lengths.begin(), lengths.end(), begins.begin(), 0);
    std::string all(static_cast<std::size_t>(begins.back() + lengths.back()), '\0');
    MPI_Allgatherv(own.data(), length, MPI_BYTE, all.data(), lengths.data(), begins.data(), MPI_BYTE,
                   MPI_COMM_WORLD);
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < size(); ++i)
      parts.push_back(all.substr(static_cast<std::size_t>(begins[i]), static_cast<std::size_t>(lengths[i])));
    return parts;
  }

 private:
  int rank_ = 0;
  int size_ = 1;
};

/// As Open MPI, MPICH and Slurm's own launcher mark their processes.
bool started_among_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

}  // namespace

std::unique_ptr<DrawTeam> draw_ranks() {
  auto ranks = started_among_ranks() ? std::make_unique<MpiRanks>() : nullptr;
  require_known_to_each_other(
      ranks ? ranks->size() : 1,
      "start them with the mpirun of the Open MPI that volcal was built with, or with srun "
      "--mpi=pmix");
  return ranks;
}
#else
std::unique_ptr<DrawTeam> draw_ranks() {
  require_known_to_each_other(
      1,
      "build volcal where Open MPI is installed (-DVOLCAL_MPI=ON), or start it once, without mpirun or srun");
  return nullptr;
}
#endif

}  // namespace volcal::cli
