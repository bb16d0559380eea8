#pragma once
#include "fem/compliance_law.h"
#include "fem/specimen.h"

#include <complex>
#include <map>

namespace fem {

/// Force on the driven boundaries per unit of the drive, at a frequency.
struct ComplexStiffness {
  double omega;               ///< [rad/s]
  std::complex<double> value; ///< storage and loss [N per unit of the drive]
  int n_iterations;
};

/// Steady response of a body to a small oscillation of the drive: at each frequency one complex
/// linear system of the complex stiffnesses of the laws, without inertia. Real and imaginary part
/// are solved together by GMRES; the multigrid of storage plus loss stiffness serves both.
/// \param laws           one or more
/// \param law_of_point   number of the law of each point
/// \throws std::invalid_argument if nothing is driven; std::runtime_error if a system is not solved
template <int dim>
std::vector<ComplexStiffness> drive_stiffness(const Specimen<dim>& specimen,
                                              std::span<const ComplianceLaw> laws,
                                              std::span<const int> law_of_point,
                                              std::span<const double> omegas, double tolerance);

} // namespace fem
