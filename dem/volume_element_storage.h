#pragma once
#include "dem/hdf5_file.h"
#include "dem/volume_element.h"

#include <string>

namespace dem {

/// A volume element under a group: cell, particles, bonds with their shifts, laws. Bit for bit.
void write_volume_element(Hdf5File& file, const std::string& group, const VolumeElement& element);

/// \throws std::runtime_error if something is missing, or if arrays do not fit together
VolumeElement read_volume_element(const Hdf5File& file, const std::string& group);

} // namespace dem
