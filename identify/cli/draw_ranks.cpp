#include "volcal/identify/cli/draw_ranks.h"

#ifdef VOLCAL_HAVE_MPI
#include <mpi.h>

#include <cstdlib>
#include <exception>
#include <numeric>
#endif

namespace volcal::cli {

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
  return started_among_ranks() ? std::make_unique<MpiRanks>() : nullptr;
}
#else
std::unique_ptr<DrawTeam> draw_ranks() { return nullptr; }
#endif

}  // namespace volcal::cli
