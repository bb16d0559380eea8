#pragma once
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace dem {

/// Normal distribution of bond strength; a part of it may be negative.
struct NormalStrength {
  double mean;               ///< [N]
  double standard_deviation; ///< [N], > 0
};

/// Two-parameter Weibull distribution of bond strength.
struct WeibullStrength {
  double modulus; ///< [-], > 0
  double scale;   ///< [N], > 0
};

using StrengthDistribution = std::variant<NormalStrength, WeibullStrength>;

/// What becomes of a draw that is not positive.
enum class NonpositiveRule {
  error,    ///< the scene is refused
  clamp,    ///< strength 0: the bond breaks under the first tension or shear
  truncate, ///< the distribution is cut at 0: quantile of the positive part, one draw per bond
  resample  ///< drawn again until positive: the same distribution as truncate, another sample
};

/// Strengths at the reference strain rate.
struct StrengthLaw {
  StrengthDistribution distribution;
  NonpositiveRule rule = NonpositiveRule::error;
  double shear_ratio = 1; ///< shear strength over normal strength [-], > 0
};

/// Strength of each bond at the reference strain rate.
struct Strengths {
  std::vector<double> normal;    ///< [N]
  std::vector<double> shear;     ///< [N]
  std::size_t n_nonpositive = 0; ///< draws that came out <= 0, before the rule
};

/// Value below which a share u in (0, 1) of the distribution lies [N].
double quantile(const StrengthDistribution& distribution, double u);

/// One strength per bond. The draw depends on the seed and on the bond's id alone, so renumbering
/// and distribution over threads do not change it.
/// \throws std::invalid_argument for parameters out of range, and under NonpositiveRule::error if
///         a draw is <= 0 (the message says how many)
Strengths draw_strengths(const StrengthLaw& law, std::span<const std::int64_t> bond_id,
                         std::uint64_t seed);

/// Dependence of the strengths on the macroscopic strain rate:
/// strength = reference strength * (rate / reference_rate)^exponent (eq. 5 of Cai et al. 2016).
///
/// The rate is that of real time (before any viscosity scaling). It leaves out elastic jumps and
/// is averaged over the last max(window, window_fraction * elapsed time); a window of 0 takes the
/// instantaneous rate. It never counts as less than `floor`.
struct RateLaw {
  double exponent = 0.325;       ///< [-], >= 0; 0 switches the dependence off
  double reference_rate = 0.005; ///< [1/s], > 0
  double window = 0;             ///< [s], >= 0
  double window_fraction = 0;    ///< [-], 0 to 1
  double floor = 0;              ///< [1/s], >= 0
};

/// Strength over reference strength [-] at a strain rate [1/s] of either sign.
double strength_factor(const RateLaw& law, double strain_rate);

} // namespace dem
