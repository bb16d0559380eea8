#pragma once
#include <functional>

#include <mpi.h>

namespace apps {

/// The processes that share a run, started by mpirun; a single one otherwise. They begin with the
/// first object and end with the program.
class Ranks {
public:
  /// Starts MPI unless it runs; the other ranks than the first keep silent from then on.
  Ranks();

  MPI_Comm all() const { return MPI_COMM_WORLD; }
  int number() const { return number_; } ///< of ranks
  bool first() const { return mine_ == 0; }

  /// True on all ranks if it is true on one.
  bool any(bool mine) const;

  /// Whether all ranks come here within some seconds: what one of them alone runs into is nothing
  /// that they could go on with together.
  bool all_here() const;

private:
  int number_, mine_;
};

/// Whether mpirun started this program with more than one rank.
bool started_by_mpirun();

/// Ends MPI if it runs. After an error: waits for the other ranks a few seconds, and kills them if
/// they do not come to their end, too, which leaves no rank waiting for one that failed.
/// \param message  what went wrong; told by the rank that kills
void end_ranks(int exit_code, const char* message);

} // namespace apps
