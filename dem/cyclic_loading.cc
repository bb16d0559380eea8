#include "dem/cyclic_loading.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace dem {

namespace {

using Pulse = CyclicLoad::Pulse;

void validate(const CyclicLoad& load)
{
  const auto require = [](bool condition, const char* what, double found) {
    if (!condition)
      throw std::invalid_argument(fmt::format("cyclic load: {}, found {:g}", what, found));
  };
  require(load.loading_time > 0, "the loading time must be > 0 s", load.loading_time);
  require(load.rest_time >= 0, "the rest time must be >= 0 s", load.rest_time);
  require(load.rest_time > 0 || load.pulse != Pulse::block, "blocks need a rest time > 0 s",
          load.rest_time);
  require(load.n_cycles >= 1, "at least 1 cycle is needed", double(load.n_cycles));
  require(load.pulse == Pulse::block || (load.n_intervals >= 4 && load.n_intervals % 4 == 0),
          "the intervals of a pulse must be a multiple of 4", double(load.n_intervals));
}

/// Share of the amplitude at a point of a curved pulse; exactly 0 where the curve is.
double share(const CyclicLoad& load, long point)
{
  const double turn = double(point) / double(load.n_intervals);
  if (load.pulse == Pulse::haversine)
    return point == load.n_intervals ? 0 : std::pow(std::sin(std::numbers::pi * turn), 2);
  return 2 * point % load.n_intervals == 0 ? 0 : std::sin(2 * std::numbers::pi * turn);
}

} // namespace

Loading cyclic_loading(const CyclicLoad& load)
{
  validate(load);
  Loading loading{Loading::Control::force, {{0, load.base}}, false};
  const auto add = [&](double time, double share_of_amplitude) {
    loading.points.push_back({time, load.base + share_of_amplitude * load.amplitude});
  };
  for (long cycle = 1; cycle <= load.n_cycles; ++cycle) {
    const double start = cycle_end(load, cycle - 1), end = cycle_end(load, cycle);
    const double unloaded = load.rest_time > 0 ? start + load.loading_time : end;
    if (load.pulse == Pulse::block) {
      add(start, 1);
      add(unloaded, 1);
      add(unloaded, 0);
    } else {
      for (long k = 1; k < load.n_intervals; ++k)
        add(start + load.loading_time * double(k) / double(load.n_intervals), share(load, k));
      add(unloaded, 0);
    }
    if (load.rest_time > 0)
      add(end, 0);
  }
  return loading;
}

} // namespace dem
