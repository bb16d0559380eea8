#pragma once
#include "apps/scene.h"
#include "dem/assembly.h"
#include "dem/hdf5_file.h"
#include "dem/network.h"
#include "dem/records.h"

#include <span>
#include <string>
#include <vector>

namespace apps {

/// All particles and bonds at one time.
struct Snapshot {
  double time;                         ///< [s]
  std::vector<dem::Vec3> displacement; ///< of each particle [m]
  std::vector<dem::Vec3> rotation;     ///< [rad]
  std::vector<dem::Vec3> force;        ///< of each bond on its first end [N]
  std::vector<dem::Vec3> moment;       ///< [N m]
  std::vector<std::uint8_t> state;     ///< of each bond: 0 intact, 1 pressed contact, 2 gone
};

/// Snapshot of a network from its dofs, and from the elastic ones that give the bond forces.
Snapshot network_snapshot(const dem::ElasticNetwork& network, double time,
                          std::span<const dem::BondStatus> status, const Eigen::VectorXd& dofs,
                          const Eigen::VectorXd& elastic);

/// What a run has recorded so far, apart from breakages.
struct RunRecord {
  std::vector<dem::Response> history;
  std::vector<Snapshot> snapshots;
};

/// A named column of numbers in units of the laboratory, compression positive.
struct Column {
  std::string name; ///< with its unit: "axial_stress_kPa"
  std::string unit;
  std::vector<double> values;
};

/// Through what a specimen is loaded, and what its stress and strain refer to.
struct Face {
  bool platen;   ///< or loads inside, with a factor
  double area;   ///< [m^2]
  double length; ///< [m]
};
Face face_of(const dem::Assembly& assembly);

/// The history as users read it.
std::vector<Column> history_columns(const Face& face, std::span<const dem::Response> rows);

/// Broken bonds as users read them.
std::vector<Column> breakage_columns(const dem::Assembly& assembly,
                                     const std::vector<dem::Breakage>& breakages);

/// Particles or bonds of one snapshot as users read them.
std::vector<Column> particle_columns(const dem::Particles& particles, const Snapshot& snapshot);
std::vector<Column> bond_columns(const std::vector<std::array<dem::Index, 2>>& ends,
                                 const Snapshot& snapshot);

/// A table as CSV with full precision.
std::string csv(const std::vector<Column>& columns);

/// Stores a table under a group.
void write_columns(dem::Hdf5File& file, const std::string& group,
                   const std::vector<Column>& columns);

/// Columns of a stored table.
std::vector<Column> stored_columns(const dem::Hdf5File& file, const std::string& group);

void write_record(dem::Hdf5File& file, const std::string& group, const RunRecord& record);
RunRecord read_record(const dem::Hdf5File& file, const std::string& group);

/// Snapshot group of one time.
void write_snapshot(dem::Hdf5File& file, const std::string& group, const Snapshot& snapshot);
Snapshot read_snapshot(const dem::Hdf5File& file, const std::string& group);

} // namespace apps
