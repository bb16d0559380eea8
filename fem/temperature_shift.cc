#include "fem/temperature_shift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fem {

namespace {

constexpr double gas_constant = 8.31446261815324; // J/(mol K)

void require(bool condition, const char* what, double temperature)
{
  if (!condition)
    throw std::invalid_argument(fmt::format("temperature shift: {:g} K is {}", temperature, what));
}

double log10_factor(std::monostate, double)
{
  return 0;
}

double log10_factor(const WlfShift& shift, double temperature)
{
  const double above = temperature - shift.reference_temperature;
  require(shift.c2 + above > 0, "at or below the temperature where the WLF equation is singular",
          temperature);
  return -shift.c1 * above / (shift.c2 + above);
}

double log10_factor(const ArrheniusShift& shift, double temperature)
{
  return shift.activation_energy / gas_constant *
         (1 / temperature - 1 / shift.reference_temperature) / std::log(10.0);
}

double log10_factor(const FreeShift& shift, double temperature)
{
  const auto& known = shift.temperatures;
  require(!known.empty() && temperature >= known.front() && temperature <= known.back(),
          "outside the temperatures of the free shift", temperature);
  const std::size_t above =
      std::size_t(std::lower_bound(known.begin(), known.end(), temperature) - known.begin());
  if (above == 0)
    return shift.log10_factors[0];
  const double part = (temperature - known[above - 1]) / (known[above] - known[above - 1]);
  return std::lerp(shift.log10_factors[above - 1], shift.log10_factors[above], part);
}

} // namespace

double shift_factor(const TemperatureShift& shift, double temperature)
{
  require(temperature > 0, "not above absolute zero", temperature);
  return std::pow(
      10.0, std::visit([&](const auto& each) { return log10_factor(each, temperature); }, shift));
}

} // namespace fem
