#include "apps/specimen.h"
#include "dem/linear.h"
#include "tests/apps/networks.h"
#include "tests/apps/scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

using namespace apps;

namespace {

Specimen pair(const std::vector<std::string>& settings)
{
  const command::Folder folder;
  networks::write_pair(folder);
  const LoadedScene scene = load_scene(folder / "net.scene", settings);
  EXPECT_FALSE(scene.has_errors());
  return make_specimen(scene, make_packing(scene));
}

} // namespace

TEST(Specimen, IsNotConfinedUnlessTheSceneSaysSo)
{
  EXPECT_TRUE(pair({}).assembly.confinement.empty());
}

TEST(Specimen, IsConfinedByThePressureOnItsLateralSurface)
{
  // Two spheres on the axis, one above the other: each gets the pressure on its half all around.
  const dem::Assembly assembly = pair({"Loading/Confining stress = 150 kPa"}).assembly;
  ASSERT_EQ(assembly.confinement.size(), 2u);
  for (const dem::ParticleLoad& load : assembly.confinement) {
    EXPECT_LT(load.force.norm(), 1e-9);
    EXPECT_LT(load.moment.norm(), 1e-12);
  }
  EXPECT_THROW(dem::make_linear_model(assembly), std::invalid_argument);
}

TEST(Specimen, ConfiningForcesGrowWithTheStress)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n0,0,6,2,top\n"
                                "5,0,4,2,free\n-5,0,4,2,free\n");
  folder.write("bonds.csv", "a,b\n0,1\n0,2\n1,3\n");
  const auto force = [&](const std::string& stress) {
    const LoadedScene scene =
        load_scene(folder / "net.scene", {"Loading/Confining stress = " + stress});
    for (const auto& load : make_specimen(scene, make_packing(scene)).assembly.confinement)
      if (load.particle == 2)
        return load.force;
    return dem::Vec3(0, 0, 0);
  };
  const dem::Vec3 one = force("1 kPa");
  EXPECT_LT(one.x(), -0.1 * 1e3 * 16e-3 * 8e-3); // pressure x diameter x height is all of one side
  EXPECT_GT(one.x(), -1.0 * 1e3 * 16e-3 * 8e-3);
  EXPECT_LT((force("250 kPa") - 250 * one).norm(), 1e-12 * one.norm() * 250);
}

TEST(Specimen, OfAChangingTemperatureHasLawsAtTheReference)
{
  const std::vector<std::string> shifted{"Temperature/Shift law = Arrhenius",
                                         "Temperature/Temperature = 30 degC"};
  const std::vector<std::string> changing{
      "Temperature/Shift law = Arrhenius",
      "Temperature/Temperature history = 0 s: 30 degC, 60 s: 30 degC, 120 s: 40 degC"};
  const auto viscosity = [](const Specimen& specimen) {
    return *specimen.assembly.laws[0].creep.maxwell_viscosity;
  };
  const Specimen plain = pair({}), warm = pair(shifted), history = pair(changing);
  EXPECT_EQ(history.viscosity_shift, 1);
  EXPECT_EQ(viscosity(history), viscosity(plain));
  EXPECT_NE(viscosity(warm), viscosity(plain));
  const LoadedScene scene = scenes::load("", changing);
  ASSERT_TRUE(has_temperature_history(*scene.scene));
  const dem::ReducedTime reduced = make_reduced_time(*scene.scene).value();
  EXPECT_NEAR(dem::shift_factor(reduced, 10) / warm.viscosity_shift, 1, 1e-12);
  EXPECT_NEAR(dem::reduced_time(reduced, 60) * warm.viscosity_shift, 60, 1e-10);
  EXPECT_FALSE(make_reduced_time(*scenes::load("", shifted).scene));
}
