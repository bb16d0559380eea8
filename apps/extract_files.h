#pragma once
#include "apps/extract.h"

#include <filesystem>
#include <string>

namespace apps {

/// What came out, in some lines for the terminal: sizes, bounds, law, verdict.
std::string extraction_report(const LoadedScene& scene, const Extraction& extraction);

/// Writes law file, tables, extraction.h5 and figures, and says where they are.
void write_extraction(const LoadedScene& scene, const Extraction& extraction,
                      const std::filesystem::path& folder);

} // namespace apps
