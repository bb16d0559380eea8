#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace apps {

/// Something to tell the user about a place in a scene.
struct Diagnostic {
  enum class Kind { error, warning, note };
  Kind kind;
  std::string place; ///< "creep.scene:12", or where else the text came from
  std::string message;
};

/// One `set` of a scene file or of the command line.
struct SceneEntry {
  std::vector<std::string> sections;
  std::string key, value;
  std::string place;

  std::string section() const; ///< "Loading"
  std::string path() const;    ///< "Loading/Axial stress"
};

/// What a scene file says, before anything is known about its keys.
///
/// The syntax is that of deal.II's parameter files: `subsection NAME` ... `end`, `set KEY = VALUE`,
/// `include FILE` (relative to the file it stands in, as if its lines stood there), `#` to the end
/// of the line is a comment, a backslash at the end continues the line.
struct SceneText {
  std::vector<SceneEntry> entries;
  std::vector<Diagnostic> diagnostics;
};

/// \throws std::invalid_argument if the file cannot be read
SceneText read_scene_text(const std::filesystem::path& file);

/// The same from a text, for `include`s relative to a folder.
SceneText scan_scene(const std::string& text, const std::string& name,
                     const std::filesystem::path& folder);

/// An override "Section/Key = value" of the command line.
/// \throws std::invalid_argument if it has another form
SceneEntry override_entry(const std::string& text);

/// Whole content of a text file, without the mark that some editors put before UTF-8.
/// \throws std::invalid_argument with the path
std::string read_text_file(const std::filesystem::path& file);

} // namespace apps
