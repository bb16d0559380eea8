#pragma once
#include <variant>
#include <vector>

namespace fem {

/// Williams-Landel-Ferry: log10 a_T = -C1 (T - T_ref) / (C2 + T - T_ref).
struct WlfShift {
  double c1;                    ///< [-]
  double c2;                    ///< [K]
  double reference_temperature; ///< [K]
};

/// Arrhenius: ln a_T = E_a / R (1/T - 1/T_ref).
struct ArrheniusShift {
  double activation_energy;     ///< E_a [J/mol]
  double reference_temperature; ///< [K]
};

/// One factor for each of some temperatures; between them log10 a_T is linear in T.
struct FreeShift {
  std::vector<double> temperatures;  ///< [K], rising
  std::vector<double> log10_factors; ///< log10 a_T [-]
  double reference_temperature;      ///< [K]
};

/// Time-temperature shift of a thermorheologically simple material; `monostate` is none.
using TemperatureShift = std::variant<std::monostate, WlfShift, ArrheniusShift, FreeShift>;

/// a_T [-] at a temperature [K]: a time t at T acts like the reduced time t / a_T at the reference,
/// a frequency f like f a_T.
/// \throws std::invalid_argument at or below the temperature where WLF is singular, at T <= 0, and
///         outside the temperatures of a free shift
double shift_factor(const TemperatureShift& shift, double temperature);

} // namespace fem
