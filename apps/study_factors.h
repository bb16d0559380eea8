#pragma once
#include <string>
#include <utility>
#include <vector>

namespace apps {

/// One run of a study: its name and what makes it differ from the scene.
struct StudyRun {
  std::string name;                                        ///< of its folder
  std::string value;                                       ///< of the keys that are varied, to read
  std::vector<std::pair<std::string, std::string>> levels; ///< "Section/Key" and its value

  /// "Section/Key = value" of each key.
  std::vector<std::string> settings() const;
};

/// The keys that a study varies, in order; keys that change together are joined by '&', and
/// factors, all levels of which are combined, separated by ';'.
std::vector<std::string> varied_keys(const std::string& vary);

/// What is wrong with the texts of Study/Vary and Study/Values; empty if nothing is.
std::vector<std::string> factor_problems(const std::string& vary, const std::string& values);

/// The runs of a study: all combinations of the levels of its factors, the last factor changing
/// fastest. `values` lists the levels of each factor, separated by commas, or by bars if values
/// hold commas, in the form of `vary`; "1..5" stands for the whole numbers from 1 to 5. Names
/// differ from each other.
std::vector<StudyRun> combined_runs(const std::string& vary, const std::string& values);

/// A value as the name of a folder: "400 kPa" is "400-kPa".
std::string as_folder_name(const std::string& value);

} // namespace apps
