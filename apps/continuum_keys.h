#pragma once
#include "apps/schema.h"
#include "fem/discretisation.h"
#include "fem/step_law.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace apps {

enum class BodyShape { cylinder, hollow_cylinder, box, disc, hollow_sphere, file };
enum class BodySection { solid, meridian };
enum class CellKind { hexahedra, tetrahedra };
enum class PlatenKind { bonded, frictionless };
/// What the points of a body are.
enum class MaterialChoice {
  law_file, ///< creep laws from files
  law_only, ///< the law of intact volume elements
  adaptive, ///< volume elements that break; on their law until they do
  all_live  ///< volume elements that break, every one looked at in every step
};
enum class VolumeSolver { events, quasistatic };
enum class SofteningChoice { scaled, as_it_is };
enum class TimeSchemeChoice { automatic, stress_linear, strain_linear };

/// What acts on a boundary of a body: section "Boundary NAME".
struct BoundaryInput {
  std::vector<std::optional<double>> displacement; ///< x, y, z [m], without: free; empty: all free
  std::vector<double> traction;                    ///< x, y, z [Pa]; empty: none
  double pressure;                                 ///< [Pa]
};

/// The sections that describe a continuum.
struct ContinuumInput {
  struct Body {
    BodyShape shape;
    BodySection section;
    std::vector<double> edges; ///< of a box [m]
    double inner_diameter;     ///< [m]
    double strip_width;        ///< of a disc [m]
    std::string mesh_file;
    double mesh_unit; ///< [m]
    CellKind cells;
    double cell_size; ///< [m]
    long n_refinements;
    PlatenKind platens;
    MaterialChoice material;
    std::string law_file;
    double density; ///< for the weight [kg/m^3]
  } body;
  std::map<std::string, std::unique_ptr<BoundaryInput>> boundaries; ///< by name
  std::map<std::string, std::string> regions;                       ///< law files by name

  long order;
  fem::Dilatation dilatation;
  TimeSchemeChoice scheme;
  double step_tolerance, solver_tolerance;
  double first_step; ///< [s]
  bool extrapolate;
  long n_adaptive_refinements;
  double refined_share;
  std::vector<double> refinement_times; ///< [s]

  struct Volumes {
    long n_particles; ///< of a volume
    long n_families;  ///< 0: a volume of its own for each point
    VolumeSolver solver;
    SofteningChoice softening;
    double breakage_tolerance;
    double balance; ///< largest over mean cost of the ranks from which on cells move; 0: never
  } volumes;

  struct Probes {
    std::vector<double> points;             ///< three coordinates each [m]
    std::vector<double> line_from, line_to; ///< [m]
    long n_line_points;
  } probes;
};

/// Whether the points of the body are volume elements.
inline bool has_volumes(const ContinuumInput& input)
{
  return input.body.material != MaterialChoice::law_file;
}

/// Whether they break.
inline bool breaks(const ContinuumInput& input)
{
  return input.body.material == MaterialChoice::adaptive ||
         input.body.material == MaterialChoice::all_live;
}

/// \param boundaries, regions  names of the sections to declare
void declare(Schema& schema, ContinuumInput& input, const std::vector<std::string>& boundaries,
             const std::vector<std::string>& regions);

} // namespace apps
