#include "dem/temperature_shift.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

double factor(std::monostate, double)
{
  return 1;
}

double factor(const WlfShift& shift, double temperature)
{
  const double difference = temperature - shift.reference_temperature;
  if (!(shift.c2 + difference > 0))
    throw std::invalid_argument(fmt::format(
        "WLF shift: the temperature must be above {:g} K (reference - C2), found {:g} K",
        shift.reference_temperature - shift.c2, temperature));
  return std::pow(10.0, -shift.c1 * difference / (shift.c2 + difference));
}

double factor(const ArrheniusShift& shift, double temperature)
{
  constexpr double gas_constant = 8.31446261815324; // J/(mol K), exact by definition of the SI
  return std::exp(shift.activation_energy / gas_constant *
                  (1 / temperature - 1 / shift.reference_temperature));
}

} // namespace

double shift_factor(const TemperatureShift& shift, double temperature)
{
  if (!(temperature > 0))
    throw std::invalid_argument(
        fmt::format("the temperature must be above 0 K, found {:g} K", temperature));
  return std::visit([&](const auto& law) { return factor(law, temperature); }, shift);
}

} // namespace dem
