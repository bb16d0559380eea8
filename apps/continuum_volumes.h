#pragma once
#include "apps/continuum_body.h"
#include "apps/ranks.h"
#include "apps/run_record.h"
#include "coupling/quasistatic_points.h"
#include "fem/field_files.h"

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

namespace apps {

/// The volumes of a body on a rank: the different ones, and which of them each point is.
struct BodyVolumes {
  std::vector<coupling::VolumeFamily> families; ///< empty if bonds follow several laws
  std::vector<coupling::QuasistaticPoints::Volume>
      followed; ///< by the quasi-static solver, or none
  std::vector<int> family_of_point;
  std::vector<double> size_ratio; ///< edge of the volume over that of the point's element
};

/// A volume as the scene says, for each solver that needs it.
struct OneVolume {
  std::optional<coupling::VolumeFamily> family;
  coupling::QuasistaticPoints::Volume followed;
};

/// Volumes that were made already, by how far their seeds are from those of the scene.
using KnownVolumes = std::map<std::uint64_t, OneVolume>;

/// Makes the volumes for the points of a rank. Which point gets which depends on its cell and its
/// place in it alone, not on ranks.
/// \param packings  folder in which grown packings are kept; empty: nowhere
/// \param known     taken from there; those that had to be made come to them
/// \param trial     all points get the first volume: to see whether it can be made
/// \throws std::invalid_argument if the scene does not make volumes, or none of a size that fits
template <int dim>
BodyVolumes make_volumes(const LoadedScene& scene, const Ranks& ranks,
                         const fem::Elements<dim>& elements, const std::filesystem::path& packings,
                         int n_threads, bool trial, KnownVolumes& known);

/// Whether the quasi-static solver follows the volumes of a body.
bool is_followed(const Scene& scene);

/// The exact laws of intact volumes; their elastic parts only, if bonds follow several laws.
BodyLaws laws_of(const Scene& scene, const BodyVolumes& volumes);

/// The points of a body whose volumes break, in the virgin state.
/// \param start       [s]
/// \param first_pace  reduced time over real time at the start [-]
std::unique_ptr<coupling::BreakingPoints> breaking_points(const Scene& scene, BodyVolumes volumes,
                                                          int n_threads, double start,
                                                          double first_pace);

/// How large the volumes are, as users read it.
std::string size_text(const Scene& scene, const BodyVolumes& volumes);

/// What the volumes of a body show at a time, over all ranks.
struct VolumeReading {
  double time;     ///< [s]
  double n_broken; ///< bonds that are not intact any more
  double n_bonds;  ///< of all points
  double n_live;   ///< points that are not on their law
  double n_points;
  double strength_use; ///< largest force over present strength of a bond [-]
  double n_failed;     ///< points whose volume is a mechanism
};
VolumeReading volume_reading(const coupling::BreakingPoints& points, const Ranks& ranks,
                             double time);

/// Readings as users read them.
std::vector<Column> volume_columns(const std::vector<VolumeReading>& readings);

/// What to show of the volumes in each cell of a rank: share of live points and of broken bonds,
/// largest strength use, loss of stiffness, time of the first breakage.
std::vector<fem::CellField> volume_fields(const coupling::BreakingPoints& points,
                                          std::size_t points_per_cell);

} // namespace apps
