#pragma once
#include <variant>

namespace dem {

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

/// Time-temperature shift of a thermorheologically simple binder; `monostate` is none.
using TemperatureShift = std::variant<std::monostate, WlfShift, ArrheniusShift>;

/// a_T [-] at a temperature [K]: every viscosity is multiplied by it; 1 at the reference.
/// \throws std::invalid_argument at or below the temperature where WLF is singular, or at T <= 0
double shift_factor(const TemperatureShift& shift, double temperature);

} // namespace dem
