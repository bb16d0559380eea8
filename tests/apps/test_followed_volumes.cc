#include "tests/apps/body_runs.h"

#include <gtest/gtest.h>

#include <cmath>

using apps::Finished;
using body_runs::column;
using command::contains;
using command::mastic;
using command::with;

namespace {

/// Eight spheres in a cubic lattice, in layers of two classes.
const std::string lattice = R"(x_mm,y_mm,z_mm,r_mm,class
0,0,0,2,0
4,0,0,2,0
0,4,0,2,0
4,4,0,2,0
0,0,4,2,1
4,0,4,2,1
0,4,4,2,1
4,4,4,2,1
)";

const std::string layers = R"(set Solver = continuum
subsection Specimen
  set Source = file
  set File = lattice.csv
  set Mean contacts = 6
end
subsection Volume element
  set Source = file
  set Edges = 8 mm, 8 mm, 8 mm
end
subsection Bond law stone
  set Classes = 0: 0, 1: 1
  set Maxwell stiffness = 1e7 N/m
  set Maxwell viscosity = none
  set Kelvin stiffness =
  set Kelvin viscosity =
end
subsection Body
  set Shape = box
  set Edges = 8 mm, 8 mm, 16 mm
  set Cell size = 8 mm
  set Material = all live
end
subsection Volumes
  set Solver = quasistatic
  set Softening = as it is
end
subsection Quasistatic
  set Geometry = small
  set Residual tolerance = 1e-8
end
subsection Strength
  set Distribution = Weibull
  set Modulus = 3
  set Scale = 1e9 N
end
subsection Loading
  set Test = creep
  set Axial stress = 400 kPa
  set End time = 200 s
end
subsection Continuum
  set Order = 1
  set Step tolerance = 1e-6
end
subsection Output
  set Plots = false
  set ParaView = false
  set History times = 12
end
)";

/// Creep compliance of the estimated bond [m/N].
double bond_compliance(double time)
{
  return 1 / 3.2e6 + time / 8.2e8 + (1 - std::exp(-time * 5e5 / 8.4e6)) / 5e5;
}

std::string without(std::string text, const std::string& part)
{
  return text.erase(text.find(part), part.size());
}

} // namespace

TEST(FollowedVolumes, LayersOfTwoLawsCreepAcrossAsTheBondsBetweenThem)
{
  const command::Folder folder;
  folder.write("lattice.csv", lattice);
  folder.write("layers.scene", layers);
  const Finished done = mastic(folder, {"run", "layers.scene", "--quiet"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const auto times = column(folder, "results/layers/history.csv", "time", "s");
  const auto strains = column(folder, "results/layers/history.csv", "axial_strain", "1");
  ASSERT_GT(times.size(), 3u);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double expected = 400e3 * 4e-3 * bond_compliance(times[k]);
    EXPECT_NEAR(strains[k], expected, 1e-5 * expected) << times[k];
  }
  EXPECT_FALSE(
      folder.has("results/layers/complex_modulus.csv")); // no law of one term stands for it
}

TEST(FollowedVolumes, SlideWithFrictionAndGoOnAfterAnInterruptionOnTwoRanks)
{
  const std::string grown = R"(set Solver = continuum
subsection Specimen
  set Solid fraction = 0.62
  set Mean contacts = 6
  set Grading = table
  set Grading table = 2 mm: 0 %, 4 mm: 100 %
end
subsection Bonds
  set After breakage = friction
end
subsection Body
  set Shape = box
  set Edges = 10 mm, 10 mm, 20 mm
  set Cell size = 10 mm
  set Material = adaptive
end
subsection Volumes
  set Solver = quasistatic
  set Softening = as it is
  set Particles = 50
  set Families = 0
  set Breakage tolerance = 1e-3
end
subsection Strength
  set Distribution = Weibull
  set Modulus = 3
  set Scale = 8 N
end
subsection Loading
  set Test = constant rate
  set Strain rate = 1e-4 1/s
  set End strain = 1 %
end
subsection Continuum
  set Order = 1
  set Step tolerance = 1e-3
end
subsection Output
  set Plots = false
  set ParaView = false
  set History times = 12
end
)";
  const command::Folder whole, parts;
  for (const command::Folder* folder : {&whole, &parts})
    folder->write("slide.scene", grown);
  const Finished done = mastic(whole, {"run", "slide.scene", "--quiet"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const Finished stopped =
      interrupted::stopped(parts, with({"run", "slide.scene", "--quiet"}, {interrupted::slow}),
                           "results/slide/checkpoint.h5", 30, SIGTERM);
  ASSERT_EQ(stopped.exit_code, 4) << stopped.output;
  const Finished resumed = body_runs::on_two_ranks(
      parts, with({"run", "--resume", "results/slide"}, {interrupted::quick}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  const auto stress = column(whole, "results/slide/history.csv", "axial_stress", "Pa");
  const auto again = column(parts, "results/slide/history.csv", "axial_stress", "Pa");
  const auto broken = body_runs::numbers(whole, "results/slide/volumes.csv", "broken_bonds");
  EXPECT_GT(broken.back(), 0);
  EXPECT_EQ(body_runs::numbers(parts, "results/slide/volumes.csv", "broken_bonds"), broken);
  ASSERT_EQ(stress.size(), again.size());
  for (std::size_t k = 0; k < stress.size(); ++k)
    EXPECT_NEAR(stress[k], again[k], 1e-4 * std::abs(stress.back())) << k;
}

TEST(FollowedVolumes, SayWhatTheyCannot)
{
  const command::Folder folder;
  folder.write("lattice.csv", lattice);
  folder.write("layers.scene", layers);
  const auto refused = [&](const std::string& setting, const std::string& text) {
    const Finished done = mastic(folder, with({"run", "layers.scene", "--quiet"}, {setting}));
    EXPECT_EQ(done.exit_code, 2) << done.output;
    EXPECT_TRUE(contains(done.output, text)) << done.output;
  };
  refused("Volumes/Softening = scaled", "are as large as their elements");
  refused("Body/Material = adaptive", "bonds of several laws have no common law to start from");
  refused("Body/Cell size = 4 mm", "a volume is 8 mm wide and an element of the mesh 4 mm");
  folder.write("layers.scene", without(layers, "  set Solver = quasistatic\n"));
  refused("Bonds/After breakage = friction", "volumes know friction with Volumes/Solver");
}
