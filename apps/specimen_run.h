#pragma once
#include "apps/run_record.h"
#include "apps/scene.h"
#include "dem/assembly.h"
#include "dem/loading.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace apps {

/// What a solver has done, in numbers: "unknowns", "steps", "solves", "factorisations".
using Counts = std::vector<std::pair<std::string, double>>;

/// A specimen under load, whatever the solver: advances in time and shows what it does.
class SpecimenRun {
public:
  virtual ~SpecimenRun() = default;

  /// Works towards a time for a fraction of a second.
  virtual void work_towards(double time) = 0;

  /// True if the state is known at a time.
  virtual bool reached(double time) const = 0;

  virtual bool ended() const = 0;
  virtual dem::RunEnd end() const = 0;
  virtual std::string end_reason() const = 0;

  /// Time of the last known state [s].
  virtual double time() const = 0;

  /// Response and fields at a time that was reached and lies after all times asked for before.
  virtual dem::Response response(double time) const = 0;
  virtual Snapshot snapshot(double time) const = 0;

  virtual const std::vector<dem::Breakage>& breakages() const = 0;

  /// Stores the state / takes it back, for going on bit for bit.
  virtual void save(dem::Hdf5File& file) const = 0;
  virtual void load(const dem::Hdf5File& file) = 0;

  /// What the solver did, one line.
  virtual std::string statistics() const = 0;

  /// The same in numbers, for the result file and for studies. Solves: of the network under a load.
  virtual Counts counts() const { return {}; }

  /// Share of the work done when a time of the whole is reached: work is even in time, or in rows
  /// of the history.
  virtual bool work_is_even_in_time() const = 0;
};

/// Which solver runs a scene, and why.
struct SolverDecision {
  SolverChoice solver; ///< never automatic
  std::string reason;
};

/// Takes the solver the scene names, or the cheapest whose assumptions hold.
/// \throws std::invalid_argument if the scene names one whose assumptions do not hold
SolverDecision choose_solver(const Scene& scene, const dem::Assembly& assembly,
                             const dem::Loading& loading);

std::string name_of(SolverChoice solver);

/// A run at its start.
std::unique_ptr<SpecimenRun> make_run(SolverChoice solver, const Scene& scene,
                                      const dem::Assembly& assembly, const dem::Loading& loading,
                                      int n_threads);

} // namespace apps
