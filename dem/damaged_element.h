#pragma once
#include "dem/macro_network.h"
#include "dem/network_solver.h"
#include "dem/records.h"
#include "dem/strength.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace dem {

/// Elastic answer of a periodic volume element some of whose bonds are broken: a value.
///
/// Everything is per unit of the elastic part of the mean strain (Mandel notation): for
/// proportional laws that is all that bond forces depend on.
struct DamagedElement {
  std::vector<BondStatus> status; ///< of each bond
  Mat6 stiffness;                 ///< C [Pa], positive semidefinite
  /// Three rows for each bond [N]: normal force (tension positive) and two shear forces.
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor> force;
  std::vector<double> reach;    ///< each bond: normal force per unit strain, at most [N]
  Mat6 ground_energy;           ///< of the weak springs that hold what contacts cannot [Pa]
  std::vector<bool> is_clamped; ///< each bond: whether such springs hold an end of it
  std::size_t n_broken = 0;     ///< bonds that are not intact
  bool has_contacts = false;    ///< whether some are pressed
  std::string obstacle;         ///< why there is no equilibrium; empty: there is
};

/// A periodic volume element of proportional laws whose bonds can break: what does not change. Safe
/// to share between threads.
class BreakableElement {
public:
  /// \throws std::invalid_argument if the element was cut out of a packing, its laws are not
  ///         proportional, friction is asked for, or strengths are missing
  BreakableElement(VolumeElement element, Strengths strengths, AfterBreakage after_breakage);

  const VolumeElement& element() const { return element_; }
  const Strengths& strengths() const { return strengths_; }
  AfterBreakage after_breakage() const { return after_breakage_; }
  const CreepLaw& creep() const { return creep_; } ///< that all bonds share
  double volume() const { return macro_.volume; }  ///< [m^3]
  std::size_t n_bonds() const { return macro_.bonds.size(); }

  /// The answer with all bonds in place.
  const std::shared_ptr<const DamagedElement>& intact() const { return intact_; }

  /// The answer with bonds of this status: one factorisation on a symbolic analysis that is kept,
  /// and six solutions, to 1e-10 of the largest force. Bonds of pieces that nothing holds carry
  /// nothing. Depends on the status alone.
  std::shared_ptr<const DamagedElement> answer(std::vector<BondStatus> status) const;

private:
  std::unique_ptr<MacroSolver> borrowed_solver() const;

  VolumeElement element_;
  Strengths strengths_;
  AfterBreakage after_breakage_;
  CreepLaw creep_;
  MacroNetwork macro_;
  std::shared_ptr<const DamagedElement> intact_;
  mutable std::mutex lock_;
  mutable std::vector<std::unique_ptr<MacroSolver>> idle_; ///< scratch, one for each thread at work
};

/// Largest force over reference strength among the intact bonds under an elastic strain [-]. Forces
/// below 1e-12 of the largest are rounding and count as 0.
double largest_ratio(const DamagedElement& element, const Strengths& strengths, const Vec6& strain);

/// One bond at its strength.
struct CriticalBond {
  Index bond;
  BreakMode mode;
  double normal_force, shear_force; ///< [N], tension positive
  double ratio;                     ///< of force to reference strength [-]
};

/// Intact bonds whose ratio is at least this.
std::vector<CriticalBond> bonds_from(const DamagedElement& element, const Strengths& strengths,
                                     const Vec6& strain, double ratio);

/// Status after bonds have broken: a bond that was pressed stays as a contact if the rule says so.
std::vector<BondStatus> with_broken(const DamagedElement& element, AfterBreakage after_breakage,
                                    std::span<const CriticalBond> broken);

/// Pressed contacts that would pull under an elastic strain, or whose particles are squeezed out.
std::vector<Index> contacts_to_open(const DamagedElement& element, const Vec6& strain);

/// What all bonds and contacts of an element say under an elastic strain.
struct Look {
  double ratio; ///< largest force over reference strength [-]
  /// How far pressed contacts are from pulling: a change of the strain whose norm is less opens
  /// none. Negative if some pull or are squeezed out; infinite without any.
  double opening_margin;
};
Look look_at(const DamagedElement& element, const Strengths& strengths, const Vec6& strain);

/// Share in (0, 1] of the way from one elastic strain to another at which the first pressed contact
/// begins to pull; 1 if none does.
double share_until_opening(const DamagedElement& element, const Vec6& from, const Vec6& to);

} // namespace dem
