#include "dem/crystals.h"
#include "dem/homogenization.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

using namespace dem;

namespace {

constexpr double diameter = 4e-3, normal_stiffness = 1e6;

BondLaw bond(double ratio = 11)
{
  return {burgers(normal_stiffness, 1e9, 5e5, 1e8), ratio, 1};
}

Crystal named(const std::string& name)
{
  return name == "SC"    ? simple_cubic(diameter)
         : name == "BCC" ? body_centred_cubic(diameter)
                         : face_centred_cubic(diameter);
}

Mat6 stiffness_of(const Crystal& crystal, const BondLaw& law = bond())
{
  return homogenize(bonded_crystal(crystal, diameter, law)).stiffness;
}

/// Cubic symmetry in Mandel notation, from the constants of Voigt's.
Mat6 cubic(double c11, double c12, double c44)
{
  Mat6 result = Mat6::Zero();
  result.topLeftCorner<3, 3>().setConstant(c12);
  result.diagonal() << c11, c11, c11, 2 * c44, 2 * c44, 2 * c44;
  return result;
}

double distance(const Mat6& a, const Mat6& b)
{
  return (a - b).norm() / b.norm();
}

double modulus_along(const Mat6& compliance, const Vec3& direction)
{
  const Vec3 n = direction.normalized();
  const Vec6 m = to_mandel(n * n.transpose());
  return 1 / m.dot(compliance * m);
}

} // namespace

TEST(Crystals, HaveTheModuliOfTheLattice)
{
  for (const auto& row : reference::table("lattice_moduli.csv")) {
    const std::string name = row.at("lattice");
    const auto value = [&](const char* column) { return reference::number(row, column); };
    const Homogenization h = homogenize(bonded_crystal(named(name), diameter, bond()));
    EXPECT_LT(distance(h.stiffness, cubic(value("C11"), value("C12"), value("C44"))), 1e-13)
        << name;
    const Mat6 s = compliance(h.stiffness);
    EXPECT_LT(distance(s, cubic(value("S11"), value("S12"), value("S44") / 4)), 1e-12) << name;
    EXPECT_LT(h.asymmetry, 1e-13);
    EXPECT_LT(h.hill_mandel, 1e-13);
    EXPECT_TRUE(h.loose.empty());
  }
}

TEST(Crystals, HaveTheModuliInOtherDirections)
{
  for (const auto& row : reference::table("lattice_directional.csv")) {
    const Mat6 s = compliance(stiffness_of(named(row.at("lattice"))));
    for (const auto& [column, direction] :
         {std::pair("E_100", Vec3(1, 0, 0)), std::pair("E_110", Vec3(1, 1, 0)),
          std::pair("E_111", Vec3(1, 1, 1)), std::pair("E_120", Vec3(1, 2, 0))})
      EXPECT_NEAR(modulus_along(s, direction) / reference::number(row, column), 1, 1e-12);
  }
}

TEST(Crystals, CreepLikeOneBond)
{
  const CreepLaw creep = laws::burgers_set("asphalt"); // K_m = 1e6 N/m
  for (const auto& row : reference::table("lattice_creep_compliance.csv")) {
    const VolumeElement element =
        bonded_crystal(named(row.at("lattice")), diameter, {creep, 11, 1});
    const Mat6 s = compliance(homogenize(element).stiffness);
    const Mat6 now = creep_compliance(element, s, reference::number(row, "t"));
    const auto value = [&](const char* column) { return reference::number(row, column); };
    EXPECT_LT(distance(now, cubic(value("S11"), value("S12"), value("S44") / 4)), 1e-12)
        << row.at("lattice") << " " << row.at("t");
  }
}

TEST(Crystals, OfDifferentBondsTurnTheirSpheres)
{
  for (const auto& row : reference::table("lattice_orthotropic_sc.csv")) {
    VolumeElement element = bonded_crystal(simple_cubic(diameter), diameter, bond());
    element.laws.clear();
    for (const char* factor : {"fx", "fy", "fz"}) {
      BondLaw law = bond();
      law.creep = scaled(law.creep, reference::number(row, factor));
      element.laws.push_back(law);
    }
    for (std::size_t b = 0; b < element.bonds.size(); ++b) {
      int axis = 0;
      branch(element, b).cwiseAbs().maxCoeff(&axis);
      element.bonds.law[b] = axis;
    }
    Mat6 expected = Mat6::Zero();
    int k = 0;
    for (const char* column : {"C11", "C22", "C33", "C44", "C55", "C66"}) {
      expected(k, k) = (k < 3 ? 1 : 2) * reference::number(row, column);
      ++k;
    }
    const Mat6 found = homogenize(element).stiffness;
    for (k = 0; k < 6; ++k)
      EXPECT_NEAR(found(k, k) / expected(k, k), 1, 1e-11) << k;
    EXPECT_LT(distance(found, expected), 1e-13);
  }
}

TEST(Crystals, AreTheSameInAnyCell)
{
  const Mat6 expected = stiffness_of(face_centred_cubic(diameter));
  EXPECT_LT(distance(stiffness_of(primitive_face_centred_cubic(diameter)), expected), 1e-13);
  // sheared by whole lattice vectors, far beyond one half
  Mat3 shear;
  shear << 1, 3, -2, 0, 1, 5, 0, 0, 1;
  Crystal sheared = primitive_face_centred_cubic(diameter);
  sheared.cell.edges = sheared.cell.edges * shear;
  EXPECT_LT(distance(stiffness_of(sheared), expected), 1e-12);
  Crystal cube = face_centred_cubic(diameter);
  cube.cell.edges = cube.cell.edges * shear;
  cube.centre[1] += 7 * cube.cell.edges.col(1); // any image will do
  EXPECT_LT(distance(stiffness_of(cube), expected), 1e-12);
}

TEST(Crystals, DoNotDependOnTheNumberOfCells)
{
  for (const std::string name : {"SC", "BCC", "FCC"}) {
    const Mat6 one = stiffness_of(named(name));
    for (const int n : {2, 3})
      EXPECT_LT(distance(stiffness_of(repeated(named(name), n)), one), 1e-12) << name << n;
  }
}

TEST(Crystals, HexagonalPackingIsTheSumOverItsBondsLessTheRelaxationOfTwoSpheres)
{
  // Dense algebra of its own: relative displacement (3) and the two rotations (6) of the spheres.
  const Crystal crystal = hexagonal_close_packed(diameter);
  const double kn = normal_stiffness, ks = kn / 11, r = diameter / 2;
  const double kb = kn * r * r / 4, kt = ks * r * r / 2;
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(9, 9), coupling = Eigen::MatrixXd::Zero(9, 6);
  Mat6 affine = Mat6::Zero();
  int n_bonds = 0;
  const auto add = [&](int i, int j, const Vec3& l) {
    const Vec3 n = l / l.norm();
    Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(6, 9); // rows: delta, phi
    Mat3 cross;
    cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
    if (i != j)
      motion.block<3, 3>(0, 0) = (j - i) * Mat3::Identity(); // displacement of 1 less that of 0
    motion.block<3, 3>(0, 3 + 3 * i) += r * cross;
    motion.block<3, 3>(0, 3 + 3 * j) += r * cross;
    motion.block<3, 3>(3, 3 + 3 * i) -= Mat3::Identity();
    motion.block<3, 3>(3, 3 + 3 * j) += Mat3::Identity();
    Eigen::Matrix<double, 6, 6> k = Mat6::Zero(), strain = Mat6::Zero();
    k.topLeftCorner<3, 3>() = ks * Mat3::Identity() + (kn - ks) * n * n.transpose();
    k.bottomRightCorner<3, 3>() = kb * Mat3::Identity() + (kt - kb) * n * n.transpose();
    for (int c = 0; c < 6; ++c)
      strain.block<3, 1>(0, c) = from_mandel(Vec6::Unit(c)) * l;
    stiffness += motion.transpose() * k * motion;
    coupling += motion.transpose() * k * strain;
    affine += strain.transpose() * k * strain;
    ++n_bonds;
  };
  for (int i = 0; i < 2; ++i)
    for (int j = i; j < 2; ++j)
      for (int a = -3; a <= 3; ++a)
        for (int b = -3; b <= 3; ++b)
          for (int c = -3; c <= 3; ++c) {
            const Vec3 l =
                crystal.centre[j] - crystal.centre[i] + crystal.cell.edges * Vec3(a, b, c);
            const bool first = i < j || a > 0 || (a == 0 && (b > 0 || (b == 0 && c > 0)));
            if (first && std::abs(l.norm() - diameter) < 1e-9 * diameter)
              add(i, j, l);
          }
  EXPECT_EQ(n_bonds, 12);
  const Mat6 expected =
      (affine - coupling.transpose() * stiffness.inverse() * coupling) / crystal.cell.volume();
  EXPECT_LT(distance(stiffness_of(crystal), expected), 1e-12);
  EXPECT_GT(distance(affine / crystal.cell.volume(), expected), 1e-2); // the spheres do move
}

TEST(Crystals, AffineMotionIsExactWhereEverySphereIsACentreOfSymmetry)
{
  for (const std::string name : {"SC", "BCC", "FCC"}) {
    const VolumeElement element = bonded_crystal(named(name), diameter, bond());
    EXPECT_LT(distance(homogenize(element, BoundaryCondition::affine).stiffness,
                       homogenize(element).stiffness),
              1e-13);
  }
}
