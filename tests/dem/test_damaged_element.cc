#include "dem/damaged_element.h"
#include "dem/homogenization.h"
#include "dem/random.h"
#include "dem/safe_region.h"
#include "tests/dem/elements.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>
#include <random>

using namespace dem;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Strengths strengths_of(const VolumeElement& element, double shear_ratio = 0.5)
{
  return draw_strengths({WeibullStrength{1.1, 60}, NonpositiveRule::error, shear_ratio},
                        element.bonds.id, 4);
}

BreakableElement breakable(VolumeElement element, AfterBreakage rule = AfterBreakage::leave)
{
  Strengths strengths = strengths_of(element);
  return {std::move(element), std::move(strengths), rule};
}

const VolumeElement& cube()
{
  static const VolumeElement element = elements::random_cube(80, 3);
  return element;
}

/// Status in which about a share of the bonds is not intact.
std::vector<BondStatus> damaged(std::size_t n_bonds, double share, BondStatus to)
{
  std::vector<BondStatus> status(n_bonds, BondStatus::intact);
  std::mt19937 generator(7);
  for (BondStatus& each : status)
    if (std::uniform_real_distribution()(generator) < share)
      each = to;
  return status;
}

/// The element without the bonds that are gone.
VolumeElement without(const VolumeElement& element, std::span<const BondStatus> status)
{
  PeriodicContacts contacts{{}, {}, 0};
  for (std::size_t b = 0; b < status.size(); ++b)
    if (status[b] == BondStatus::intact) {
      contacts.pairs.push_back(element.bonds.ends[b]);
      contacts.shift.push_back(element.shift[b]);
    }
  return make_volume_element(element.cell, element.particles, contacts, element.laws,
                             element.pair_laws);
}

/// Mean stress of the forces that bonds transmit, per unit strain. Shear directions are those of
/// the frame, so only products with it count.
Mat6 mean_stress(const BreakableElement& element, const DamagedElement& damage)
{
  const MacroNetwork macro = make_macro_network(element.element());
  Mat6 sum = Mat6::Zero();
  for (std::size_t b = 0; b < element.n_bonds(); ++b) {
    const Mat3 frame = macro.bonds[b].motion.block<3, 3>(0, 6);
    for (int k = 0; k < 6; ++k) {
      const Vec3 force = frame.transpose() * damage.force.block<3, 1>(3 * Eigen::Index(b), k);
      const Mat3 stress = force * branch(element.element(), b).transpose() / element.volume();
      sum.col(k) += to_mandel(0.5 * (stress + stress.transpose()));
    }
  }
  return sum;
}

Vec6 random_strain(std::mt19937& generator)
{
  Vec6 strain;
  for (double& each : strain)
    each = std::normal_distribution()(generator);
  return 1e-3 * strain.normalized();
}

double smallest_eigenvalue(const Mat6& matrix)
{
  return Eigen::SelfAdjointEigenSolver<Mat6>(0.5 * (matrix + matrix.transpose())).eigenvalues()[0];
}

} // namespace

TEST(DamagedElement, IntactIsTheHomogenizedOne)
{
  const BreakableElement element = breakable(cube());
  const Homogenization whole = homogenize(cube());
  EXPECT_LT((element.intact()->stiffness - whole.stiffness).norm(), 1e-11 * whole.stiffness.norm());
  for (std::size_t b = 0; b < element.n_bonds(); b += 17) {
    const auto rows = element.intact()->force.middleRows<3>(3 * Eigen::Index(b));
    EXPECT_LT((rows.colwise().norm() - whole.per_strain[b].force.colwise().norm()).norm(),
              1e-9 * whole.per_strain[b].force.norm());
  }
}

TEST(DamagedElement, WithoutBondsIsTheElementMadeWithoutThem)
{
  const BreakableElement element = breakable(cube());
  for (const double share : {0.02, 0.2, 0.55}) { // at 0.55 many particles are loose
    const auto status = damaged(element.n_bonds(), share, BondStatus::gone);
    const Mat6 expected = homogenize(without(cube(), status)).stiffness;
    const auto found = element.answer(status);
    EXPECT_LT((found->stiffness - expected).norm(), 1e-10 * element.intact()->stiffness.norm())
        << share;
    EXPECT_TRUE(found->obstacle.empty());
  }
}

TEST(DamagedElement, StressAndEnergyAgreeAlsoWithPressedContacts)
{
  const BreakableElement element = breakable(cube(), AfterBreakage::pressed);
  const double size = element.intact()->stiffness.norm();
  for (const BondStatus to : {BondStatus::pressed, BondStatus::gone})
    for (const double share : {0., 0.1, 0.3}) {
      const auto damage = element.answer(damaged(element.n_bonds(), share, to));
      // pieces that only contacts hold have weak springs, whose energy is that of no bond
      EXPECT_LT((mean_stress(element, *damage) - damage->stiffness).norm(),
                (to == BondStatus::gone ? 1e-12 : 1e-9) * size)
          << share;
    }
}

TEST(DamagedElement, StiffnessFallsFromIntactToPressedToGone)
{
  const BreakableElement element = breakable(cube(), AfterBreakage::pressed);
  const double size = element.intact()->stiffness.norm();
  const Mat6 pressed =
      element.answer(damaged(element.n_bonds(), 0.3, BondStatus::pressed))->stiffness;
  const Mat6 gone = element.answer(damaged(element.n_bonds(), 0.3, BondStatus::gone))->stiffness;
  EXPECT_GT(smallest_eigenvalue(element.intact()->stiffness - pressed), -1e-12 * size);
  EXPECT_GT(smallest_eigenvalue(pressed - gone), -1e-9 * size);
  EXPECT_GT((element.intact()->stiffness - pressed).norm(), 0.01 * size);
  EXPECT_GT((pressed - gone).norm(), 0.01 * size);
}

TEST(DamagedElement, TheAnswerDependsOnTheStatusAlone)
{
  const BreakableElement element = breakable(cube());
  const auto first = damaged(element.n_bonds(), 0.1, BondStatus::gone);
  const auto fresh = element.answer(first);
  element.answer(damaged(element.n_bonds(), 0.5, BondStatus::gone));
  EXPECT_EQ(element.answer(first)->stiffness, fresh->stiffness);
  EXPECT_EQ(element.answer(first)->force, fresh->force);
}

TEST(DamagedElement, WithoutBondsCarriesNothing)
{
  const BreakableElement element = breakable(cube(), AfterBreakage::pressed);
  const auto nothing = element.answer(std::vector<BondStatus>(element.n_bonds(), BondStatus::gone));
  EXPECT_EQ(nothing->stiffness.norm(), 0);
  EXPECT_EQ(largest_ratio(*nothing, element.strengths(), Vec6::Ones()), 0);
  const auto contacts = // pressed in all directions
      element.answer(std::vector<BondStatus>(element.n_bonds(), BondStatus::pressed));
  EXPECT_TRUE(contacts->stiffness.allFinite());
  EXPECT_GT(contacts->stiffness.norm(), 0);
}

TEST(DamagedElement, ContactsOpenWhereTheyPull)
{
  const BreakableElement element = breakable(cube(), AfterBreakage::pressed);
  const auto damage = element.answer(damaged(element.n_bonds(), 0.015, BondStatus::pressed));
  std::mt19937 generator(3);
  int n_opened = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec6 a = random_strain(generator), z = random_strain(generator);
    if (!contacts_to_open(*damage, a).empty())
      continue;
    const double share = share_until_opening(*damage, a, z);
    const auto pulls = [&](double at) {
      double largest = -infinity;
      const Eigen::VectorXd force = damage->force * ((1 - at) * a + at * z);
      for (std::size_t b = 0; b < element.n_bonds(); ++b)
        if (damage->status[b] == BondStatus::pressed)
          largest = std::max(largest, force[3 * Eigen::Index(b)]);
      return largest / force.cwiseAbs().maxCoeff();
    };
    EXPECT_EQ(contacts_to_open(*damage, z).empty(), !(pulls(1) > 1e-10));
    if (share > 0 && share < 1) {
      ++n_opened;
      EXPECT_LT(pulls(0.999 * share), 1e-9);
      EXPECT_GT(pulls(std::min(1., share + 1e-3)), 0);
    }
  }
  EXPECT_GT(n_opened, 5);
}

TEST(DamagedElement, BadInputIsRefused)
{
  EXPECT_THROW(breakable(cube(), AfterBreakage::friction), std::invalid_argument);
  EXPECT_THROW(BreakableElement(cube(), Strengths{}, AfterBreakage::leave), std::invalid_argument);
  VolumeElement mixed = elements::two_law_cube(40, 1);
  EXPECT_THROW(breakable(mixed), std::invalid_argument);
  VolumeElement cut = cube();
  cut.is_periodic = false;
  EXPECT_THROW(breakable(cut), std::invalid_argument);
}

TEST(SafeRegion, BoundsTheLargestRatioFromAbove)
{
  const BreakableElement element = breakable(cube());
  const SafeRegion region = safe_region(*element.intact(), element.strengths());
  std::mt19937 generator(5);
  double loosest = 1, tightest = infinity;
  for (int k = 0; k < 20'000; ++k) {
    const Vec6 strain = random_strain(generator);
    const double exact = largest_ratio(*element.intact(), element.strengths(), strain);
    const double bound = ratio_bound(region, strain);
    ASSERT_GE(bound, exact * (1 - 1e-12));
    loosest = std::max(loosest, bound / exact);
    tightest = std::min(tightest, bound / exact);
  }
  EXPECT_LT(loosest, 4);     // it is worth something ...
  EXPECT_LT(tightest, 1.01); // ... and exact where the bonds that lead are looked at
}

TEST(SafeRegion, WithoutStrengthNothingIsSafe)
{
  Strengths strengths = strengths_of(cube());
  strengths.normal[10] = 0;
  const BreakableElement element(cube(), strengths, AfterBreakage::leave);
  const SafeRegion region = safe_region(*element.intact(), element.strengths());
  EXPECT_EQ(ratio_bound(region, 1e-9 * Vec6::Ones()), infinity);
  EXPECT_EQ(ratio_bound(region, Vec6::Zero()), 0);
}

TEST(SafeRegion, UnbreakableBondsAreSafe)
{
  const std::vector<double> endless(cube().bonds.size(), infinity);
  const BreakableElement element(cube(), {endless, endless, 0}, AfterBreakage::leave);
  const SafeRegion region = safe_region(*element.intact(), element.strengths());
  EXPECT_EQ(ratio_bound(region, Vec6::Ones()), 0);
}
