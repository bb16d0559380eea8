#pragma once
#include "apps/scene.h"
#include "fem/law_file.h"
#include "fem/mesh.h"
#include "fem/specimen.h"

#include <functional>
#include <string>
#include <vector>

namespace apps {

/// The laws of a continuum: that of the body, then those of its regions.
struct BodyLaws {
  std::vector<fem::LawRecord> records;
  std::vector<fem::ComplianceLaw> laws;
  std::vector<std::string> region; ///< that each law is for; "" for all others
};

/// Reads the law files of a scene.
/// \throws std::invalid_argument naming the file and what is wrong with it
BodyLaws read_laws(const LoadedScene& scene);

/// Reduced time int dt / a_T [s] at a time [s], by the shift of the law file, or by that of the
/// scene where the law file has none.
/// \throws std::invalid_argument if the laws do not agree on it, or do not reach a temperature
std::function<double(double)> reduced_time(const Scene& scene, const BodyLaws& laws);

/// Refuses a test that is longer, or at other temperatures, than what the laws were seen in.
/// \throws std::invalid_argument saying how to do it all the same
void require_range(const Scene& scene, const BodyLaws& laws, double reduced_end);

/// The mesh of a scene over the ranks.
/// \throws std::invalid_argument as the functions of fem/mesh.h
template <int dim>
fem::Mesh<dim> make_mesh(const LoadedScene& scene, MPI_Comm ranks);

/// The number of the law of each region.
/// \throws std::invalid_argument for a region that the mesh does not have
template <int dim>
std::map<dealii::types::material_id, int> law_of_region(const fem::Mesh<dim>& mesh,
                                                        const BodyLaws& laws);

/// Supports and loads of a scene: platens, sections Boundary NAME, confining stress, weight.
fem::BodyLoads body_loads(const Scene& scene);

/// Whether the body is tested between platens.
bool has_platens(const Scene& scene);

/// Names of the boundaries of a generated body; empty for a mesh from a file.
std::vector<std::string> boundary_names(const ContinuumInput::Body& body);

} // namespace apps
