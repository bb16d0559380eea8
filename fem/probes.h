#pragma once
#include "fem/specimen.h"

#include <memory>
#include <vector>

namespace fem {

/// What a place of a body shows.
struct ProbeReading {
  Vec3 displacement = Vec3::Zero(); ///< [m]
  Vec6 strain = Vec6::Zero();       ///< Mandel [-]
  Vec6 stress = Vec6::Zero();       ///< Mandel [Pa]
};

/// Places in a body, found once.
///
/// Displacements are those of the elements. Strains and stresses are the polynomial through the
/// points of the cell (simplices: its mean), so they jump a little between cells.
template <int dim>
class Probes {
public:
  /// \throws std::invalid_argument for a place that is not in the body
  Probes(const Specimen<dim>& specimen, const std::vector<Vec3>& places);

  /// Readings of all places, on all ranks.
  std::vector<ProbeReading> read(const Specimen<dim>& specimen, const MaterialPoints& points) const;

private:
  struct Place {
    std::size_t cell;            ///< of this rank
    std::vector<double> shapes;  ///< values of the unknowns' shape functions
    std::vector<double> weights; ///< of the cell's points
  };
  std::vector<std::optional<Place>> places_; ///< those in cells of this rank
};

} // namespace fem
