#pragma once
#include "apps/run.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A value as the name of a folder: "400 kPa" is "400-kPa".
std::string as_folder_name(const std::string& value);

/// The scene of one run of a study: nothing of the section Study is left in it, and its files have
/// full names.
LoadedScene scene_of_run(const LoadedScene& study, const std::string& name,
                         std::vector<std::string> settings);

/// The packing that all runs of a study share, if they do: the one given on the command line, or
/// one in the study's folder, made if need be.
/// \throws std::invalid_argument if one is given that does not fit
std::optional<std::filesystem::path> shared_packing(const std::vector<LoadedScene>& scenes,
                                                    const std::filesystem::path& folder,
                                                    const RunOptions& options);

} // namespace apps
