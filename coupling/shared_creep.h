#pragma once
#include "dem/creep_law.h"
#include "fem/types.h"

#include <span>
#include <vector>

namespace coupling {

/// The one creep function of a proportional network, for strains: E = J/J(0) * e, where e is the
/// elastic part of the strain, taken as linear within a step of reduced time.
///
/// Whatever breaks, e follows from the history of the strain alone, and the stress is the present
/// stiffness times e: the creeping parts cannot jump.
class SharedCreep {
public:
  explicit SharedCreep(const dem::CreepLaw& law);

  std::size_t n_branches() const { return branch_.size(); }

  /// A part of a step: how much strain the creeping parts gain.
  struct Part {
    double duration = 0;                     ///< of reduced time [s]
    double flow = 0;                         ///< strain of the dashpot per constant unit of e [-]
    double flow_growth = 0;                  ///< per unit of growth of e over the part
    std::vector<double> decay, held, growth; ///< of each branch, likewise; decay of what it has
  };
  Part part(double duration) const;

  /// Strain per growth of e over the part; the algorithmic stiffness is the elastic one over this.
  double compliance(const Part& part) const;

  /// Strain that the creeping parts gain.
  /// \param kelvin  strains of the branches at the start
  fem::Vec6 gain(const Part& part, const fem::Vec6& elastic, const fem::Vec6& growth,
                 std::span<const fem::Vec6> kelvin) const;

  /// Strains of the branches at the end of the part.
  void advance(const Part& part, const fem::Vec6& elastic, const fem::Vec6& growth,
               std::span<fem::Vec6> kelvin) const;

  /// Rate of the creeping parts at the end of a part, per reduced time [1/s].
  fem::Vec6 rate(const Part& part, const fem::Vec6& elastic, const fem::Vec6& growth,
                 std::span<const fem::Vec6> kelvin) const;

  /// Strain of a constant unit of e over a part, without what the branches have: what an error of e
  /// in the middle of a step costs.
  double held(const Part& part) const;

private:
  struct Branch {
    double time;  ///< retardation time [s]
    double share; ///< strain in the long run per e [-]
  };
  double fluidity_ = 0; ///< strain rate of the dashpot per e [1/s]
  std::vector<Branch> branch_;
};

} // namespace coupling
