#pragma once
#include "apps/element_realisations.h"
#include "fem/law_file.h"

#include <complex>
#include <string>
#include <vector>

namespace apps {

/// Mean and scatter of one number over realisations.
struct Scatter {
  std::size_t n;
  double mean, deviation; ///< deviation: standard deviation of one realisation; 0 for n = 1
  double band;            ///< half of the 95 % confidence interval of the mean; infinite for n = 1
};

/// All realisations of one size.
struct SizeResult {
  std::size_t n_particles;
  double size_ratio;                            ///< edge over the largest diameter, mean [-]
  Scatter young, poisson;                       ///< of the nearest isotropic tensor [Pa], [-]
  std::array<std::optional<Scatter>, 4> bounds; ///< Young's modulus under `all_conditions` [Pa]
  double anisotropy;                            ///< of the mean compliance: distance to isotropy
};

/// What the volume elements of a scene say together.
struct Extraction {
  std::vector<Realisation> realisations;
  std::vector<SizeResult> sizes;  ///< by rising number of particles
  coupling::ExtractedLaw law;     ///< of the largest size, full tensor
  double symmetry_distance;       ///< of the law that is written from that
  fem::LawRecord record;          ///< of the law that is written
  std::vector<std::string> notes; ///< one sentence each: verdict, warnings
};

/// Sums up realisations.
/// \throws std::invalid_argument if they do not make a law
Extraction sum_up(const LoadedScene& scene, std::vector<Realisation> realisations);

/// Takes a law from the volume elements of a scene; writes law, tables, figures. \return the exit
/// code
int extract_verb(const std::string& scene, const std::string& output, const RunOptions& options);

} // namespace apps
