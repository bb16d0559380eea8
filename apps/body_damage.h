#pragma once
#include "coupling/volume_points.h"
#include "dem/hdf5_file.h"
#include "fem/elements.h"
#include "fem/field_files.h"

#include <vector>

namespace apps {

/// What broke where in a body, cell by cell, for a picture.
struct BodyDamage {
  std::vector<double> vertices;       ///< eight places of each cell, x y z [m]; fewer repeat
  std::vector<fem::CellField> fields; ///< as `volume_fields`
};

/// All cells on the first rank; nothing on the others.
template <int dim>
BodyDamage body_damage(const fem::Elements<dim>& elements, const coupling::BreakingPoints& points);

/// Stores it under the group "damage".
void write_damage(dem::Hdf5File& file, const BodyDamage& damage);

} // namespace apps
