#pragma once
#include "apps/run.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// The scene of one run of a study: nothing of the section Study is left in it, and its files have
/// full names.
LoadedScene scene_of_run(const LoadedScene& study, const std::string& name,
                         std::vector<std::string> settings);

/// The file with the packing of each run of a study: the one given on the command line, or one in
/// the study's folder, made if need be, for each packing that several runs share. Nothing for runs
/// that make their own. \throws std::invalid_argument if one is given that does not fit all of them
std::vector<std::optional<std::filesystem::path>>
study_packings(const std::vector<LoadedScene>& scenes, const std::filesystem::path& folder,
               const RunOptions& options);

} // namespace apps
