#pragma once
#include "fem/types.h"

#include <functional>
#include <span>
#include <vector>

namespace fem {

/// What the element code is told of all its points: the stress, and the tangents of the step.
struct ConstitutiveAnswer {
  std::span<const Vec6> stress;  ///< one per point [Pa]
  std::span<const Mat6> tangent; ///< the different tangents [Pa]
  std::span<const int> which;    ///< tangent of each point; empty: the first one for all
};

/// Stress and tangent at all points, given the strain increments since the last committed state and
/// the step [s] of reduced time. The element code asks this function and never sees a state. The
/// answer stands until the next call.
using ConstitutiveUpdate =
    std::function<ConstitutiveAnswer(std::span<const Vec6> increment, double step)>;

/// Error of a step that comes from what was taken as linear in it, against the size of what it is
/// an error of (strain, or stress): weighted sums of squares.
struct StepError {
  double square = 0;
  double size_square = 0;
};

/// Committed and trial states of the points of a body: what the element code asks. Two kinds:
/// points that follow creep laws (LawPoints), and points that are volumes of a finer model.
class MaterialPoints {
public:
  virtual ~MaterialPoints() = default;

  virtual std::size_t size() const = 0;

  /// Real time at the start of the next trial steps, and their duration [s]; 0 for a jump. The
  /// steps that `evaluate` is given are of reduced time.
  virtual void begin_step(double /*time*/, double /*duration*/) {}

  /// Trial states at the end of a step; the committed ones stay.
  /// \throws std::invalid_argument for a step that is negative or not finite
  virtual ConstitutiveAnswer evaluate(std::span<const Vec6> increment, double step) = 0;

  /// The error of the step that was evaluated last; a jump has none.
  /// \param weights  of the points
  virtual StepError step_error(std::span<const double> weights) const = 0;

  /// Share in (0, 1] of the trial step after which some point changes abruptly (a bond breaks): up
  /// to there the answers hold.
  virtual double share_without_change() { return 1; }

  /// The trial states become the committed ones.
  virtual void commit() = 0;

  /// How far the most loaded point is beyond what it can bear in its committed state: it must
  /// change where this is 1 or more.
  virtual double overload() { return 0; }

  /// Changes the points whose overload, as found last, is nearly the largest of all ranks; time
  /// stands still. The next step must be a jump, which restores equilibrium.
  virtual void change(double /*largest_overload*/) {}

  /// Whether stresses are affine in the strain increments of a step.
  virtual bool are_affine() const { return true; }

  /// Whether some point has found no state of its own in the trial step: a smaller one may do.
  virtual bool has_lost() const { return false; }

  virtual std::span<const Vec6> stress() const = 0; ///< committed [Pa]
  virtual std::span<const Vec6> strain() const = 0; ///< committed [-]

  /// Size of the last committed step [s]; 0 at the start and after a jump.
  virtual double last_step() const = 0;
  virtual void set_last_step(double step) = 0;

  /// Processor time that each point took beyond what all points take alike, since these points were
  /// made [s]; empty if there is nothing of that kind.
  virtual std::span<const double> costs() const { return {}; }

  /// The state of a point as numbers, for storage and transfer. There may be more room than these
  /// points need; what is stored is laid out by the room.
  virtual std::size_t numbers_per_point() const = 0;
  virtual void store(std::size_t point, std::span<double> numbers) const = 0;
  virtual void restore(std::size_t point, std::span<const double> numbers) = 0;

protected:
  MaterialPoints() = default;
  MaterialPoints(const MaterialPoints&) = default;
  MaterialPoints& operator=(const MaterialPoints&) = default;
};

} // namespace fem
