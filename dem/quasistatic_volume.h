#pragma once
#include "dem/assembly.h"
#include "dem/equilibrium.h"
#include "dem/mandel.h"
#include "dem/volume_element.h"

#include <optional>
#include <vector>

namespace dem {

/// A periodic volume element for the quasi-static solver: it does not change.
///
/// Any bond laws, friction, contacts that close, open and slide; finite motion of the particles if
/// the settings say so. The cell deforms by I + E with a symmetric E: it strains and does not turn.
struct QuasistaticVolume {
  VolumeElement element;
  QuasistaticSettings settings;
  Assembly assembly; ///< the same particles, laws and bonds, and the strengths
  Bodies bodies;
  LinkDofs dofs;
  double skin;                   ///< gap up to which pairs are linked [m]
  std::optional<CreepLaw> creep; ///< that all bonds share, if their laws are proportional
  /// Motion of the particles on top of the mean strain, per unit strain of the intact elastic
  /// volume; rotations times the radius. Empty without a shared law.
  Eigen::MatrixXd localisation;

  const Strengths& strengths() const { return *assembly.strengths; }
};

/// \throws std::invalid_argument if the element was cut out of a packing, a sphere is bonded to its
///         own image, or strengths are missing
QuasistaticVolume make_quasistatic_volume(VolumeElement element, Strengths strengths,
                                          const QuasistaticSettings& settings);

/// What has happened to a volume: a value.
struct QuasistaticVolumeState {
  Mat3 strain = Mat3::Zero();      ///< E of the cell [-]
  Mat3 searched_at = Mat3::Zero(); ///< E when near pairs were last looked for
  Vec6 stress = Vec6::Zero();      ///< conjugate to E, per volume at rest, Mandel notation [Pa]
  std::vector<Vec3> centre;        ///< of all bodies [m]
  std::vector<Vec3> rotation;      ///< sum of the turns of each body [rad]
  Links links;
};

QuasistaticVolumeState at_rest(const QuasistaticVolume& volume);

/// The state of an intact volume whose bonds share one law: E = e and what its Kelvin branches and
/// dashpot make of it. Exact while displacements are small; what finite motion changes is out of
/// balance until the next step.
/// \param elastic  e, elastic part of the strain
/// \param kelvin   strain of each branch
/// \param strain   of the cell
/// \throws std::invalid_argument without a shared law
QuasistaticVolumeState carried_over(const QuasistaticVolume& volume, const Vec6& elastic,
                                    std::span<const Vec6> kelvin, const Vec6& strain);

/// The state after bonds have broken.
QuasistaticVolumeState with_broken(const QuasistaticVolume& volume, QuasistaticVolumeState state,
                                   std::span<const Index> bonds);

std::size_t n_broken(const QuasistaticVolume& volume, const QuasistaticVolumeState& state);

/// Ratio of force to reference strength of each bond; 0 where it is broken.
std::vector<double> strength_ratios(const QuasistaticVolume& volume,
                                    const QuasistaticVolumeState& state);

/// A step of a volume.
struct QuasistaticVolumeStep {
  QuasistaticVolumeState state; ///< at its end
  Mat6 tangent;                 ///< of the stress over the increment of E, Mandel notation [Pa]
  double error = 0;             ///< estimated, of the stress gained, relative
  int n_passages = 0;           ///< overdamped steps that it took to find an equilibrium
};

/// Finds the equilibria of volumes: holds what can be used again, not a state.
class VolumeFollower {
public:
  explicit VolumeFollower(const QuasistaticVolume& volume);

  /// The state after the strain has changed by `increment` in a duration of reduced time, with the
  /// forces of the links linear in time; the tangent is condensed, not differenced: exact but for
  /// the change of geometry within the step.
  ///
  /// Where no equilibrium is near, the particles move overdamped until they stand again.
  /// \return nothing if they do not
  std::optional<QuasistaticVolumeStep> step(const QuasistaticVolumeState& from,
                                            const Vec6& increment, double duration);

private:
  struct Found {
    Equilibrium equilibrium;
    QuasistaticVolumeStep step;
  };
  std::optional<Found> attempt(const QuasistaticVolumeState& from, const Mat3& increment,
                               double duration, double hold_everything);
  Mat6 condensed(std::span<const LinkTangent> tangent, const Links& links,
                 std::span<const double> hold, double stiffness);

  const QuasistaticVolume* volume_;
  EquilibriumFinder finder_;
  std::vector<std::array<Index, 2>> analysed_; ///< ends of the links of the pattern
  std::optional<LinkAssembly> assembly_;
  std::optional<SupernodalFactor> factor_;
};

} // namespace dem
