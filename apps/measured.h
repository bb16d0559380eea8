#pragma once
#include "apps/run_record.h"
#include "apps/scene.h"

#include <span>
#include <vector>

namespace apps {

/// A creep test of the laboratory that belongs to a scene (Output/Measured).
struct MeasuredCurve {
  std::vector<double> time;   ///< [s]
  std::vector<double> strain; ///< compression positive [-]
};

/// Reads the measured curve of a scene: the rows at its stress (within 1 %), or all rows if the
/// table has no column 'axial stress'; a compliance is multiplied by the stress. Empty if the scene
/// names none. \throws std::invalid_argument as `read_fit_data`, or if no row is at the stress of
/// the scene, or the
///         table holds moduli
MeasuredCurve measured_curve(const LoadedScene& scene);

/// Root of the mean square difference between measured and simulated strain over the largest
/// measured one, at the measured times within the simulated ones; strains are interpolated
/// linearly.
struct Agreement {
  std::size_t n_points;
  double difference; ///< [-]; nan without points
};
Agreement agreement(const MeasuredCurve& curve, const std::vector<Column>& history);

/// The table as stored: time_s, axial_strain_percent.
std::vector<Column> measured_columns(const MeasuredCurve& curve);

} // namespace apps
