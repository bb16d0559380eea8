#pragma once
#include "coupling/breaking_points.h"
#include "coupling/shared_creep.h"
#include "coupling/strain_window.h"
#include "dem/safe_region.h"

#include <memory>
#include <optional>
#include <vector>

namespace coupling {

/// A volume element that points of a body can be: shared by all of them.
struct VolumeFamily {
  std::shared_ptr<const dem::BreakableElement> element;
  dem::SafeRegion region; ///< of its intact bonds

  const fem::Mat6& stiffness() const { return element->intact()->stiffness; }
};
VolumeFamily make_family(dem::VolumeElement element, dem::Strengths strengths,
                         dem::AfterBreakage after_breakage);

/// When a point has a volume of its own.
enum class VolumeUse {
  adaptive, ///< from its first breakage on: until then the law of the intact volume is the volume
  all_live  ///< always: every bond is looked at in every step
};

struct VolumeSettings {
  VolumeUse use = VolumeUse::adaptive;
  dem::RateLaw rate_law;
  /// Bonds that reach this share below their strength, or below the most loaded one, break
  /// together with it. Where that is far beyond its strength, so do those whose overload has a
  /// logarithm that is less by ten times this share.
  double breakage_tolerance = 1e-6;
  int n_threads = 1;
  double first_pace = 1; ///< reduced time over real time at the start [-]
};

/// A volume that has changed, and what it is for its point: a value.
struct LiveVolume {
  std::shared_ptr<const dem::DamagedElement> damage;
  fem::Mat6 stiffness; ///< of the point [Pa]
  fem::Mat6 focus;     ///< elastic strain of the volume per that of the point [-]
  fem::Mat6 reach;     ///< of its strain, see dem::ratio_reach
  double since;        ///< first change [s]
};

/// The live volume of a point.
/// \param size_ratio  edge of the volume over that of the point's element, r. What
///   comes from breakage gathers in a band as wide as the volume, so that an element of another
///   size answers as a volume in series with intact material: S_0 + r (S - S_0). What breaking
///   dissipates per area of the band is then that of the volume, whatever the mesh; 1 leaves the
///   volume as it is.
LiveVolume live_volume(const VolumeFamily& family,
                       std::shared_ptr<const dem::DamagedElement> damage, double size_ratio,
                       double since);

/// Points of a body each of which is a volume of bonded spheres that can break, for small strains
/// and proportional bond laws.
///
/// State: the strain, its elastic part e, the strains of the Kelvin branches, and which bonds are
/// broken. The stress is the present stiffness times e, and bond forces are those of the present
/// network under e: no particle needs a history. Bonds break when their force reaches their
/// strength, which follows the largest principal value of the point's own strain rate, averaged
/// over the window of the rate law without the jumps of strain. A step is exact while the elastic
/// strain is linear in it (constant stress); between eight instants of a step the strength factor
/// is taken as monotonic.
///
/// A point without a change is the law of its intact volume to the last digit: nothing has to be
/// replayed when its first bond breaks.
class VolumePoints final : public BreakingPoints {
public:
  /// \param family_of_point  number of the family of each point
  /// \param size_ratio       of each point (see `live_volume`)
  /// \param start            time at which all is at rest [s]
  /// \throws std::invalid_argument if the families do not share one creep law
  VolumePoints(std::vector<VolumeFamily> families, std::vector<int> family_of_point,
               std::vector<double> size_ratio, const VolumeSettings& settings, double start);

  std::size_t size() const override { return family_of_point_.size(); }
  void begin_step(double time, double duration) override;
  fem::ConstitutiveAnswer evaluate(std::span<const fem::Vec6> increment, double step) override;
  fem::StepError step_error(std::span<const double> weights) const override;
  double share_without_change() override;
  void commit() override;
  double overload() override;
  void change(double largest_overload) override;
  std::span<const fem::Vec6> stress() const override { return stress_; }
  std::span<const fem::Vec6> strain() const override { return strain_; }
  double last_step() const override { return last_step_; }
  void set_last_step(double step) override { last_step_ = step; }
  std::span<const double> costs() const override { return costs_; }
  std::size_t numbers_per_point() const override;
  void store(std::size_t point, std::span<double> numbers) const override;
  void restore(std::size_t point, std::span<const double> numbers) override;

  const VolumeFamily& family(std::size_t point) const { return families_[family_of_point_[point]]; }

  /// The live volume of a point, if it has one.
  const LiveVolume* live(std::size_t point) const { return live_[point].get(); }

  double strength_use(std::size_t point) const override;

  /// The largest of the hundred points whose upper bound of it is largest.
  double largest_strength_use() const override;

  std::size_t n_live() const override { return n_live_; } ///< with a volume of their own
  std::size_t n_broken() const override;
  std::size_t n_bonds() const override;
  std::size_t n_failed() const override; ///< whose volume is a mechanism, and carries nothing
  PointDamage damage(std::size_t point) const override;

  /// Overload of a point as found last.
  double overload_of(std::size_t point) const { return overload_[point]; }

  /// What a point without a change is made of at present.
  const fem::Vec6& elastic_strain(std::size_t point) const { return elastic_[point]; }
  std::span<const fem::Vec6> kelvin_strains(std::size_t point) const { return kelvin(point); }

  /// Leaves points to somebody else: here they go on as their law, and do not break any more. Time
  /// stands still, as with `change`.
  void release(std::span<const std::size_t> points);

  /// The same for a point that somebody else has followed before.
  void leave(std::size_t point) { is_released_[point] = 1; }

  /// Rate that the strengths of a point see at present [1/s].
  fem::Vec6 strain_rate(std::size_t point) const { return smooth_rate(point, instant(0)); }

private:
  /// An instant of the trial step, and the window of the rate law that ends there.
  struct Instant {
    double share, time, from;
    SharedCreep::Part part, from_part; ///< of the step up to here, and up to the window's start
  };
  Instant instant(double share) const;
  double window_start(double time) const;
  fem::Vec6 smooth_strain(std::size_t point, double share, const SharedCreep::Part& part) const;
  fem::Vec6 smooth_rate(std::size_t point, const Instant& at) const;
  double factor(std::size_t point, const Instant& at) const;
  double ratio(std::size_t point, const fem::Vec6& elastic) const;
  double ratio_bound(std::size_t point, const fem::Vec6& elastic) const;
  void look_at(std::size_t point);
  double share_until_breakage(std::size_t point, std::span<const Instant> instants);
  double share_until_opening(std::size_t point) const;
  double crossing(std::size_t point, double from, double to) const;
  fem::Vec6 in_volume(std::size_t point, const fem::Vec6& elastic) const;
  std::span<const fem::Vec6> kelvin(std::size_t point) const;
  std::vector<dem::BondStatus> changed_status(std::size_t point, double at_least) const;
  void make_live(std::span<const std::size_t> points,
                 std::vector<std::vector<dem::BondStatus>> status);

  std::vector<VolumeFamily> families_;
  std::vector<int> family_of_point_;
  std::vector<double> size_ratio_;
  VolumeSettings settings_;
  SharedCreep creep_;
  double start_, least_factor_;

  std::vector<fem::Vec6> strain_, stress_, elastic_;
  std::vector<fem::Vec6> slope_; ///< of the elastic strain over the last step [1/s]
  std::vector<fem::Vec6> jumps_; ///< strain that came in jumps
  std::vector<fem::Vec6> kelvin_;
  std::vector<std::shared_ptr<const LiveVolume>> live_;
  std::vector<char> is_released_;
  StrainWindow window_;
  std::size_t n_live_ = 0;
  double time_, last_step_ = 0;
  bool has_changed_ = false; ///< since the last commit

  double duration_ = 0, pace_; ///< [s]; reduced over real time of the last step
  SharedCreep::Part part_;     ///< of the whole trial step
  std::vector<fem::Mat6> tangents_;
  std::vector<int> which_;
  std::vector<fem::Vec6> trial_stress_, trial_increment_, growth_;
  std::vector<double> overload_; ///< as found last; infinite where contacts open
  std::vector<double> costs_;    ///< of breakages and looks; those on threads over their number [s]

  /// A live volume when all its bonds were looked at last: nothing can happen near that strain.
  struct Look {
    const LiveVolume* at = nullptr;
    fem::Vec6 strain = fem::Vec6::Zero(); ///< elastic, of the volume
    dem::Look seen{};
  };
  std::vector<Look> looks_;
};

} // namespace coupling
