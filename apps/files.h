#pragma once
#include <filesystem>
#include <string>

namespace apps {

/// Writes a text under a temporary name, makes sure that it is on the disk, and renames it.
/// \throws std::runtime_error with the path
void write_text_file(const std::filesystem::path& file, const std::string& text);

/// Folder with the files that belong to the program (the plotting script).
/// \throws std::runtime_error if it cannot be found
std::filesystem::path share_folder();

/// The program's own file.
std::filesystem::path own_executable();

} // namespace apps
