#pragma once
#include "apps/body_damage.h"
#include "apps/continuum_volumes.h"
#include "apps/run_record.h"
#include "fem/march.h"
#include "fem/probes.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What a run of a continuum has recorded.
struct ContinuumRecord {
  std::vector<dem::Response> history;
  std::vector<std::pair<double, std::string>> fields;         ///< times [s] and ParaView files
  std::vector<VolumeReading> volumes;                         ///< if the points are volumes
  std::vector<double> probe_times;                            ///< [s]
  std::vector<std::vector<fem::ProbeReading>> probe_readings; ///< by time, by place
};

/// Sizes and settings of the elements, for tables and provenance.
struct ContinuumSize {
  long n_cells = 0, n_unknowns = 0, order = 0;
  int n_ranks = 1;
  std::string scheme; ///< of the time steps
};

/// Probe readings as users read them; strain and stress tension positive.
std::vector<Column> probe_columns(const std::vector<fem::Vec3>& places,
                                  const ContinuumRecord& record);

/// Everything that a finished run leaves, but for the ParaView files. First rank only.
struct ContinuumResult {
  const LoadedScene& scene;
  const Face& face;
  const ContinuumRecord& record;
  const fem::MarchState& march;
  const ContinuumSize& size;
  const std::vector<fem::Vec3>& places; ///< of the probes
  std::vector<Column> modulus;          ///< over frequency; may be empty
  std::vector<std::string> laws;        ///< texts of the law files
  bool by_displacement;
  double wall_time; ///< [s]
  std::string end, end_reason;
  std::optional<BodyDamage> damage; ///< if the points are volumes
};
void write_continuum_results(const ContinuumResult& result, const std::filesystem::path& folder);

/// "12 steps, 3 tried again, ..."
std::string statistics(const fem::MarchState& march);

} // namespace apps
