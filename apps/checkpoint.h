#pragma once
#include "apps/run.h"
#include "dem/hdf5_file.h"

#include <filesystem>

namespace apps {

/// Where the checkpoint of a result folder is.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder);

/// True if there is one, or the one before it.
bool has_checkpoint(const std::filesystem::path& folder);

void remove_checkpoints(const std::filesystem::path& folder);

/// Stores everything that a run needs to go on bit for bit. The checkpoint before it stays under
/// another name.
/// \param wall_time  used so far [s]
void write_checkpoint(const RunInProgress& run, const std::filesystem::path& folder,
                      double wall_time);

/// Takes a checkpoint that has been written over from its temporary name; the one before it stays
/// under another name until the new one is whole.
void publish_checkpoint(dem::Hdf5File& file, const std::filesystem::path& path);

/// The file of a checkpoint, or the one before it if that one is damaged.
/// \throws std::invalid_argument if both are damaged, or it is none
dem::Hdf5File open_checkpoint(const std::filesystem::path& path);

/// Refuses options that would change what is computed when a run goes on.
/// \throws std::invalid_argument naming the option
void refuse_other_options(const RunOptions& options);

/// A run as it was at a checkpoint.
struct Resumed {
  RunInProgress run;
  std::filesystem::path folder; ///< for the results
};

/// Takes up a checkpoint, or the one before it if that one is damaged.
/// \throws std::invalid_argument if it is not a checkpoint, both are damaged, or the files that the
///         scene names have changed
Resumed read_checkpoint(const std::filesystem::path& file, const RunOptions& options);

} // namespace apps
