#include "dem/crystals.h"
#include "dem/homogenization.h"
#include "dem/random.h"

#include <gtest/gtest.h>

#include <functional>

using namespace dem;

namespace {

BondLaw bond()
{
  return {burgers(1e6, 1e9, 5e5, 1e8), 11, 1};
}

Particles one_sphere(const Vec3& centre = Vec3::Zero())
{
  return {{centre}, {0.5}, {0}};
}

std::string refusal(const std::function<void()>& make)
{
  try {
    make();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing";
}

VolumeElement element_with(const Particles& particles, const PeriodicContacts& contacts)
{
  return make_volume_element(box_cell(Vec3::Ones()), particles, contacts, {bond()}, {{0, 0, 0}});
}

} // namespace

TEST(PeriodicCell, FindsTheSamePairsAsABruteForceSearch)
{
  Mat3 edges;
  edges << 1, 0.9, -1.7, 0.1, 1.2, 0.8, 0, 0.3, 0.9;
  const PeriodicCell cell = make_periodic_cell(edges);
  std::vector<Vec3> centre;
  std::vector<double> radius;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const auto number = [&](std::uint32_t k) { return uniform(7, RandomStream::packing, i, k); };
    centre.push_back(cell.edges * (4 * Vec3(number(0), number(1), number(2)) - Vec3::Ones()));
    radius.push_back(0.05 + 0.3 * number(3));
  }
  const double margin = 0.1;
  const auto [list, shift] = periodic_near_pairs(cell, centre, radius, margin);
  std::size_t n_found = 0, n_expected = 0;
  for (Index i = 0; i < 12; ++i)
    for (Index k = list.start[i]; k < list.start[i + 1]; ++k) {
      const Index j = list.neighbour[k];
      const Vec3 l = centre[j] + cell.translation(shift[k]) - centre[i];
      EXPECT_LT(l.norm(), radius[i] + radius[j] + margin);
      ++n_found;
    }
  const int far = 14;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int a = -far; a <= far; ++a)
        for (int b = -far; b <= far; ++b)
          for (int c = -far; c <= far; ++c) {
            const Vec3 l = centre[j] + cell.translation({a, b, c}) - centre[i];
            const bool itself = i == j && a == 0 && b == 0 && c == 0;
            n_expected += !itself && l.norm() < radius[i] + radius[j] + margin;
          }
  EXPECT_EQ(2 * n_found, n_expected);
  EXPECT_GT(n_found, 50u);
}

TEST(PeriodicCell, RefusesEdgesThatSpanNoVolume)
{
  Mat3 flat = Mat3::Identity();
  flat.col(2) = flat.col(1);
  EXPECT_THROW(make_periodic_cell(flat), std::invalid_argument);
  EXPECT_THROW(make_periodic_cell(-Mat3::Identity()), std::invalid_argument);
  EXPECT_THROW(make_periodic_cell(Mat3::Constant(NAN)), std::invalid_argument);
  EXPECT_THROW(box_cell(Vec3(1, 0, 1)), std::invalid_argument);
}

TEST(VolumeElement, RefusesWhatIsNoBond)
{
  const Particles two{{Vec3(0.2, 0.2, 0.2), Vec3(0.2, 0.2, 0.2)}, {0.1, 0.1}, {0, 0}};
  const ImageShift none = ImageShift::Zero(), x(1, 0, 0), minus_x(-1, 0, 0);
  const auto message = [&](const Particles& particles, const PeriodicContacts& contacts) {
    return refusal([&] { element_with(particles, contacts); });
  };
  EXPECT_NE(message(one_sphere(), {{{0, 0}}, {none}, 0}).find("not to itself"), std::string::npos);
  EXPECT_NE(message(one_sphere(), {{{0, 1}}, {none}, 0}).find("particles 0 to 0 only"),
            std::string::npos);
  EXPECT_NE(message(one_sphere(), {{{0, 0}, {0, 0}}, {x, minus_x}, 0}).find("already bonded"),
            std::string::npos);
  EXPECT_NE(message(two, {{{0, 1}}, {none}, 0}).find("coincide"), std::string::npos);
  EXPECT_NE(message(one_sphere(), {{{0, 0}}, {}, 0}).find("shift"), std::string::npos);
  EXPECT_NE(message(one_sphere(Vec3(NAN, 0, 0)), {{}, {}, 0}).find("finite"), std::string::npos);
  // coincident with an image
  const Particles image{{Vec3(0.2, 0.2, 0.2), Vec3(1.2, 0.2, 0.2)}, {0.1, 0.1}, {0, 0}};
  EXPECT_NE(message(image, {{{0, 1}}, {minus_x}, 0}).find("coincide"), std::string::npos);
}

TEST(VolumeElement, WithoutBondsResistsNothing)
{
  for (const auto condition :
       {BoundaryCondition::affine, BoundaryCondition::kinematic, BoundaryCondition::periodic}) {
    const Homogenization h = homogenize(element_with(one_sphere(), {{}, {}, -1}), condition);
    EXPECT_EQ(h.stiffness.norm(), 0);
    EXPECT_EQ(h.loose, std::vector<Index>{0});
    EXPECT_THROW(compliance(h.stiffness), std::runtime_error);
  }
  EXPECT_EQ(homogenize(element_with({}, {{}, {}, -1})).stiffness.norm(), 0);
}

TEST(VolumeElement, ChainResistsAlongItselfOnly)
{
  const VolumeElement chain = element_with(one_sphere(), {{{0, 0}}, {ImageShift(1, 0, 0)}, 0});
  const Homogenization h = homogenize(chain);
  Mat6 expected = Mat6::Zero();
  expected(0, 0) = 1e6; // kn l^2 / V; shear turns the sphere and costs nothing
  EXPECT_LT((h.stiffness - expected).norm(), 1e-6);
  EXPECT_TRUE(h.loose.empty());
  EXPECT_THROW(compliance(h.stiffness), std::runtime_error);
}

TEST(VolumeElement, LooseClustersAreListedAndCarryNothing)
{
  const double d = 4e-3;
  Crystal crystal = repeated(simple_cubic(d), 2);
  Particles particles{crystal.centre, std::vector<double>(8, d / 2), std::vector<int>(8, 0)};
  const PeriodicContacts contacts = periodic_contacts_within(crystal.cell, particles, 1e-6);
  const Mat6 expected =
      homogenize(make_volume_element(crystal.cell, particles, contacts, {bond()}, {{0, 0, 0}}))
          .stiffness;
  // one small sphere alone and a pair across a face, in the voids
  PeriodicContacts more = contacts;
  particles.centre.insert(
      particles.centre.end(),
      {Vec3(d / 2, d / 2, d / 2), Vec3(-0.1 * d, d / 2, d / 2), Vec3(0.1 * d, d / 2, d / 2)});
  particles.radius.insert(particles.radius.end(), 3, 0.1 * d);
  particles.material_class.insert(particles.material_class.end(), 3, 0);
  more.pairs.push_back({9, 10});
  more.shift.push_back(ImageShift::Zero());
  const VolumeElement element =
      make_volume_element(crystal.cell, particles, more, {bond()}, {{0, 0, 0}});
  for (const auto condition : {BoundaryCondition::periodic, BoundaryCondition::uniform_traction}) {
    const Homogenization h = homogenize(element, condition);
    EXPECT_EQ(h.loose, (std::vector<Index>{8, 9, 10}));
    if (condition == BoundaryCondition::periodic) {
      EXPECT_LT((h.stiffness - expected).norm(), 1e-12 * expected.norm());
      EXPECT_LT(h.per_strain.back().force.norm(), 1e-10 * h.per_strain.front().force.norm());
    }
  }
}

TEST(VolumeElement, SuperWeakBondsEqualNoBonds)
{
  const double d = 4e-3;
  const Crystal crystal = repeated(simple_cubic(d), 2);
  Particles particles{crystal.centre, std::vector<double>(8, d / 2), std::vector<int>(8, 0)};
  PeriodicContacts contacts = periodic_contacts_within(crystal.cell, particles, 1e-6);
  const std::vector<BondLaw> laws{bond(), {burgers(1e-6, 1e9, 5e5, 1e8), 11, 1}};
  const std::vector<PairLaw> pair_laws{{0, 0, 0}, {0, 1, 1}};
  particles.centre.push_back(Vec3(d / 2, d / 2, d / 2)); // in a void
  particles.radius.push_back(0.3 * d);
  particles.material_class.push_back(1);
  const auto stiffness = [&] {
    return homogenize(make_volume_element(crystal.cell, particles, contacts, laws, pair_laws))
        .stiffness;
  };
  const Mat6 without = stiffness();
  for (const Index corner : {0, 1, 2, 4}) {
    contacts.pairs.push_back({corner, 8});
    contacts.shift.push_back(ImageShift::Zero());
  }
  EXPECT_LT((stiffness() - without).norm(), 1e-11 * without.norm());
}

TEST(VolumeElement, ClustersBecomeWhole)
{
  // a pair whose bond crosses a face, and a chain along y that leaves the cell and comes back
  const Particles particles{
      {Vec3(0.05, 0.5, 0.5), Vec3(0.95, 0.5, 0.5), Vec3(0.5, 0.1, 0.1), Vec3(0.5, 0.6, 0.1)},
      {0.05, 0.05, 0.25, 0.25},
      {0, 0, 0, 0}};
  const ImageShift none = ImageShift::Zero(), y(0, 1, 0);
  const VolumeElement element =
      element_with(particles, {{{0, 1}, {2, 3}, {3, 2}}, {ImageShift(-1, 0, 0), none, y}, 0});
  const Clusters clusters = find_clusters(element, std::vector<BondStatus>(3, BondStatus::intact));
  ASSERT_EQ(clusters.cluster.size(), 2u);
  EXPECT_TRUE(clusters.cluster[0].direction.empty());
  ASSERT_EQ(clusters.cluster[1].direction.size(), 1u);
  EXPECT_NEAR(clusters.cluster[1].direction[0].normalized().cwiseAbs().y(), 1, 1e-15);
  const VolumeElement whole = with_whole_clusters(element);
  EXPECT_TRUE(whole.shift[0].isZero());
  EXPECT_NEAR(whole.particles.centre[1].x(), -0.05, 1e-15);
  for (std::size_t b = 0; b < 3; ++b)
    EXPECT_LT((branch(whole, b) - branch(element, b)).norm(), 1e-15);
  EXPECT_THROW(homogenize(element, BoundaryCondition::uniform_traction), std::invalid_argument);
}
