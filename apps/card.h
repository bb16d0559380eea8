#pragma once
#include <string>

namespace apps {

/// What `mastic card` is asked for.
struct CardOptions {
  std::string source;         ///< law file; a scene for the format pfc
  std::string format;         ///< a name of coupling::card_formats, or pfc
  std::string output;         ///< folder; empty: NAME-FORMAT here
  std::string units = "si";   ///< or mm
  std::string time = "1e5 s"; ///< until when a bond law is used
};

/// Writes a law as input of another program, with a check deck and a note, and prints the note.
/// \return the exit code
/// \throws std::invalid_argument for a file, format or units that do not exist, and for a law that
///         the format cannot hold
int card_verb(const CardOptions& options);

} // namespace apps
