#include "dem/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem {

PlatenHeights packing_extent(const Particles& particles)
{
  PlatenHeights range{std::numeric_limits<double>::infinity(),
                      -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < particles.size(); ++i) {
    range.low = std::min(range.low, particles.centre[i].z() - particles.radius[i]);
    range.high = std::max(range.high, particles.centre[i].z() + particles.radius[i]);
  }
  return range;
}

std::vector<Support> platen_supports(const Particles& particles, PlatenHeights platens, double gap)
{
  std::vector<Support> support(particles.size(), Support::free);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double z = particles.centre[i].z(), reach = (1 + gap) * particles.radius[i];
    if (z - reach <= platens.low)
      support[i] = Support::bottom;
    else if (z + reach >= platens.high)
      support[i] = Support::top;
  }
  return support;
}

void validate(const Assembly& assembly)
{
  const auto refuse = [](const std::string& what) { throw std::invalid_argument(what); };
  const Particles& particles = assembly.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (!particles.centre[i].allFinite())
      refuse(fmt::format("particle {}: a coordinate is not a finite number", i));
    if (!(particles.radius[i] > 0) || !std::isfinite(particles.radius[i]))
      refuse(
          fmt::format("particle {}: the radius must be > 0, found {:g} m", i, particles.radius[i]));
  }
  if (!(particles.density > 0))
    refuse(fmt::format("the density must be > 0, found {:g} kg/m^3", particles.density));
  if (assembly.support.size() != particles.size())
    refuse("one support per particle is needed");
  if (assembly.strengths && assembly.strengths->normal.size() != assembly.bonds.size())
    refuse("one strength per bond is needed");
  if (!(assembly.area > 0) || !(assembly.gauge_length > 0))
    refuse(fmt::format("area and gauge length must be > 0, found {:g} m^2 and {:g} m",
                       assembly.area, assembly.gauge_length));
  for (const auto* loads : {&assembly.loads, &assembly.confinement})
    for (const ParticleLoad& load : *loads) {
      if (load.particle < 0 || load.particle >= Index(particles.size()))
        refuse(fmt::format("a load acts on particle {}, which does not exist", load.particle));
      if (!load.force.allFinite() || !load.moment.allFinite())
        refuse(fmt::format("the load on particle {} is not a finite number", load.particle));
    }
  if (!assembly.loads.empty() && std::ranges::count(assembly.support, Support::top) > 0)
    refuse("loads on particles and particles glued to the upper platen exclude each other: hold "
           "them with the lower platen");
}

void refuse_confinement(const Assembly& assembly, const char* solver)
{
  if (!assembly.confinement.empty())
    throw std::invalid_argument(
        fmt::format("the solver {} takes no confining stress; use quasistatic", solver));
}

} // namespace dem
