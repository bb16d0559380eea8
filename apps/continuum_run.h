#pragma once
#include "apps/run.h"

namespace apps {

/// Runs a scene with Solver = continuum to its end and writes the results; over the ranks of
/// mpirun, if it was started by that.
/// \return the exit code
int run_continuum(LoadedScene scene, const RunOptions& options);

/// Goes on from a checkpoint of such a run, on this or another number of ranks.
int resume_continuum(const std::filesystem::path& checkpoint, const RunOptions& options);

/// Reads the laws and makes the body of a scene, to see whether they can be used.
/// \throws std::invalid_argument saying what is wrong
void check_continuum_files(const LoadedScene& scene);

/// True if a checkpoint is one of such a run.
bool is_continuum_checkpoint(const std::filesystem::path& checkpoint);

} // namespace apps
