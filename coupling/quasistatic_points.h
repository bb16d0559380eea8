#pragma once
#include "coupling/strain_record.h"
#include "coupling/volume_points.h"
#include "dem/quasistatic_volume.h"

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace coupling {

/// Points of a body each of which is a volume that the quasi-static solver follows: friction, new
/// contacts, finite motion of the particles, and bonds of several laws.
///
/// The body strains little: its strain is that of the cell, which does not turn, and its stress is
/// conjugate to it. Friction limits are those of the start of a step. A point is followed from its
/// first breakage on, if the bonds of its volume share one law, and from the start otherwise.
/// Between two states strengths and loads of bonds are taken as linear. Volumes are as large as
/// their elements: there is no scaling of softening here.
class QuasistaticPoints final : public BreakingPoints {
public:
  using Volume = std::shared_ptr<const dem::QuasistaticVolume>;

  /// \param volume_of_point  number of the volume of each point
  /// \param law    the same points while nothing has broken; absent: all are followed at once
  /// \param start  time at which all is at rest [s]
  QuasistaticPoints(std::vector<Volume> volumes, std::vector<int> volume_of_point,
                    const VolumeSettings& settings, double start, std::optional<VolumePoints> law);

  std::size_t size() const override { return volume_of_point_.size(); }
  void begin_step(double time, double duration) override;
  fem::ConstitutiveAnswer evaluate(std::span<const fem::Vec6> increment, double step) override;
  fem::StepError step_error(std::span<const double> weights) const override;
  double share_without_change() override;
  void commit() override;
  double overload() override;
  void change(double largest_overload) override;
  bool are_affine() const override { return false; }
  bool has_lost() const override;
  std::span<const fem::Vec6> stress() const override { return stress_; }
  std::span<const fem::Vec6> strain() const override { return record_.strain(); }
  double last_step() const override { return last_step_; }
  void set_last_step(double step) override;
  std::span<const double> costs() const override { return costs_; }
  std::size_t numbers_per_point() const override;
  void store(std::size_t point, std::span<double> numbers) const override;
  void restore(std::size_t point, std::span<const double> numbers) override;

  std::size_t n_live() const override;
  std::size_t n_broken() const override;
  std::size_t n_bonds() const override;
  std::size_t n_failed() const override;
  PointDamage damage(std::size_t point) const override;
  bool is_lost(std::size_t point) const override { return is_lost_[point] != 0; }
  double strength_use(std::size_t point) const override;
  double largest_strength_use() const override;

  /// Overdamped steps that volumes took to find an equilibrium, of all committed steps.
  long n_passages() const { return n_passages_; }

  const dem::QuasistaticVolume& volume(std::size_t point) const
  {
    return *volumes_[std::size_t(volume_of_point_[point])];
  }

  /// The state of a point that is followed, or nothing.
  const dem::QuasistaticVolumeState* followed(std::size_t point) const
  {
    return state_[point].get();
  }

private:
  struct Idle; ///< followers that nobody uses at present
  std::optional<dem::QuasistaticVolumeStep> step_of(std::size_t point, const fem::Vec6& increment,
                                                    double duration) const;
  fem::Vec6 creep_rate(std::size_t point) const;
  void follow(std::span<const std::size_t> points);
  std::size_t numbers_of_state() const;

  std::vector<Volume> volumes_;
  std::vector<int> volume_of_point_;
  VolumeSettings settings_;
  std::optional<VolumePoints> law_;
  StrainRecord record_;
  std::shared_ptr<Idle> idle_;
  std::vector<fem::Mat6> intact_; ///< elastic stiffness of each volume [Pa]

  std::vector<std::shared_ptr<const dem::QuasistaticVolumeState>> state_; ///< of those followed
  std::vector<double> since_;                                             ///< first breakage [s]
  std::vector<fem::Vec6> stress_;
  double last_step_ = 0, pace_; ///< [s]; reduced over real time of the last step
  bool has_changed_ = false;    ///< since the last commit
  long n_passages_ = 0;

  double step_ = 0; ///< of the trial, in reduced time [s]
  std::vector<std::optional<dem::QuasistaticVolumeStep>> trial_;
  std::vector<fem::Vec6> trial_stress_;
  std::vector<fem::Mat6> tangents_;
  std::vector<int> which_;
  std::vector<char> is_lost_;
  std::vector<double> overload_; ///< as found last
  std::vector<double> costs_;    ///< of the steps of volumes, over the number of threads [s]
};

} // namespace coupling
