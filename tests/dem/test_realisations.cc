#include "dem/crystals.h"
#include "dem/realisations.h"
#include "dem/volume_element_storage.h"
#include "tests/dem/elements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>

using namespace dem;

namespace {

VolumeElement small(std::uint64_t seed)
{
  return elements::random_cube(40, seed);
}

} // namespace

TEST(Realisations, DoNotDependOnTheNumberOfThreads)
{
  const auto one = realisations(small, 1, 6, 1), three = realisations(small, 1, 6, 3);
  for (std::size_t k = 0; k < one.size(); ++k) {
    const auto same = [](const Mat6& a, const Mat6& b) { // sums depend on how memory is aligned
      EXPECT_LT((a - b).norm(), 1e-12 * a.norm());
    };
    same(one[k].kinematic, three[k].kinematic);
    same(one[k].periodic, three[k].periodic);
    same(one[k].traction, three[k].traction);
  }
  EXPECT_NE(one[0].periodic, one[1].periodic);
}

TEST(Realisations, FailWithTheFirstFailure)
{
  for (const int n_threads : {1, 3}) {
    try {
      for_each_realisation(8, n_threads, [](int k) {
        if (k > 2)
          throw std::runtime_error(std::to_string(k));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "3");
    }
  }
  EXPECT_THROW(for_each_realisation(1, 0, [](int) {}), std::invalid_argument);
}

TEST(Realisations, StatisticsAreThoseOfStudent)
{
  std::vector<Mat6> tensors;
  for (const double value : {1.0, 2.0, 4.0, 5.0})
    tensors.push_back(Mat6::Constant(value));
  const TensorStatistics s = statistics(tensors);
  EXPECT_NEAR(s.mean(2, 3), 3, 1e-15);
  EXPECT_NEAR(s.standard_deviation(0, 0), std::sqrt(10.0 / 3), 1e-15);
  EXPECT_NEAR(s.band(0, 0), 3.182446305284263 * std::sqrt(10.0 / 3) / 2, 1e-12); // t(3, 0.975)
  EXPECT_THROW(statistics({tensors.data(), 1}), std::invalid_argument);
  EXPECT_THROW(statistics(tensors, 1), std::invalid_argument);
}

TEST(Realisations, CrystalsDoNotScatter)
{
  const auto make = [](std::uint64_t n) {
    return bonded_crystal(repeated(simple_cubic(1), int(n)), 1, elements::law());
  };
  const auto bounds = realisations(make, 5, 2, 2);
  const SizeVerdict verdict = judge_size(bounds, 0.5);
  EXPECT_LT(verdict.scatter, 1e-12);
  EXPECT_LT(verdict.gap, 1e-12);
  EXPECT_NEAR(verdict.size_ratio, 5, 1e-12);
  EXPECT_TRUE(verdict.is_large_enough) << verdict.reason;
  EXPECT_FALSE(judge_size(realisations(make, 3, 2, 1), 0.5).is_large_enough);
}

TEST(Realisations, LargerElementsScatterLessAndAreJudgedSo)
{
  const auto verdict = [](std::size_t n) {
    const auto make = [n](std::uint64_t seed) { return elements::random_cube(n, seed); };
    return judge_size(realisations(make, 1, 8, 2), 0.01);
  };
  const SizeVerdict few = verdict(30), many = verdict(400);
  EXPECT_GT(few.scatter, many.scatter);
  EXPECT_GT(few.gap, many.gap);
  EXPECT_LT(many.band, many.scatter);
  EXPECT_FALSE(few.is_large_enough);
  EXPECT_NE(few.reason.find("largest diameters"), std::string::npos);
}

TEST(VolumeElementStorage, ReadsWhatItWrote)
{
  const std::string folder = testing::TempDir();
  const std::filesystem::path path =
      std::filesystem::path(folder) / ("element_" + std::to_string(::getpid()) + ".h5");
  VolumeElement element = elements::two_law_cube(40, 2);
  element.laws[1].creep = make_creep_law(3e6, std::nullopt, {}); // without dashpot or branches
  VolumeElement empty = element;
  empty.bonds = {};
  empty.shift.clear();
  {
    Hdf5File file = Hdf5File::create(path);
    write_volume_element(file, "element", element);
    write_volume_element(file, "empty", empty);
    file.publish();
  }
  const Hdf5File file = Hdf5File::open(path);
  const VolumeElement read = read_volume_element(file, "element");
  EXPECT_EQ(read.cell.edges, element.cell.edges);
  EXPECT_EQ(read.particles.centre, element.particles.centre);
  EXPECT_EQ(read.particles.radius, element.particles.radius);
  EXPECT_EQ(read.bonds.ends, element.bonds.ends);
  EXPECT_EQ(read.bonds.law, element.bonds.law);
  EXPECT_EQ(read.bonds.id, element.bonds.id);
  EXPECT_EQ(read.shift, element.shift);
  EXPECT_EQ(read.is_periodic, element.is_periodic);
  EXPECT_FALSE(read.laws[1].creep.maxwell_viscosity);
  EXPECT_EQ(read.pair_laws.size(), element.pair_laws.size());
  EXPECT_EQ(homogenize(read).stiffness, homogenize(element).stiffness);
  EXPECT_EQ(read_volume_element(file, "empty").bonds.size(), 0u);
  EXPECT_THROW(read_volume_element(file, "other"), std::runtime_error);
  std::filesystem::remove(path);
}
