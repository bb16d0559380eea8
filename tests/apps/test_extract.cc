#include "apps/csv_table.h"
#include "fem/law_file.h"
#include "fem/symmetry.h"
#include "tests/apps/command.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

const std::string scene = R"(set Title = Small volumes
subsection Specimen
  set Particles = 60
  set Solid fraction = 0.62
end
subsection Strength
  set Distribution = none
end
subsection Volume element
  set Realisations = 3
end
subsection Output
  set Plots = false
end
)";

Finished extract(const command::Folder& folder, const std::vector<std::string>& settings = {},
                 const std::string& threads = "1")
{
  folder.write("rve.scene", scene);
  std::vector<std::string> arguments{"extract", "rve.scene", "-o", "out", "--threads", threads};
  return mastic(folder, with(arguments, settings));
}

fem::LawRecord law_in(const command::Folder& folder)
{
  return fem::law_from_text(folder.read("out/rve.law"), "rve.law");
}

} // namespace

TEST(Extract, WritesALawThatIsTheSameOnAnyNumberOfThreads)
{
  const command::Folder one, two;
  const Finished done = extract(one);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "NOT large enough for 5 %")) << done.output;
  EXPECT_TRUE(contains(done.output, "(Hill-Mandel)")) << done.output;
  EXPECT_EQ(extract(two, {}, "2").exit_code, 0);
  const auto expect_same = [&] { // to rounding: sums depend on how memory is aligned
    const fem::Mat6 a = fem::compliance(law_in(one).law, 100),
                    b = fem::compliance(law_in(two).law, 100);
    EXPECT_LT((a - b).norm(), 1e-12 * a.norm());
  };
  expect_same();
  const fem::LawRecord record = law_in(one);
  EXPECT_EQ(record.law.terms.size(), 1u); // Burgers
  const Finished again = extract(one);    // from the kept packings
  EXPECT_EQ(again.exit_code, 0) << again.output;
  expect_same();
}

TEST(Extract, SymmetryIsTheNearestAndItsDistanceIsSaid)
{
  const command::Folder folder;
  const Finished done = extract(folder, {"Volume element/Symmetry = isotropic"});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "has the symmetry asked for")) << done.output;
  const fem::LawRecord record = law_in(folder);
  EXPECT_LT(fem::distance(record.law, fem::Symmetry{}), 1e-12);
  EXPECT_GT(record.relative_error, 1e-3);
}

TEST(Extract, ReadsAPeriodicPackingAndSeveralBondLaws)
{
  // one sphere of each class in a box of 2 x 1 x 1 diameters; bonds of unlike spheres along x
  const command::Folder folder;
  folder.write("pair.csv", "x_mm,y_mm,z_mm,r_mm,class\n0,0,0,2,0\n4,0,0,2,1\n");
  const std::vector<std::string> settings{"Specimen/Source = file",
                                          "Specimen/File = pair.csv",
                                          "Specimen/Mean contacts = 6",
                                          "Volume element/Source = file",
                                          "Volume element/Edges = 8 mm, 4 mm, 4 mm",
                                          "Volume element/First time = 0.01 s",
                                          "Volume element/Last time = 1000 s",
                                          "Volume element/Bounds = false"};
  folder.write("rve.scene", scene +
                                "subsection Bond law stone\n  set Classes = 1: 1\n  set Maxwell "
                                "stiffness = 1e7 N/m\n  set Maxwell viscosity = none\n  set "
                                "Kelvin stiffness =\n  set Kelvin viscosity =\nend\n");
  const Finished done =
      mastic(folder, with({"extract", "rve.scene", "-o", "out", "--threads", "1"}, settings));
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "several bond laws: ")) << done.output;
  EXPECT_TRUE(contains(done.output, "complex compliances that were solved for")) << done.output;
  const fem::LawRecord record = law_in(folder);
  // along x: binder only, S = D J(t); the preset's Burgers constants
  EXPECT_NEAR(record.law.instantaneous(0, 0) * 3.2e6 / 4e-3, 1, 1e-2);
}

TEST(Extract, RefusesWhatCannotBe)
{
  const command::Folder folder;
  const auto refused = [&](const std::vector<std::string>& settings, const std::string& text) {
    const Finished done = extract(folder, settings);
    EXPECT_EQ(done.exit_code, 2) << done.output;
    EXPECT_TRUE(contains(done.output, text)) << done.output;
    EXPECT_FALSE(folder.has("out"));
  };
  refused({"Volume element/Boundary condtion = affine"}, "did you mean 'Boundary condition'");
  refused({"Volume element/Last time = 1e-4 s"}, "must be later than First time");
  refused({"Volume element/Source = cut"}, "a cut element has no periodic one");
  refused({"Volume element/Source = file", "Volume element/Sizes = 10, 20"},
          "is for Source = grow only");
}
