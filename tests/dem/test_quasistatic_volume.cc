#include "dem/creep_element.h"
#include "dem/element_creep.h"
#include "dem/quasistatic_volume.h"
#include "tests/dem/elements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace dem;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

QuasistaticSettings settings(Geometry geometry)
{
  QuasistaticSettings s;
  s.residual_tolerance = 1e-11;
  s.geometry = geometry;
  return s;
}

Strengths endless(const VolumeElement& element)
{
  const std::vector<double> none(element.bonds.size(), infinity);
  return {none, none, 0};
}

QuasistaticVolume unbreakable(const VolumeElement& element, Geometry geometry)
{
  return make_quasistatic_volume(element, endless(element), settings(geometry));
}

Vec6 some_strain(double size)
{
  return size * (Vec6() << 1, -0.5, 0.2, 0.7, -0.3, 0.4).finished();
}

QuasistaticVolumeState moved(const QuasistaticVolume& volume, const QuasistaticVolumeState& from,
                             const Vec6& increment, double duration)
{
  const auto step = VolumeFollower(volume).step(from, increment, duration);
  if (!step)
    throw std::runtime_error("no equilibrium");
  return step->state;
}

/// Bonds are pressed, every fifth breaks, and what is left slides.
QuasistaticVolumeState damaged(const QuasistaticVolume& volume)
{
  Vec6 pressed = some_strain(2e-4);
  pressed.head<3>().array() -= 2e-3;
  QuasistaticVolumeState state = moved(volume, at_rest(volume), pressed, 0);
  std::vector<Index> bonds;
  for (Index b = 0; b < Index(volume.assembly.bonds.size()); b += 5)
    bonds.push_back(b);
  state = with_broken(volume, std::move(state), bonds);
  return moved(volume, state, Vec6::Zero(), 0);
}

Mat6 differences(const QuasistaticVolume& volume, const QuasistaticVolumeState& from,
                 const Vec6& around, double duration, double size)
{
  Mat6 result;
  for (int k = 0; k < 6; ++k)
    result.col(k) = (moved(volume, from, around + size * Vec6::Unit(k), duration).stress -
                     moved(volume, from, around - size * Vec6::Unit(k), duration).stress) /
                    (2 * size);
  return result;
}

/// The same volume with all spheres moved, wrapped into the cell again, and all bonds turned round.
VolumeElement shifted(const VolumeElement& element, const Vec3& by)
{
  Particles particles = element.particles;
  for (Vec3& centre : particles.centre)
    centre += by;
  PeriodicContacts contacts{{}, {}, 0};
  for (std::size_t b = 0; b < element.bonds.size(); ++b) {
    const auto [i, j] = element.bonds.ends[b];
    contacts.pairs.push_back({j, i});
    contacts.shift.push_back(-element.shift[b]);
  }
  return make_volume_element(element.cell, particles, contacts, element.laws, element.pair_laws);
}

} // namespace

TEST(QuasistaticVolume, WithTwoLawsAndSmallMotionIsTheLinearOne)
{
  const VolumeElement element = elements::two_law_cube(60, 3);
  const ElementModel model = make_element_model(element);
  const QuasistaticVolume volume = unbreakable(element, Geometry::small);
  EXPECT_FALSE(volume.creep);
  QuasistaticVolumeState state = at_rest(volume);
  ElementState linear = virgin_state(model);
  Vec6 increment = some_strain(1e-3), strain = Vec6::Zero();
  for (const double duration : {0., 1., 20., 0., 300.}) {
    strain += increment;
    const ElementStep step(model, StepScheme::force_linear, duration);
    linear = step.advance(model, linear, {{}, strain});
    state = moved(volume, state, increment, duration);
    EXPECT_LT((state.stress - linear.stress).norm(), 1e-9 * linear.stress.norm()) << duration;
    increment = (Vec6() << increment.tail<5>(), -0.5 * increment[0]).finished();
  }
}

TEST(QuasistaticVolume, StressWorksOnTheStrainAsForcesDoOnTheBonds)
{
  const QuasistaticVolume volume = unbreakable(elements::two_law_cube(60, 4), Geometry::small);
  const Vec6 strain = some_strain(1e-3);
  const QuasistaticVolumeState state = moved(volume, at_rest(volume), strain, 0);
  double energy = 0;
  for (std::size_t k = 0; k < state.links.link.size(); ++k)
    energy += stored_energy(state.links, k, volume.assembly);
  const double volume_size = volume.element.cell.volume();
  EXPECT_NEAR(0.5 * state.stress.dot(strain) * volume_size, energy, 1e-11 * energy);
}

TEST(QuasistaticVolume, TangentIsThatOfDifferencesWithContactsThatSlide)
{
  const VolumeElement element = elements::two_law_cube(60, 5);
  const QuasistaticVolume volume = unbreakable(element, Geometry::small);
  const QuasistaticVolumeState state = damaged(volume);
  for (const double duration : {0., 30.}) {
    const Vec6 around = some_strain(3e-5);
    const auto step = VolumeFollower(volume).step(state, around, duration);
    ASSERT_TRUE(step);
    const Mat6 numeric = differences(volume, state, around, duration, 1e-9);
    EXPECT_LT((step->tangent - numeric).norm(), 1e-6 * numeric.norm()) << duration;
    EXPECT_EQ(step->tangent, Mat6(step->tangent.transpose()));
  }
}

TEST(QuasistaticVolume, IsCarriedOverFromTheLawInTheSameState)
{
  const VolumeElement element = elements::random_cube(60, 6);
  const QuasistaticVolume volume = unbreakable(element, Geometry::small);
  ASSERT_TRUE(volume.creep);
  const Vec6 rest = Vec6::Zero();
  CreepState<Vec6> law{rest, rest, std::vector<Vec6>(volume.creep->branches.size(), rest)};
  QuasistaticVolumeState followed = at_rest(volume);
  Vec6 growth = some_strain(1e-3);
  for (const double duration : {0., 3., 0., 40.}) {
    const Vec6 before = displacement(law);
    law = creep_step(*volume.creep, std::move(law), growth, duration);
    followed = moved(volume, followed, displacement(law) - before, duration);
    growth = (Vec6() << growth.tail<5>(), -0.5 * growth[0]).finished();
  }
  const QuasistaticVolumeState over =
      carried_over(volume, law.elastic, law.kelvin, displacement(law));
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < over.links.memory.size(); ++k) {
    largest = std::max(largest, std::abs(followed.links.memory[k]));
    difference = std::max(difference, std::abs(followed.links.memory[k] - over.links.memory[k]));
  }
  EXPECT_LT(difference, 1e-9 * largest);
  const Vec6 next = some_strain(-2e-4);
  const Vec6 expected = moved(volume, followed, next, 5).stress;
  EXPECT_LT((moved(volume, over, next, 5).stress - expected).norm(), 1e-9 * expected.norm());
}

TEST(QuasistaticVolume, FiniteMotionComesNearSmallMotionWithTheStrain)
{
  const VolumeElement element = elements::random_cube(60, 7);
  for (const double size : {1e-4, 1e-6}) {
    Vec6 stress[2];
    for (const Geometry geometry : {Geometry::small, Geometry::finite}) {
      const QuasistaticVolume volume = unbreakable(element, geometry);
      QuasistaticVolumeState state = moved(volume, at_rest(volume), some_strain(size), 0);
      stress[geometry == Geometry::finite] = moved(volume, state, some_strain(size), 10).stress;
    }
    const double difference = (stress[1] - stress[0]).norm() / stress[0].norm();
    EXPECT_LT(difference, 30 * size);
    EXPECT_GT(difference, 0.01 * size);
  }
}

TEST(QuasistaticVolume, DoesNotDependOnWhereTheCellBeginsNorOnTheEndsOfBonds)
{
  const VolumeElement element = elements::random_cube(60, 8);
  const Vec3 by = element.cell.edges * Vec3(0.31, -0.77, 0.5);
  Vec6 stress[2];
  int place = 0;
  for (const VolumeElement& each : {element, shifted(element, by)}) {
    const QuasistaticVolume volume = unbreakable(each, Geometry::finite);
    QuasistaticVolumeState state = damaged(volume);
    Vec6 pressed = some_strain(4e-3);
    pressed[2] = -0.02;
    for (int k = 0; k < 5; ++k)
      state = moved(volume, state, pressed, 10);
    stress[place++] = state.stress;
  }
  EXPECT_LT((stress[1] - stress[0]).norm(), 1e-6 * stress[0].norm());
}

TEST(QuasistaticVolume, SpheresTouchAcrossAFace)
{
  const double radius = 1e-3, gap = 1e-5, edge = 4 * radius + gap;
  Particles particles;
  particles.centre = {{radius, 2e-3, 2e-3}, {3 * radius, 2e-3, 2e-3}};
  particles.radius = {radius, radius};
  particles.material_class = {0, 0};
  PeriodicContacts contacts{{{0, 1}}, {ImageShift::Zero()}, 0};
  const BondLaw law = elements::law();
  const VolumeElement element =
      make_volume_element(box_cell({edge, edge, edge}), particles, contacts, {law}, {{0, 0, 0}});
  const QuasistaticVolume volume = unbreakable(element, Geometry::finite);
  QuasistaticVolumeState state = at_rest(volume);
  const double shortening = 5e-6, stiffness = law.creep.maxwell_stiffness;
  for (int k = 1; k <= 6; ++k) {
    state = moved(volume, state, -shortening / edge * Vec6::Unit(0), 0);
    const double pressed = std::max(0., k * shortening - gap); // the bond and the contact in series
    const double stress = -stiffness * pressed / 2 / (edge * edge);
    EXPECT_NEAR(state.stress[0], stress, 1e-6 * stiffness * shortening / (edge * edge)) << k;
  }
}

TEST(QuasistaticVolume, RefusesASphereBondedToItsOwnImage)
{
  Particles particles;
  particles.centre = {{1e-3, 1e-3, 1e-3}};
  particles.radius = {1e-3};
  particles.material_class = {0};
  PeriodicContacts contacts{{{0, 0}}, {ImageShift(1, 0, 0)}, 0};
  const VolumeElement element = make_volume_element(box_cell({2e-3, 2e-3, 2e-3}), particles,
                                                    contacts, {elements::law()}, {{0, 0, 0}});
  EXPECT_THROW((void)unbreakable(element, Geometry::small), std::invalid_argument);
}
