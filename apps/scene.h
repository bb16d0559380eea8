#pragma once
#include "apps/continuum_keys.h"
#include "apps/expectations.h"
#include "apps/schema.h"
#include "apps/volume_element_keys.h"
#include "dem/dynamics.h"
#include "dem/grading.h"
#include "dem/quasistatic_settings.h"
#include "dem/temperature_shift.h"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Which solver a scene asks for.
enum class SolverChoice { automatic, linear, events, quasistatic, dynamic, continuum };

enum class SpecimenSource { generate, file };
enum class BondRule { mean_contacts, gap };
enum class BondPreset { estimate, none };
enum class StrengthKind { none, normal, weibull };
enum class TestKind {
  creep,
  constant_rate,
  stress_history,
  strain_history,
  haversine,
  block_pulses,
  sine,
  particle_loads,
  boundary_loads
};
enum class TimeSpacing { automatic, linear, logarithmic };
enum class ShiftKind { none, wlf, arrhenius };

/// One bond law as it is typed.
struct BondLawInput {
  std::vector<std::pair<double, double>> class_pairs; ///< empty for the law of all other pairs
  double maxwell_stiffness;                           ///< [N/m]
  std::optional<double> maxwell_viscosity;            ///< [N s/m]
  std::vector<double> kelvin_stiffness;               ///< [N/m]
  std::vector<double> kelvin_viscosity;               ///< [N s/m]
  double normal_to_shear, radius_multiplier;          ///< [-]
};

/// A scene: everything a run needs, in SI units. Keys and their meaning: `declare`.
struct Scene {
  std::string title;
  SolverChoice solver;
  bool accept_unusual;
  double small_strain; ///< up to which `auto` takes displacements as small [-]

  struct Specimen {
    SpecimenSource source;
    std::string file, bond_file;
    double diameter, height; ///< [m]
    long n_particles;
    double solid_fraction;
    std::string grading;
    std::vector<std::pair<double, double>> grading_table; ///< opening [m], passing [-]
    long min_contacts;
    double contact_gap;
    double residual_stress_bound; ///< [Pa]
    double preparation_stiffness; ///< [N/m]
    double density;               ///< [kg/m^3]
    long seed;
    BondRule bond_rule;
    double mean_contacts, bond_gap;
    double platen_gap;
    std::optional<double> gauge_length; ///< [m]
  } specimen;

  BondPreset preset;
  BondLawInput bonds;
  std::map<std::string, std::unique_ptr<BondLawInput>> more_bonds; ///< by name
  dem::AfterBreakage after_breakage;
  double friction;

  struct Temperature {
    double temperature, reference;                  ///< [K]
    std::vector<std::pair<double, double>> history; ///< time [s], temperature [K]; empty: constant
    ShiftKind shift;
    double wlf_c1, wlf_c2;    ///< [-], [K]
    double activation_energy; ///< [J/mol]
  } temperature;

  struct Strength {
    StrengthKind kind;
    double mean, standard_deviation; ///< [N]
    double modulus, scale;           ///< [-], [N]
    double shear_ratio;
    dem::NonpositiveRule rule;
    long seed;
    dem::RateLaw rate_law;
  } strength;

  struct Load {
    TestKind test;
    double stress; ///< axial, compression positive [Pa]
    bool true_stress;
    std::optional<double> release_time; ///< [s]
    double strain_rate;                 ///< compression positive [1/s]
    double end_time;                    ///< [s]
    std::optional<double> end_strain;   ///< [-]
    double strain_limit;                ///< [-]
    std::vector<std::pair<double, double>> stress_history, strain_history;
    std::vector<std::pair<double, double>> factor_history; ///< of boundary loads: time [s], factor
    double peak_stress;                                    ///< of pulses, compression positive [Pa]
    double contact_share;                 ///< stress between pulses over the peak [-]
    double loading_time, rest_time;       ///< of each pulse [s]
    double mean_stress, stress_amplitude; ///< of a sine, compression positive [Pa]
    double frequency;                     ///< of a sine [Hz]
    long n_cycles, points_per_pulse;
    double confining_stress; ///< on the lateral surface [Pa]
  } load;

  dem::QuasistaticSettings quasistatic;
  dem::DynamicSettings dynamic;
  bool audit;

  struct Output {
    std::string folder;
    std::string measured; ///< file; empty: none
    long n_times;
    TimeSpacing spacing;
    double first_time;                  ///< [s]
    std::vector<double> snapshot_times; ///< [s]
    std::vector<double> frequencies;    ///< [Hz]
    bool paraview, plots;
    double checkpoint_interval; ///< wall time [s]
  } output;

  struct Study {
    std::string vary;   ///< as typed
    std::string values; ///< as typed
    std::string scenes; ///< files, separated by commas
  } study;

  VolumeElementInput element;
  ContinuumInput continuum;
  Expectations expect;
  RepeatedRun repeat;
};

/// Declares all keys of a scene and binds them to its members.
struct NamedSections {
  std::vector<std::string> laws, boundaries, regions; ///< "Bond law NAME", "Boundary NAME", ...
};
void declare(Schema& schema, Scene& scene, const NamedSections& names);

/// A scene read from a file, with all that is wrong with it.
struct LoadedScene {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<Units> units;
  std::unique_ptr<Schema> schema;
  std::vector<Diagnostic> diagnostics;
  std::filesystem::path folder; ///< relative file names start here
  std::string name;             ///< of the file, without folder and ending
  std::string text;             ///< as typed

  bool has_errors() const;
};

/// \param overrides  texts "Section/Key = value"
/// \throws std::invalid_argument if the file cannot be read
LoadedScene load_scene(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides);

/// The same from a text: scenes stored in results.
LoadedScene load_scene_text(const std::string& text, const std::string& name,
                            const std::filesystem::path& folder,
                            const std::vector<std::string>& overrides);

/// Names of the keys that stand on estimated values, separated by commas; empty if there are none.
std::string estimated_keys(const LoadedScene& scene);

/// The same for the creep law of the bonds alone.
std::string estimated_bond_keys(const LoadedScene& scene);

/// What the keys together say that cannot be, or is unusual.
std::vector<Diagnostic> check_consistency(const Scene& scene, const Schema& schema);

} // namespace apps
