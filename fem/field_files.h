#pragma once
#include "fem/specimen.h"

#include <filesystem>

namespace fem {

/// Another number for each cell of a rank.
struct CellField {
  std::string name; ///< with its unit
  std::vector<double> values;
};

/// Writes the fields at one time as one ParaView file (.vtu): displacement [m], means over each
/// cell of strain [-] and stress [Pa] by component, mean and von Mises stress, region, rank, and
/// others. All ranks take part. The file is written under a temporary name and renamed. \throws
/// std::runtime_error if it cannot be written
template <int dim>
void write_fields(const std::filesystem::path& file, const Specimen<dim>& specimen,
                  const MaterialPoints& points, std::span<const CellField> others = {});

/// Writes the list of files (.pvd) that makes a series for ParaView. One rank only.
void write_series(const std::filesystem::path& file,
                  const std::vector<std::pair<double, std::string>>& times_and_files);

} // namespace fem
