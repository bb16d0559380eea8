#pragma once
#include "dem/hdf5_file.h"

#include <filesystem>
#include <string>

namespace apps {

/// Writes a text under a temporary name, makes sure that it is on the disk, and renames it.
/// \throws std::runtime_error with the path
void write_text_file(const std::filesystem::path& file, const std::string& text);

/// Opens an HDF5 file that the user names, of a kind ("result", "packing", "checkpoint"), or of any
/// kind if that is empty.
/// \throws std::invalid_argument if it cannot be read, is cut off, is of another kind or newer than
///         this program
dem::Hdf5File open_stored(const std::filesystem::path& file, const std::string& kind);

/// Refuses a folder in which nothing could be written, without making it.
/// \throws std::invalid_argument naming what is in the way
void require_writable(const std::filesystem::path& folder);

/// The full name of a folder; "" is the present one.
std::filesystem::path absolute_folder(const std::filesystem::path& folder);

/// A file or folder that the user names.
/// \throws std::invalid_argument if it is not there
std::filesystem::path existing(const std::string& name, const char* what = "file or folder");

/// Makes a folder and those above it.
/// \throws std::runtime_error with the path
void make_folder(const std::filesystem::path& folder);

/// Folder with the files that belong to the program (the plotting script).
/// \throws std::runtime_error if it cannot be found
std::filesystem::path share_folder();

/// The program's own file.
std::filesystem::path own_executable();

} // namespace apps
