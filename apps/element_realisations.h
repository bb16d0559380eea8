#pragma once
#include "apps/run.h"
#include "coupling/extraction.h"

#include <array>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// The order in which stiffness falls.
inline constexpr std::array all_conditions{
    dem::BoundaryCondition::affine, dem::BoundaryCondition::kinematic,
    dem::BoundaryCondition::periodic, dem::BoundaryCondition::uniform_traction};

std::string name_of(dem::BoundaryCondition condition);

/// Output/Frequencies as angular frequencies [rad/s].
std::vector<double> angular_frequencies(const Scene& scene);

/// One volume element, and what it answered.
struct Realisation {
  std::size_t n_particles, n_bonds;
  std::uint64_t seed;
  double volume;           ///< [m^3]
  double size_ratio;       ///< shortest distance of two faces over the largest diameter [-]
  double solid_fraction;   ///< [-]
  double bond_gap;         ///< largest bonded gap over the smaller radius [-]
  std::size_t n_loose = 0; ///< particles that carry nothing
  /// Elastic stiffness [Pa], Mandel, under each of `all_conditions` that was computed.
  std::array<std::optional<dem::Mat6>, 4> stiffness;
  double hill_mandel = 0;                           ///< largest relative difference
  std::optional<coupling::MeanCompliance> samples;  ///< S(t) if the bonds follow several laws
  std::vector<fem::ComplexMat6> complex_compliance; ///< then also S* at the scene's frequencies
};

/// What is to be done for one realisation.
struct RealisationTask {
  std::size_t n_particles; ///< 0: as the source says
  std::uint64_t seed;
  bool wants_samples; ///< S(t) by time stepping
};

/// The tasks that the section Volume element asks for, the largest size first.
std::vector<RealisationTask> realisation_tasks(const Scene& scene);

/// A folder in which grown packings are kept and found the next time.
struct PackingStore {
  std::filesystem::path folder; ///< empty: they are not kept
  std::mutex lock;              ///< HDF5 is not made for several threads
};

/// Volume element of a scene.
/// \throws std::invalid_argument if the scene and its files do not make an element
dem::VolumeElement make_element(const LoadedScene& scene, const RealisationTask& task,
                                PackingStore& store);

/// Makes an element and lets it answer.
Realisation realise(const LoadedScene& scene, const RealisationTask& task, PackingStore& store);

/// All of them, on several threads; the results depend on how many
/// only in rounding. Ends early when the user
/// asks for it: what is not done is absent.
std::vector<std::optional<Realisation>> realise_all(const LoadedScene& scene,
                                                    const std::vector<RealisationTask>& tasks,
                                                    PackingStore& store, const RunOptions& options);

} // namespace apps
