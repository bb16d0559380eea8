#include "apps/specimen.h"
#include "dem/hdf5_file.h"
#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

using namespace apps;

namespace {

using Settings = std::vector<std::string>;

Specimen specimen_in(const command::Folder& folder, const Settings& settings = {})
{
  const LoadedScene scene = load_scene(folder / "net.scene", settings);
  for (const Diagnostic& each : scene.diagnostics)
    if (each.kind == Diagnostic::Kind::error)
      throw std::logic_error("the scene of the test is wrong: " + each.message);
  return make_specimen(scene, make_packing(scene));
}

/// Why a specimen is refused as input, without the name of the folder; empty if it is taken.
std::string refusal(const command::Folder& folder, const Settings& settings = {})
{
  std::string message;
  try {
    specimen_in(folder, settings);
    return message;
  } catch (const std::invalid_argument& problem) {
    message = problem.what();
  }
  const std::string at = (folder / "").string();
  for (std::size_t found; (found = message.find(at)) != std::string::npos;)
    message.erase(found, at.size());
  return message;
}

/// Refusal of two spheres with another particle file.
std::string particle_refusal(const std::string& particles, const Settings& settings = {})
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", particles);
  return refusal(folder, settings);
}

/// Refusal of two spheres with another bond file.
std::string bond_refusal(const std::string& bonds)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("bonds.csv", bonds);
  return refusal(folder);
}

const std::string columns = "x, y, z, r, class, held, fx, fy, fz, mx, my, mz";

} // namespace

TEST(ParticleFile, IsReadInItsUnits)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", "\xEF\xBB\xBF# from a scan\r\n"
                                "r_um, z [mm], y_cm, x_m, class, held, mx_N_mm, fz_kN\r\n"
                                "\r\n"
                                "2000, 2, 0.1, 1e-3, 0, bottom, 0, 0   # the lower one\r\n"
                                "2000, 6, 0.1, 1e-3, 3, free, 5, -0.1\r\n");
  const Specimen specimen = specimen_in(folder, {"Loading/Test = particle loads"});
  const dem::Assembly& assembly = specimen.assembly;
  ASSERT_EQ(assembly.particles.size(), 2u);
  EXPECT_DOUBLE_EQ(assembly.particles.radius[1], 2e-3);
  EXPECT_NEAR((assembly.particles.centre[1] - dem::Vec3(1e-3, 1e-3, 6e-3)).norm(), 0, 1e-18);
  EXPECT_EQ(assembly.particles.material_class, (std::vector<int>{0, 3}));
  EXPECT_EQ(assembly.support, (std::vector{dem::Support::bottom, dem::Support::free}));
  ASSERT_EQ(assembly.loads.size(), 1u);
  EXPECT_EQ(assembly.loads[0].particle, 1);
  EXPECT_DOUBLE_EQ(assembly.loads[0].force.z(), -100);
  EXPECT_DOUBLE_EQ(assembly.loads[0].moment.x(), 5e-3);
  EXPECT_DOUBLE_EQ(assembly.gauge_length, 8e-3);
}

TEST(ParticleFile, RefusesWrongHeaders)
{
  const std::string row = "0,0,2,2\n";
  EXPECT_EQ(particle_refusal(""),
            "particles.csv: the file is empty; the first line names the columns");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm\n"),
            "particles.csv: there are no particles in it");
  EXPECT_EQ(particle_refusal("0,0,2,2\n0,0,6,2\n"), "particles.csv: there are two columns '0'");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,r_mm\n0,0,2\n"),
            "particles.csv: there is no column 'z' (with its unit, such as z_m)");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r\n" + row),
            "particles.csv: column 'r' needs a unit in its name, such as r_m");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_kg,r_mm\n" + row),
            "particles.csv: column 'z': 'kg' cannot be converted to m");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_smoot,r_mm\n" + row),
            "particles.csv: column 'z': 'smoot' is not a known unit");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm,x_m\n0,0,2,2,0\n"),
            "particles.csv: there are two columns 'x'");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm,clas\n0,0,2,2,0\n"),
            "particles.csv: unknown column 'clas'; did you mean 'class'?; columns are: " + columns);
  EXPECT_EQ(particle_refusal("x_mm;y_mm;z_mm;r_mm\n0;0;2;2\n"),
            "particles.csv: 'x_mm;y_mm;z_mm;r_mm': columns are separated by commas");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm,mx_N\n0,0,2,2,0\n0,0,6,2,1\n"),
            "particles.csv: column 'mx': 'N' cannot be converted to N m");
}

TEST(ParticleFile, RefusesWrongCellsWithTheirLine)
{
  const std::string head = "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n";
  EXPECT_EQ(particle_refusal(head + "0,zero,6,2,top\n"),
            "particles.csv:3: column 'y': 'zero' is not a number");
  EXPECT_EQ(particle_refusal(head + "# note\n\n0,nan,6,2,top\n"),
            "particles.csv:5: column 'y': 'nan' is not a number");
  EXPECT_EQ(particle_refusal(head + "0,0,inf,2,top\n"),
            "particles.csv:3: column 'z': 'inf' is not a number");
  EXPECT_EQ(particle_refusal(head + "0,0,6 mm,2,top\n"),
            "particles.csv:3: column 'z': '6 mm' is not a number");
  EXPECT_EQ(particle_refusal(head + "0,,6,2,top\n"),
            "particles.csv:3: column 'y': '' is not a number");
  EXPECT_EQ(particle_refusal(head + "0,0,6,2\n"),
            "particles.csv:3: the row has 4 cells, the header 5 columns");
  EXPECT_EQ(particle_refusal(head + "0,0,6,2,top,\n"),
            "particles.csv:3: the row has 6 cells, the header 5 columns");
  EXPECT_EQ(particle_refusal(head + "0,0,6,-2,top\n"),
            "particles.csv:3: the radius must be > 0, found -0.002 m");
  EXPECT_EQ(particle_refusal(head + "0,0,6,0,top\n"),
            "particles.csv:3: the radius must be > 0, found 0 m");
  EXPECT_EQ(particle_refusal(head + "0,0,6,2,upper\n"),
            "particles.csv:3: column 'held': 'upper' is not one of: free | bottom | top");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm,class\n0,0,2,2,0\n0,0,6,2,1.5\n"),
            "particles.csv:3: column 'class': '1.5' is not a whole number");
}

TEST(ParticleFile, RefusesUnusualRadiiUnlessTheyAreMeant)
{
  const std::string in_metres = "x_m,y_m,z_m,r_m,held\n0,0,2,2,bottom\n0,0,6,2,top\n";
  EXPECT_EQ(particle_refusal(in_metres),
            "particles.csv:2: a radius of 2 m is outside 1e-6 to 1 m; if that is meant, set Accept "
            "unusual values = true");
  EXPECT_EQ(particle_refusal(in_metres, {"Accept unusual values = true"}), "");
  EXPECT_EQ(particle_refusal("x_nm,y_nm,z_nm,r_nm,held\n0,0,2,2,bottom\n0,0,6,2,top\n"),
            "particles.csv:2: a radius of 2e-09 m is outside 1e-6 to 1 m; if that is meant, set "
            "Accept unusual values = true");
}

TEST(ParticleFile, RefusesDeepOverlapsAndCoincidentCentres)
{
  const std::string head = "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n";
  EXPECT_EQ(particle_refusal(head + "0,0,5.81,2,top\n"), "");
  EXPECT_EQ(particle_refusal(head + "0,0,5.79,2,top\n"),
            "particles.csv:3: the sphere overlaps the one at particles.csv:2 by more than a tenth "
            "of the smaller radius; if that is meant, set Accept unusual values = true");
  EXPECT_EQ(particle_refusal(head + "0,0,2,2,top\n0,0,2,2,top\n"),
            "particles.csv:3: the sphere overlaps the one at particles.csv:2 by more than a tenth "
            "of the smaller radius; there are 3 such pairs; if that is meant, set Accept unusual "
            "values = true");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm,held\n0,0,900,900,bottom\n0,0,901,1,top\n"),
            "particles.csv:3: the sphere overlaps the one at particles.csv:2 by more than a tenth "
            "of the smaller radius; if that is meant, set Accept unusual values = true");
}

TEST(ParticleFile, MustExistAndHaveAKnownEnding)
{
  const command::Folder folder;
  networks::write_pair(folder);
  EXPECT_EQ(refusal(folder, {"Specimen/File = none.csv"}),
            "none.csv cannot be read: there is no such file, or you may not read it");
  EXPECT_EQ(refusal(folder, {"Specimen/File = none.h5"}), "none.h5: there is no such file");
  EXPECT_EQ(refusal(folder, {"Specimen/File = bonds.txt"}),
            "bonds.txt: packings are read from .csv and .h5");
  EXPECT_EQ(refusal(folder, {"Specimen/Bond file = none.csv"}),
            "none.csv cannot be read: there is no such file, or you may not read it");
  folder.write("text.h5", "no HDF5");
  EXPECT_EQ(refusal(folder, {"Specimen/File = text.h5"}),
            "text.h5: this is not an HDF5 file, or it is damaged");
}

TEST(BondFile, GivesBondsAndStrengths)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("bonds.csv", "normal_strength_kN,b,shear_strength_N,a\n0.05,1,7,0\n");
  const Specimen both = specimen_in(folder);
  EXPECT_EQ(both.assembly.bonds.ends, (std::vector<std::array<dem::Index, 2>>{{0, 1}}));
  ASSERT_TRUE(both.assembly.strengths);
  EXPECT_EQ(both.assembly.strengths->normal, std::vector<double>{50});
  EXPECT_EQ(both.assembly.strengths->shear, std::vector<double>{7});
  EXPECT_FALSE(specimen_in(folder, {"Strength/Distribution = none"}).assembly.strengths);

  folder.write("bonds.csv", "a,b,normal_strength_N\n0,1,0\n");
  const Specimen one = specimen_in(folder);
  EXPECT_EQ(one.assembly.strengths->shear, std::vector<double>{0});

  folder.write("bonds.csv", "a,b\n0,1\n");
  const Specimen drawn = specimen_in(folder);
  ASSERT_TRUE(drawn.assembly.strengths);
  EXPECT_EQ(drawn.assembly.strengths->normal.size(), 1u);
}

TEST(BondFile, RefusesBondsThatCannotBe)
{
  EXPECT_EQ(bond_refusal(""), "bonds.csv: the file is empty; the first line names the columns");
  EXPECT_EQ(bond_refusal("a\n0\n"), "bonds.csv: there is no column 'b'");
  EXPECT_EQ(bond_refusal("a,b\n0,1\n1,0\n"),
            "bonds.csv: bond 1 between particles 1 and 0: this pair is already bonded");
  EXPECT_EQ(bond_refusal("a,b\n1,1\n"),
            "bonds.csv: bond 0 between particles 1 and 1: a particle cannot be bonded to itself");
  EXPECT_EQ(bond_refusal("a,b\n0,2\n"),
            "bonds.csv: bond 0 between particles 0 and 2: there are particles 0 to 1 only");
  EXPECT_EQ(bond_refusal("a,b\n-1,1\n"),
            "bonds.csv: bond 0 between particles -1 and 1: there are particles 0 to 1 only");
  EXPECT_EQ(bond_refusal("a,b\n0,0.5\n"), "bonds.csv:2: column 'b': '0.5' is not a whole number");
  EXPECT_EQ(bond_refusal("a,b\n0,1e12\n"), "bonds.csv:2: column 'b': '1e12' is not a whole number");
  EXPECT_EQ(bond_refusal("a,b,normal_strength_N\n0,1,-5\n"),
            "bonds.csv:2: column 'normal_strength': a strength must be >= 0, found -5 N");
  EXPECT_EQ(bond_refusal("a,b,normal_strength_N\n0,1,nan\n"),
            "bonds.csv:2: column 'normal_strength': 'nan' is not a number");
  EXPECT_EQ(bond_refusal("a,b,normal_strength\n0,1,5\n"),
            "bonds.csv: column 'normal_strength' needs a unit in its name, such as "
            "normal_strength_N");
  EXPECT_EQ(bond_refusal("a,b,normal_strength_mm\n0,1,5\n"),
            "bonds.csv: column 'normal_strength': 'mm' cannot be converted to N");
  EXPECT_EQ(bond_refusal("a,b,shear_strength_N\n0,1,5\n"),
            "bonds.csv: column 'shear_strength' needs a column 'normal_strength' (with its unit, "
            "such as normal_strength_N)");
  EXPECT_EQ(bond_refusal("a,b,normal_strenght_N\n0,1,5\n"),
            "bonds.csv: unknown column 'normal_strenght'; did you mean 'normal_strength'?; columns "
            "are: a, b, normal_strength, "
            "shear_strength");
}

TEST(BondFile, RefusesBondsOverWideGapsUnlessTheyAreMeant)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n0,0,10,1,top\n");
  EXPECT_EQ(refusal(folder), ""); // a gap of five times the smaller radius
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n0,0,10.1,1,top\n");
  EXPECT_EQ(refusal(folder),
            "bonds.csv:2: the spheres 0 and 1 are 5.1 mm apart, more than 5 times the smaller "
            "radius; if that is meant, set Accept unusual values = true");
  EXPECT_EQ(refusal(folder, {"Accept unusual values = true"}), "");
}

TEST(Specimen, RefusesLoadsThatNothingCarries)
{
  EXPECT_EQ(
      bond_refusal("a,b\n"),
      "the specimen cannot carry the load: no chain of bonds connects the platens any more (2 "
      "particles, 0 bonds, 1 particles glued to the lower platen, 1 to the upper one)");
  EXPECT_EQ(
      particle_refusal("x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,free\n0,0,6,2,top\n"),
      "the specimen cannot carry the load: no chain of bonds connects the platens any more (2 "
      "particles, 1 bonds, 0 particles glued to the lower platen, 1 to the upper one)");
  const Settings by_particles{"Loading/Test = particle loads"};
  EXPECT_EQ(
      particle_refusal("x_mm,y_mm,z_mm,r_mm,held,fz_N\n0,0,2,2,free,0\n0,0,6,2,free,1\n",
                       by_particles),
      "the specimen cannot carry the load: particle 0 is part of a piece that is loaded, but "
      "nothing holds it (2 particles, 1 bonds, 0 particles glued to the lower platen, 0 to the "
      "upper one)");
}

TEST(Specimen, RefusesParticleLoadsThatAreIncomplete)
{
  const Settings by_particles{"Loading/Test = particle loads"};
  EXPECT_EQ(
      particle_refusal("x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n0,0,6,2,free\n", by_particles),
      "particles.csv: Test = particle loads, but no particle is loaded (columns fx_N to "
      "mz_N_m)");
  EXPECT_EQ(
      particle_refusal("x_mm,y_mm,z_mm,r_mm,fz_N\n0,0,2,2,0\n0,0,6,2,1\n", by_particles),
      "particles.csv: particle loads need a column 'held' that says what holds each particle: "
      "bottom or free");
  EXPECT_EQ(particle_refusal("x_mm,y_mm,z_mm,r_mm,held,fz_N\n0,0,2,2,bottom,0\n0,0,6,2,top,1\n",
                             by_particles),
            "loads on particles and particles glued to the upper platen exclude each other: hold "
            "them with the lower platen");
}

TEST(Specimen, GivesEachPairOfClassesItsLaw)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm,class,held\n"
                                "0,0,2,2,0,bottom\n0,0,6,2,1,free\n0,0,10,2,1,free\n"
                                "0,0,14,2,2,top\n");
  folder.write("bonds.csv", "a,b\n0,1\n1,2\n3,2\n");
  const Settings laws{"Bond law weak/Classes = 1: 1", "Bond law weak/Maxwell stiffness = 1e6 N/m",
                      "Bond law firm/Classes = 1: 0, 2: 2",
                      "Bond law firm/Maxwell stiffness = 9e6 N/m"};
  const dem::Assembly assembly = specimen_in(folder, laws).assembly;
  std::vector<double> stiffness;
  for (const int law : assembly.bonds.law)
    stiffness.push_back(assembly.laws[law].creep.maxwell_stiffness);
  EXPECT_EQ(stiffness, (std::vector<double>{9e6, 1e6, 3.2e6}));

  Settings unknown = laws;
  unknown[0] = "Bond law weak/Classes = 1: 4";
  EXPECT_EQ(refusal(folder, unknown), "Bond law weak/Classes: no particle has class 4");
}

TEST(Specimen, GluesParticlesNearThePlatens)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm\n0,0,2,2\n0,0,6,2\n4,0,2.1,2\n4,0,6,2\n");
  folder.write("bonds.csv", "a,b\n0,1\n2,3\n");
  using dem::Support;
  EXPECT_EQ(specimen_in(folder).assembly.support,
            (std::vector{Support::bottom, Support::top, Support::free, Support::top}));
  EXPECT_EQ(specimen_in(folder, {"Specimen/Platen gap = 0.1"}).assembly.support,
            (std::vector{Support::bottom, Support::top, Support::bottom, Support::top}));
}

TEST(Packing, ComesBackFromItsFileAndOnlyForItsRecipe)
{
  const command::Folder folder;
  Packing packing;
  packing.particles.centre = {{0, 0, 1.0 / 3}, {0, 0, 1}};
  packing.particles.radius = {0.1, 0.2};
  packing.particles.material_class = {0, 2};
  packing.particles.density = 2600;
  packing.platens = {0, 1.25};
  packing.origin = "the test";
  write_packing(folder / "p.h5", packing, "recipe 1");
  EXPECT_EQ(folder.files(), std::vector<std::string>{"p.h5"});
  const Packing again = read_packing(folder / "p.h5", "recipe 1");
  EXPECT_EQ(again.particles.centre, packing.particles.centre);
  EXPECT_EQ(again.particles.radius, packing.particles.radius);
  EXPECT_EQ(again.particles.material_class, packing.particles.material_class);
  EXPECT_EQ(again.particles.density, 2600);
  EXPECT_EQ(again.platens.high, 1.25);
  EXPECT_THROW(read_packing(folder / "p.h5", "recipe 2"), std::invalid_argument);

  dem::Hdf5File newer = dem::Hdf5File::create(folder / "newer.h5");
  newer.set_attribute("", "kind", std::string("packing"));
  newer.set_attribute("", "storage_version", 99);
  newer.publish();
  EXPECT_THROW(read_packing(folder / "newer.h5", std::nullopt), std::invalid_argument);

  const std::string whole = folder.read("p.h5");
  for (const std::size_t length :
       {std::size_t(0), std::size_t(7), std::size_t(100), whole.size() / 2, whole.size() - 1}) {
    folder.write("cut.h5", whole.substr(0, length));
    EXPECT_THROW(read_packing(folder / "cut.h5", std::nullopt), std::invalid_argument) << length;
  }
}
