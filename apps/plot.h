#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace apps {

/// Draws the figures of one result folder, or of several in common figures, into a folder.
/// \return the files made; if Python or Matplotlib is missing, nothing and a warning on standard
///         error
std::vector<std::string> make_figures(const std::vector<std::filesystem::path>& results,
                                      const std::filesystem::path& folder);

/// Draws the figure of a study of solvers from the study.csv in its folder. \return the same
std::vector<std::string> make_study_figure(const std::filesystem::path& folder);

/// Draws the figures of an extracted law from the tables in its folder. \return the same
std::vector<std::string> make_extraction_figures(const std::filesystem::path& folder);

/// Draws the figure of a calibrated bond law from the tables in its folder. \return the same
std::vector<std::string> make_calibration_figures(const std::filesystem::path& folder);

/// Draws the figures of a fit from the tables in its folder. \return the same
std::vector<std::string> make_fit_figures(const std::filesystem::path& folder);

} // namespace apps
