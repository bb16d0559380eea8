#pragma once

namespace fem {

/// How the volume strain enters.
enum class Dilatation {
  pointwise, ///< as it is; locks where the material is nearly incompressible
  projected  ///< hexahedra: on polynomials of one degree less than the displacement, in each cell;
             ///< simplices of degree 2 and more: on its mean in the cell. Does not lock.
};

/// Finite elements on a mesh.
struct Discretisation {
  int order = 1; ///< of the displacement: 1, 2 or 3
  Dilatation dilatation = Dilatation::projected;
};

} // namespace fem
