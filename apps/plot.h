#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Draws the figures of one result folder, or of several in common figures, into a folder.
/// \return the files made; if Python or Matplotlib is missing, nothing and a warning on standard
///         error
std::vector<std::string> make_figures(const std::vector<std::filesystem::path>& results,
                                      const std::filesystem::path& folder);

/// Makes the tables, the statistics and, if wanted, the figures of a study from the runs in its
/// folder. \return the figures made; a warning if Python is missing
std::vector<std::string> make_study_summary(const std::filesystem::path& folder, bool figures);

/// Makes one HTML page of result folders, or of folders that hold such. \return its path, or
/// nothing and a warning
std::optional<std::string> make_report(const std::vector<std::filesystem::path>& results,
                                       const std::filesystem::path& file);

/// What is rendered of the particles and bonds of a result.
struct PictureOptions {
  std::string time;   ///< of the snapshot [s]; empty: the last
  double magnify = 1; ///< of the displacements [-]
};

/// Renders the particles and bonds of a result into a folder. \return the pictures, or nothing and
/// a warning
std::vector<std::string> make_pictures(const std::filesystem::path& result,
                                       const std::filesystem::path& folder,
                                       const PictureOptions& options);

/// Draws the figure of a study of solvers from the study.csv in its folder. \return the same
std::vector<std::string> make_study_figure(const std::filesystem::path& folder);

/// Draws the figures of an extracted law from the tables in its folder. \return the same
std::vector<std::string> make_extraction_figures(const std::filesystem::path& folder);

/// Draws the figure of a calibrated bond law from the tables in its folder. \return the same
std::vector<std::string> make_calibration_figures(const std::filesystem::path& folder);

/// Draws the figures of a fit from the tables in its folder. \return the same
std::vector<std::string> make_fit_figures(const std::filesystem::path& folder);

} // namespace apps
