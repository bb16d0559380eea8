#include "dem/bonds.h"
#include "dem/contact_search.h"
#include "dem/packing.h"
#include "dem/random.h"
#include "dem/soft_spheres.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

using namespace dem;

namespace {

Particles scattered(std::size_t n, double size_ratio, std::uint64_t seed)
{
  Particles particles;
  for (std::size_t i = 0; i < n; ++i) {
    const auto number = [&](std::uint32_t k) { return uniform(seed, RandomStream::packing, i, k); };
    particles.centre.emplace_back(number(0), 2 * number(1) - 3, 0.5 * number(2));
    particles.radius.push_back(0.05 * std::pow(size_ratio, -number(3)));
    particles.material_class.push_back(0);
  }
  return particles;
}

std::set<std::array<Index, 2>> brute_force(const Particles& particles, double margin)
{
  std::set<std::array<Index, 2>> pairs;
  for (Index i = 0; i < Index(particles.size()); ++i)
    for (Index j = i + 1; j < Index(particles.size()); ++j) {
      const double cut = particles.radius[i] + margin + particles.radius[j];
      if ((particles.centre[j] - particles.centre[i]).squaredNorm() < cut * cut)
        pairs.insert({i, j});
    }
  return pairs;
}

PackingRequest small_request(double solid_fraction)
{
  PackingRequest request{{15e-3, 50e-3}, named_grading("sma10"), 0, solid_fraction};
  request.grading = make_grading({{2e-3, 0}, {4e-3, 0.5}, {6.3e-3, 1}});
  request.n_particles = std::size_t(std::lround(solid_fraction * request.container.volume() /
                                                mean_particle_volume(request.grading)));
  return request;
}

} // namespace

TEST(ContactSearch, FindsThePairsThatBruteForceFinds)
{
  for (const double ratio : {1.0, 5.0, 50.0})
    for (const double margin : {0.0, 0.01, 0.2}) {
      const Particles particles = scattered(600, ratio, 11);
      const NeighbourList list = near_pairs(particles.centre, particles.radius, margin);
      std::set<std::array<Index, 2>> found;
      for (std::size_t i = 0; i < particles.size(); ++i)
        for (Index k = list.start[i]; k < list.start[i + 1]; ++k) {
          const Index j = list.neighbour[k];
          EXPECT_TRUE(found.insert({std::min(Index(i), j), std::max(Index(i), j)}).second);
        }
      EXPECT_EQ(found, brute_force(particles, margin)) << "ratio " << ratio << " margin " << margin;
    }
  EXPECT_EQ(near_pairs({}, {}, 1).start.size(), 1u);
}

TEST(Grading, NumbersAndMassesOfTheEstimateAgree)
{
  // the count is a check of the grading: 6019 particles of 2 to 14 mm fill 70 % of the specimen
  const Cylinder specimen{30.1e-3, 120.3e-3};
  const double solid = 0.7 * specimen.volume();
  EXPECT_NEAR(solid / mean_particle_volume(named_grading("sma10")), 6019, 1);
  EXPECT_NEAR(solid / mean_particle_volume(named_grading("sma10-gap")), 2590, 10);
  const Grading uniform_mass = make_grading({{2e-3, 0}, {10e-3, 1}}, MassSpread::uniform);
  // mean of 1/V over mass: (6/pi) (1/d1^2 - 1/d2^2) / (2 (d2 - d1))
  const double inverse = 6 / std::numbers::pi * (1 / 4e-6 - 1 / 100e-6) / (2 * 8e-3);
  EXPECT_NEAR(mean_particle_volume(uniform_mass) * inverse, 1, 1e-12);
}

TEST(Grading, RepresentativeDiametersReproduceTheSieves)
{
  const Grading grading = named_grading("sma10");
  const std::vector<double> diameter = representative_diameters(grading, 60000);
  EXPECT_TRUE(std::ranges::is_sorted(diameter));
  const std::vector<double> found = passing(diameter, grading.sieves);
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k], grading.sieves[k].passing, 2e-4) << "sieve " << k;
}

TEST(Grading, BadTablesAreRefused)
{
  EXPECT_THROW(make_grading({{2e-3, 0}}), std::invalid_argument);
  EXPECT_THROW(make_grading({{2e-3, 0}, {1e-3, 1}}), std::invalid_argument);
  EXPECT_THROW(make_grading({{2e-3, 0.1}, {4e-3, 1}}), std::invalid_argument);
  EXPECT_THROW(make_grading({{2e-3, 0}, {4e-3, 0.9}}), std::invalid_argument);
  EXPECT_THROW(make_grading({{2e-3, 0}, {3e-3, 0.7}, {4e-3, 0.6}, {5e-3, 1}}),
               std::invalid_argument);
  EXPECT_THROW(make_grading({{-2e-3, 0}, {4e-3, 1}}), std::invalid_argument);
  EXPECT_THROW(make_grading({{2e-3, 0}, {4e-3, NAN}, {5e-3, 1}}), std::invalid_argument);
  try {
    named_grading("sma11");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "no grading is called 'sma11'; known: sma10, sma10-uniform, sma10-gap");
  }
}

TEST(Packing, ReachesItsTargetsAndStaysInside)
{
  const PackingRequest request = small_request(0.62);
  const Particles particles = grow_packing(request, 1);
  ASSERT_EQ(particles.size(), request.n_particles);
  double solid = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double r = particles.radius[i], gap = 1e-3 * r;
    solid += sphere_volume(r);
    EXPECT_LT(particles.centre[i].head<2>().norm() + r, request.container.radius + gap);
    EXPECT_GT(particles.centre[i].z() - r, -gap);
    EXPECT_LT(particles.centre[i].z() + r, request.container.height + gap);
  }
  EXPECT_NEAR(solid / request.container.volume(), 0.62, 0.005);

  const SoftSpheres spheres{request.container, particles.centre, particles.radius};
  NearSpheres near = make_near_spheres(spheres);
  const std::vector<double> gaps = gaps_to_neighbour(spheres, near, request.min_contacts);
  for (std::size_t i = 0; i < particles.size(); ++i)
    EXPECT_LE(gaps[i], request.contact_gap * particles.radius[i]) << "particle " << i;
  const double stress = request.preparation_stiffness * compression(spheres, near).virial /
                        (3 * request.container.volume());
  EXPECT_LT(stress, request.residual_stress_bound);
}

TEST(Packing, IsAFunctionOfTheSeed)
{
  const PackingRequest request = small_request(0.6);
  const Particles a = grow_packing(request, 1), b = grow_packing(request, 1);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_NE(a.centre, grow_packing(request, 2).centre);
}

TEST(Packing, ImpossibleRequestsAreRefused)
{
  const auto message = [](const PackingRequest& request) {
    try {
      grow_packing(request, 1);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  PackingRequest request = small_request(0.6);
  request.n_particles = 1000;
  EXPECT_NE(message(request).find("would need diameters scaled by"), std::string::npos);
  EXPECT_NE(message(request).find("particles fit"), std::string::npos);
  request = small_request(0.6);
  request.solid_fraction = 1.2;
  EXPECT_EQ(message(request), "packing: the solid fraction must lie between 0 and 0.9, found 1.2");
  request = small_request(0.6);
  request.container.radius = -1;
  EXPECT_EQ(message(request), "packing: the diameter must be > 0, found -1");
  request = small_request(0.6);
  request.n_particles = 0;
  EXPECT_EQ(message(request), "packing: the number of particles must be > 0, found 0");
}
