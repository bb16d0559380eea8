#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dem {

/// One row of a sieve table.
struct Sieve {
  double opening; ///< [m], > 0
  double passing; ///< share of the mass that passes [-], 0 to 1
};

/// How the mass of a class lies between its two sieves.
enum class MassSpread {
  log_uniform, ///< uniform over the logarithm of the diameter: number density ~ d^-4
  uniform      ///< uniform over the diameter: number density ~ d^-3
};

/// Particle sizes as the mass passing a set of sieves, finest first.
struct Grading {
  std::vector<Sieve> sieves;
  MassSpread spread = MassSpread::log_uniform;
};

/// Checked grading: openings and passing shares increase, from 0 to 1.
/// \throws std::invalid_argument with the row at fault
Grading make_grading(std::vector<Sieve> sieves, MassSpread spread = MassSpread::log_uniform);

/// Names of the gradings that come with the program.
std::span<const std::string_view> grading_names();

/// A grading by name; all are estimates for the coarse part (> 2 mm) of a 0-10 mm stone mastic
/// asphalt: `sma10` (recommended), `sma10-uniform` (2 to 10 mm, mass uniform over the diameter),
/// `sma10-gap` (gap graded).
/// \throws std::invalid_argument for another name
Grading named_grading(std::string_view name);

/// Spheres of one diameter [m] (to 1e-6).
/// \throws std::invalid_argument unless it is > 0
Grading monodisperse_grading(double diameter);

/// Mean volume of a particle [m^3], by number.
double mean_particle_volume(const Grading& grading);

/// n diameters [m] that represent the grading: the quantiles (k + 1/2) / n of the distribution by
/// number, in increasing order. No chance is involved.
std::vector<double> representative_diameters(const Grading& grading, std::size_t n);

/// Share of the volume of the spheres with these diameters [m] that passes each opening [m].
std::vector<double> passing(std::span<const double> diameter, std::span<const Sieve> sieves);

} // namespace dem
