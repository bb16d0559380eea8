#include "apps/ranks.h"

#include <deal.II/base/mpi.h>

#include <Eigen/Core>
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

namespace apps {

namespace {

bool runs()
{
  int started = 0, ended = 0;
  MPI_Initialized(&started);
  MPI_Finalized(&ended);
  return started && !ended;
}

/// MPI and the libraries over it, from their start to their end: they belong to the process.
std::unique_ptr<dealii::Utilities::MPI::MPI_InitFinalize>& session()
{
  static std::unique_ptr<dealii::Utilities::MPI::MPI_InitFinalize> running;
  return running;
}

/// Where the other ranks than the first may still speak, should one of them fail alone.
int& last_words()
{
  static int descriptor = -1; // belongs to the process, as its standard error does
  return descriptor;
}

/// Where ranks wait for each other at their end, apart from what they may still be saying.
MPI_Comm& meeting_place()
{
  static MPI_Comm place = MPI_COMM_NULL; // belongs to the process, as MPI does
  return place;
}

/// Waits for the other ranks.
/// \return false if they have not come within some time [s]
bool meet(double patience)
{
  MPI_Request all_here;
  MPI_Ibarrier(meeting_place(), &all_here);
  const auto start = std::chrono::steady_clock::now();
  int done = 0;
  while (MPI_Test(&all_here, &done, MPI_STATUS_IGNORE), !done) {
    if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(patience))
      return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

constexpr double patience_after_errors = 5; ///< [s]

void keep_silent()
{
  last_words() = dup(STDERR_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  std::fflush(stdout);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  close(nowhere);
}

/// Keeps what the program does on signals while something else is started that would change it.
class KeptSignals {
public:
  KeptSignals()
  {
    for (std::size_t k = 0; k < actions_.size(); ++k)
      known_[k] = sigaction(int(k) + 1, nullptr, &actions_[k]) == 0;
  }
  ~KeptSignals()
  {
    for (std::size_t k = 0; k < actions_.size(); ++k)
      if (known_[k])
        sigaction(int(k) + 1, &actions_[k], nullptr);
  }
  KeptSignals(const KeptSignals&) = delete;

private:
  std::array<struct sigaction, 31> actions_{};
  std::array<bool, 31> known_{};
};

int size_from(const char* variable)
{
  const char* const text = std::getenv(variable);
  return text ? std::atoi(text) : 0;
}

} // namespace

bool started_by_mpirun()
{
  return size_from("OMPI_COMM_WORLD_SIZE") > 1 || size_from("PMI_SIZE") > 1;
}

Ranks::Ranks()
{
  if (!runs()) {
    const KeptSignals signals;
    int n_arguments = 0;
    char** arguments = nullptr;
    session() =
        std::make_unique<dealii::Utilities::MPI::MPI_InitFinalize>(n_arguments, arguments, 1);
    MPI_Comm_dup(MPI_COMM_WORLD, &meeting_place());
    Eigen::setNbThreads(1);
    int mine = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &mine);
    if (mine > 0)
      keep_silent();
  }
  MPI_Comm_size(MPI_COMM_WORLD, &number_);
  MPI_Comm_rank(MPI_COMM_WORLD, &mine_);
}

bool Ranks::any(bool mine) const
{
  return dealii::Utilities::MPI::max(int(mine), MPI_COMM_WORLD) == 1;
}

bool Ranks::all_here() const
{
  return meet(patience_after_errors);
}

void end_ranks(int exit_code, const char* message)
{
  if (!runs())
    return;
  constexpr double endless = 1e9;
  if (!meet(exit_code != 0 ? patience_after_errors : endless)) {
    const std::string text = fmt::format("error on one rank: {}\n", message);
    if (last_words() >= 0 && write(last_words(), text.data(), text.size()) < 0)
      std::perror("mastic");
    MPI_Abort(MPI_COMM_WORLD, exit_code);
  }
  MPI_Comm_free(&meeting_place());
  session().reset();
}

} // namespace apps
