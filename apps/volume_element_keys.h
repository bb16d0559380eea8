#pragma once
#include "apps/schema.h"
#include "dem/homogenization.h"

#include <string>
#include <vector>

namespace apps {

enum class ElementSource { grow, file, cut };
enum class LawSymmetry { full, orthotropic, transversely_isotropic, isotropic };

/// The section "Volume element": which representative volumes a law is taken from, and how.
struct VolumeElementInput {
  ElementSource source;
  std::vector<double> edges; ///< 3 lengths or 9 components [m]; empty: a cube of fitting size
  double cut_layer;          ///< thickness of the boundary of a cut element [m]
  dem::BoundaryCondition condition;
  bool bounds;
  long n_realisations;
  std::vector<double> sizes; ///< numbers of particles; empty: Specimen/Particles
  double accuracy;           ///< wanted [-]
  LawSymmetry symmetry;
  double first_time, last_time; ///< [s]
  long n_times, n_terms;
  double tolerance;                 ///< of time stepping [-]
  std::vector<double> temperatures; ///< of the complex modulus [K]
};

void declare(Schema& schema, VolumeElementInput& input);

/// The cell of the key Edges.
/// \throws std::invalid_argument unless there are 3 or 9 numbers that make a cell
dem::PeriodicCell cell_of(const std::vector<double>& edges);

} // namespace apps
