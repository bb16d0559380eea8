#pragma once
#include "apps/continuum_body.h"
#include "apps/continuum_record.h"
#include "apps/continuum_volumes.h"
#include "apps/rank_costs.h"
#include "apps/ranks.h"
#include "dem/loading.h"
#include "fem/cell_states.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace apps {

/// A continuum under way: what it is, what has happened to it, what was recorded.
template <int dim>
struct ContinuumInProgress {
  const LoadedScene& scene;
  const Ranks& ranks;
  std::filesystem::path packings{}; ///< where grown volumes are kept; empty: nowhere
  int n_threads = 1;                ///< for volumes
  bool trial = false;               ///< only to see whether it can be made
  BodyLaws laws{};
  fem::Mesh<dim> mesh{};
  Face face{};
  dem::Loading loading{};
  fem::History history{};
  fem::TimeScheme scheme{};
  std::vector<fem::Vec3> places{}; ///< of the probes

  std::optional<fem::Specimen<dim>> specimen{};
  std::unique_ptr<fem::MaterialPoints> points{};
  const coupling::BreakingPoints* volumes = nullptr; ///< the points, if they are volumes that break
  std::vector<int> law_of_point{};
  KnownVolumes known_volumes{};
  std::string volume_sizes{}; ///< on this rank, as a text
  std::optional<fem::Probes<dim>> probes{};
  fem::MarchState march{};
  RankCosts costs{};
  double elastic_compliance = 0;         ///< of the platens [m/N]
  double last_time = 0, last_motion = 0; ///< before the last step [s], [m]

  ContinuumRecord record{};
  std::size_t n_recorded = 0; ///< stops that are done
  std::size_t n_jumped = 0;   ///< stops up to the last one whose jump of the load is done
  double wall_time = 0;       ///< [s]
};

/// The content of a checkpoint that does not depend on the body's dimension.
struct StoredContinuum {
  fem::StoredCells cells;
  fem::MarchState march;
  ContinuumRecord record;
  double drive_displacement, last_step, elastic_compliance, last_time, last_motion, wall_time;
  std::size_t n_recorded, n_jumped;
  std::string files;      ///< fingerprint of law and mesh files
  double drive_force = 0; ///< [N]
};

/// Law and mesh files of a scene: their content, as a short text that is equal for equal content.
std::string continuum_fingerprint(const LoadedScene& scene);

/// Stores everything that a run needs to go on, on any number of ranks; all ranks take part. The
/// checkpoint before it stays under another name.
template <int dim>
void write_continuum_checkpoint(const ContinuumInProgress<dim>& run,
                                const std::filesystem::path& folder);

/// Reads a checkpoint.
/// \throws std::invalid_argument if it is damaged
StoredContinuum read_continuum_checkpoint(const dem::Hdf5File& file);

} // namespace apps
