#pragma once
#include "apps/scene.h"
#include "dem/assembly.h"
#include "dem/packing.h"
#include "dem/reduced_time.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Particles and what came with them.
struct Packing {
  dem::Particles particles;
  std::optional<std::vector<dem::Support>> support; ///< from the file, if it says
  std::vector<dem::ParticleLoad> loads;
  dem::PlatenHeights platens;                    ///< [m]
  std::string origin;                            ///< "generated, seed 1" or the file
  std::optional<double> diameter = std::nullopt; ///< of the specimen, if the packing knows it [m]
};

/// The request for a generated specimen.
dem::PackingRequest packing_request(const Scene& scene);

/// Makes or reads the packing of a scene.
/// \throws std::invalid_argument with file and line
Packing make_packing(const LoadedScene& scene);

/// Content of the particle and bond files that a scene names, as a short text: equal for equal
/// files.
std::string files_fingerprint(const LoadedScene& scene);

/// What a stored packing was made from: the keys of the section Specimen that matter for it.
std::string packing_recipe(const Scene& scene);

void write_packing(const std::filesystem::path& file, const Packing& packing,
                   const std::string& recipe);

/// \throws std::invalid_argument if the file is damaged or, for a given recipe, was made from
/// another
Packing read_packing(const std::filesystem::path& file, const std::optional<std::string>& recipe);

/// Whether the temperature changes during the test.
bool has_temperature_history(const Scene& scene);

/// Reduced time of a test whose temperature changes, for bond laws at the reference temperature;
/// nothing for others.
/// \throws std::invalid_argument if the history cannot be, or the shift law does not reach there
std::optional<dem::ReducedTime> make_reduced_time(const Scene& scene);

/// Factor a_T on all viscosities at the temperature of the test; 1 if the temperature changes.
/// \throws std::invalid_argument if the shift law does not reach there
double viscosity_shift(const Scene& scene);

/// The laws of the sections Bonds and 'Bond law NAME', in the order of their names, with
/// viscosities times the shift a_T.
/// \throws std::invalid_argument naming the constant that cannot be
std::vector<dem::BondLaw> bond_laws(const Scene& scene, double shift);

/// Which of them holds between two classes of particles: the law of section Bonds for all pairs
/// that no other section names.
/// \throws std::invalid_argument for a class that no particle has
std::vector<dem::PairLaw> pair_laws(const Scene& scene, const dem::Particles& particles);

/// Strengths of bonds by the section Strength.
/// \throws std::invalid_argument as dem::draw_strengths
dem::Strengths drawn_strengths(const Scene& scene, std::span<const std::int64_t> bond_id,
                               std::uint64_t seed);

/// The bonded specimen with its strengths, and how it was bonded.
struct Specimen {
  dem::Assembly assembly;
  double bond_gap;               ///< largest bonded gap over the smaller radius
  double viscosity_shift;        ///< a_T [-]
  std::vector<dem::Index> loose; ///< particles that nothing holds and nothing loads
};
Specimen make_specimen(const LoadedScene& scene, const Packing& packing);

/// What was asked of the packing and what came out, as text with the mark NOT MET where it failed.
std::string packing_report(const Scene& scene, const Packing& packing);

} // namespace apps
