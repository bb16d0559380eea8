#pragma once
#include <functional>
#include <stdexcept>

#include <mpi.h>

namespace fem {

/// Something that failed on a rank, as all ranks come to know it.
class RankFailure : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Does what may fail on a rank alone, for want of memory or of room on a disk. If it does, no rank
/// waits in vain for one that has failed: all throw.
/// \param work  speaks to no other rank
/// \throws RankFailure, or std::invalid_argument if it was that, with the message of the first rank
///         that failed
void together(MPI_Comm ranks, const std::function<void()>& work);

} // namespace fem
