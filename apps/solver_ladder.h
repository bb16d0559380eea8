#pragma once
#include "apps/scene.h"

#include <string>
#include <vector>

namespace apps {

/// Which solvers a study compares, and at which settings.
struct LadderOptions {
  std::vector<std::string> solvers{"linear", "events", "quasistatic", "dynamic"};
  /// Factors on the scene's Strain per step and Error tolerance, together.
  std::vector<double> coarsening{16, 8, 4, 2, 1, 0.5, 0.25};
  /// Values of Breakage batch.
  std::vector<long> batches{256, 64, 16, 4, 1};
  /// Values of Viscosity scaling.
  std::vector<double> scalings{1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1};
};

/// A solver at one setting.
struct Rung {
  std::string solver;
  std::string knob;                  ///< "" for a solver without one
  double value = 0;                  ///< of the knob [-]
  std::vector<std::string> settings; ///< "Section/Key = value"

  /// "dynamic, viscosity scaling 0.001"
  std::string text() const;
  /// Of its results; equal for equal settings.
  std::string folder() const;
};

/// A solver over its knob, from cheap to exact.
using Ladder = std::vector<Rung>;

/// The ladders of a scene. Without strengths there is none over the breakage batch. A continuum is
/// compared with itself, over the size of its cells and the tolerance of its time steps; one of
/// volumes that break over the breakage tolerance, and with their law and with all of them live.
/// \throws std::invalid_argument for a solver that is not there
std::vector<Ladder> solver_ladders(const Scene& scene, const LadderOptions& options);

/// A solver that has no knob.
Rung plain_rung(const std::string& solver);

/// What the others are measured against where there is no exact answer: the implicit solver at a
/// tenth of the scene's step and tolerance, breaking one bond at a time; a continuum on cells of
/// half the size, at a tenth of the step tolerance; volumes that break all live, at a tenth of the
/// breakage tolerance.
Rung finest(const Scene& scene);

} // namespace apps
