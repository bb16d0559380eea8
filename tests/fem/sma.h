#pragma once
#include "fem/measurements.h"

#include <array>
#include <numbers>

/// Dynamic modulus of a stone mastic asphalt measured on two specimens; see
/// scenes/data/sma-20C.csv, which holds the same table with its source.
namespace sma {

struct Row {
  double celsius, frequency;      ///< [degC], [Hz]
  std::array<double, 4> measured; ///< |E*| [MPa] and phase angle [deg] of the two specimens
};

inline constexpr std::array<Row, 13> rows{{{4, 25, {10314, 15.18, 9749, 15.46}},
                                           {4, 10, {8858, 16.78, 8488, 17.09}},
                                           {4, 1, {5661, 21.04, 5251, 21.43}},
                                           {4, 0.1, {3263, 25.19, 2959, 26.38}},
                                           {20, 25, {4165, 26.47, 4042, 26.32}},
                                           {20, 10, {3232, 28.18, 3122, 28.15}},
                                           {20, 1, {1516, 31.23, 1465, 31.46}},
                                           {20, 0.1, {637.8, 31.38, 617, 31.92}},
                                           {45, 25, {700, 31.58, 544.7, 35.64}},
                                           {45, 10, {445.3, 30.95, 334, 36.25}},
                                           {45, 1, {198.4, 24.77, 145.9, 30.02}},
                                           {45, 0.1, {121.4, 18.33, 88.9, 22.78}},
                                           {45, 0.01, {92.4, 14.05, 70.5, 17.78}}}};

/// Each row as two points, the first and the second specimen.
inline fem::Measurements dynamic_modulus()
{
  fem::Measurements data{fem::Quantity::dynamic_modulus, {}};
  for (const auto& [celsius, frequency, measured] : rows)
    for (const std::size_t specimen : {0U, 2U})
      data.points.push_back({frequency, 1e6 * measured[specimen],
                             std::numbers::pi / 180 * measured[specimen + 1], celsius + 273.15});
  return data;
}

/// The mean of the two specimens.
inline fem::Measurements mean_dynamic_modulus()
{
  const fem::Measurements all = dynamic_modulus();
  fem::Measurements data{all.quantity, {}};
  for (std::size_t i = 0; i + 1 < all.points.size(); i += 2) {
    fem::Measurement point = all.points[i];
    point.value = 0.5 * (point.value + all.points[i + 1].value);
    point.phase = 0.5 * (*point.phase + *all.points[i + 1].phase);
    data.points.push_back(point);
  }
  return data;
}

} // namespace sma
