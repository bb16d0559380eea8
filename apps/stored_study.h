#pragma once
#include "apps/run.h"

#include <filesystem>
#include <string>
#include <vector>

namespace apps {

/// A study or a collection of scenes as it was begun.
struct StoredStudy {
  LoadedScene scene;
  std::vector<std::string> overrides; ///< of the command line, when it began
};

/// The file in which a study is stored within its folder.
constexpr const char* study_file = "study.scene";

/// Whether a folder holds a study.
bool is_study(const std::filesystem::path& folder);

/// Stores a study in its folder, so that it can be gone on with.
void store_study(const LoadedScene& scene, const std::filesystem::path& folder,
                 const std::vector<std::string>& overrides);

/// Reads a study from its folder, its results to be in that folder.
/// \param overrides  further settings
/// \throws std::invalid_argument if the file was changed
StoredStudy read_study(const std::filesystem::path& folder,
                       const std::vector<std::string>& overrides);

} // namespace apps
