#pragma once
#include "dem/assembly.h"
#include "dem/dynamics.h"
#include "dem/events.h"
#include "dem/hdf5_file.h"
#include "dem/quasistatic.h"

#include <string>
#include <vector>

namespace dem {

/// Version of the layout written here; a reader refuses what is newer.
constexpr int storage_version = 1;

/// Particles and what holds them, under a group.
void write_particles(Hdf5File& file, const std::string& group, const Particles& particles);
Particles read_particles(const Hdf5File& file, const std::string& group);

/// Bonds with their strengths.
void write_bonds(Hdf5File& file, const std::string& group, const Assembly& assembly);

/// Broken bonds, one array per column.
void write_breakages(Hdf5File& file, const std::string& group,
                     const std::vector<Breakage>& breakages);
std::vector<Breakage> read_breakages(const Hdf5File& file, const std::string& group);

/// Everything a run needs to go on bit for bit. The model is not stored.
void write_state(Hdf5File& file, const std::string& group, const EventsState& state);
EventsState read_events_state(const Hdf5File& file, const std::string& group,
                              const EventsModel& model);

void write_state(Hdf5File& file, const std::string& group, const DynamicState& state);
DynamicState read_dynamic_state(const Hdf5File& file, const std::string& group,
                                const DynamicModel& model);

void write_state(Hdf5File& file, const std::string& group, const QuasistaticState& state);
QuasistaticState read_quasistatic_state(const Hdf5File& file, const std::string& group,
                                        const QuasistaticModel& model);

} // namespace dem
