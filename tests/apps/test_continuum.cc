#include "fem/creep_compliance.h"
#include "fem/law_file.h"
#include "tests/apps/body_runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

using apps::Finished;
using body_runs::column;
using body_runs::on_two_ranks;
using command::contains;
using command::mastic;
using command::with;

namespace {

/// Burgers in tension, with a Poisson's ratio that does not change.
fem::LawRecord proportional()
{
  fem::LawRecord record;
  record.law = fem::isotropic_law(fem::burgers_compliance(3e8, 6e10, 2e8, 4e9), 0.35);
  record.first_time = 1e-3;
  record.last_time = 1e4;
  return record;
}

const std::string scene = R"(set Solver = continuum
subsection Specimen
  set Diameter = 60 mm
  set Height = 120 mm
end
subsection Body
  set Cell size = 30 mm
  set Law = material.law
end
subsection Loading
  set Axial stress = 400 kPa
  set End time = 200 s
end
subsection Continuum
  set Order = 1
end
subsection Output
  set Plots = false
  set ParaView = false
  set History times = 12
  set Frequencies = none
end
)";

/// A law whose shear creeps and whose volume does not: stresses redistribute.
std::string redistributing()
{
  return apps::read_text_file(std::string(MASTIC_SOURCE_DIR) +
                              "/scenes/continuum/burgers-in-shear.law");
}

void write_scene(const command::Folder& folder, const std::string& law)
{
  folder.write("creep.scene", scene);
  folder.write("material.law", law);
}

void expect_same_history(const command::Folder& a, const std::string& folder_a,
                         const command::Folder& b, const std::string& folder_b, double tolerance)
{
  for (const auto& [name, unit] :
       {std::pair("time", "s"), {"axial_stress", "Pa"}, {"axial_strain", "1"}}) {
    const auto x = column(a, folder_a + "/history.csv", name, unit);
    const auto y = column(b, folder_b + "/history.csv", name, unit);
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t k = 0; k < x.size(); ++k)
      EXPECT_NEAR(x[k], y[k], tolerance * std::abs(x.back())) << name << ' ' << k;
  }
}

std::size_t times_in(const std::string& text, const std::string& part)
{
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++n;
  return n;
}

} // namespace

TEST(Continuum, ThickCylinderMeetsTheClosedForm)
{
  const command::Folder folder;
  const std::string file =
      std::string(MASTIC_SOURCE_DIR) + "/scenes/continuum/thick-cylinder.scene";
  const Finished done = mastic(folder, with({"run", file, "--quiet"}, {"Output/Plots = false"}));
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "expectations: 4 of 4 met")) << done.output;
  EXPECT_TRUE(folder.has("results/thick-cylinder/paraview/body.pvd"));
  EXPECT_TRUE(folder.has("results/thick-cylinder/paraview/body_0003.vtu"));
  const auto radial = column(folder, "results/thick-cylinder/probes.csv", "ux", "m");
  EXPECT_NEAR(radial[0], 7.05128205128205e-3, 1e-4 * radial[0]);
  EXPECT_NEAR(radial[10], 4.10256410256410e-3, 1e-4 * radial[10]);
  EXPECT_EQ(mastic(folder, {"export", "results/thick-cylinder", "probes"}).exit_code, 0);
  EXPECT_TRUE(contains(mastic(folder, {"info", "results/thick-cylinder"}).output, "unknowns"));
}

TEST(Continuum, BetweenFrictionlessPlatensItCreepsAsTheLawSays)
{
  const command::Folder folder;
  write_scene(folder, fem::law_text(proportional()));
  const Finished done =
      mastic(folder, with({"run", "creep.scene", "--quiet"},
                          {"Body/Platens = frictionless", "Output/Frequencies = 0.01 Hz, 1 Hz"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const fem::CreepCompliance uniaxial = fem::burgers_compliance(3e8, 6e10, 2e8, 4e9);
  const auto time = column(folder, "results/creep/history.csv", "time", "s");
  const auto strain = column(folder, "results/creep/history.csv", "axial_strain", "1");
  for (std::size_t k = 0; k < time.size(); ++k)
    EXPECT_NEAR(strain[k], 4e5 * fem::value(uniaxial, time[k]), 1e-7 * strain.back()) << time[k];
  const auto modulus = column(folder, "results/creep/complex_modulus.csv", "complex_modulus", "Pa");
  const auto frequency = column(folder, "results/creep/complex_modulus.csv", "frequency", "Hz");
  for (std::size_t k = 0; k < 2; ++k) {
    const double exact =
        std::abs(fem::complex_modulus(uniaxial, 2 * std::numbers::pi * frequency[k]));
    EXPECT_NEAR(modulus[k], exact, 1e-6 * exact);
  }
}

TEST(Continuum, HistoryHasTheColumnsOfTheSpecimenOfParticles)
{
  const command::Folder folder;
  write_scene(folder, fem::law_text(proportional()));
  networks::write_lattice(folder);
  folder.write("lattice.scene", networks::scene);
  ASSERT_EQ(mastic(folder, {"run", "creep.scene", "--quiet"}).exit_code, 0);
  const Finished particles =
      mastic(folder, with({"run", "lattice.scene", "--quiet"}, {"Output/Plots = false"}));
  ASSERT_TRUE(folder.has("results/lattice/history.csv")) << particles.output;
  const auto header = [&](const std::string& name) {
    const std::string text = folder.read("results/" + name + "/history.csv");
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(header("creep"), header("lattice"));
}

TEST(Continuum, TwoRanksGiveTheSameHistory)
{
  const command::Folder one, two;
  for (const command::Folder* folder : {&one, &two})
    write_scene(*folder, redistributing());
  const std::vector<std::string> run =
      with({"run", "creep.scene", "--quiet"}, {"Output/Frequencies = 0.1 Hz"});
  ASSERT_EQ(mastic(one, run).exit_code, 0);
  const Finished done = on_two_ranks(two, run);
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_EQ(times_in(done.output, "results in"), 1u) << done.output;
  expect_same_history(one, "results/creep", two, "results/creep", 1e-7);
  const auto a = column(one, "results/creep/complex_modulus.csv", "phase_angle", "rad");
  const auto b = column(two, "results/creep/complex_modulus.csv", "phase_angle", "rad");
  EXPECT_NEAR(a[0], b[0], 1e-7);
}

TEST(Continuum, GoesOnAfterAnInterruptionOnAnotherNumberOfRanks)
{
  const command::Folder whole, parts;
  for (const command::Folder* folder : {&whole, &parts})
    write_scene(*folder, redistributing());
  const std::vector<std::string> settings{
      "Loading/Test = constant rate",      "Loading/Strain rate = 1e-4 1/s",
      "Loading/End strain = 1 %",          "Continuum/Step tolerance = 1e-9",
      "Continuum/Refinement times = 20 s", "Probes/Points = 0 mm, 0 mm, 60 mm"};
  ASSERT_EQ(mastic(whole, with({"run", "creep.scene", "--quiet"}, settings)).exit_code, 0);
  std::vector<std::string> slow = settings;
  slow.push_back(interrupted::slow);
  const Finished stopped =
      interrupted::stopped(parts, with({"run", "creep.scene", "--quiet"}, slow),
                           "results/creep/checkpoint.h5", 30, SIGTERM);
  ASSERT_EQ(stopped.exit_code, 4) << stopped.output;
  EXPECT_TRUE(contains(stopped.output, "to go on: mastic run --resume")) << stopped.output;
  const Finished resumed =
      on_two_ranks(parts, with({"run", "--resume", "results/creep"}, {interrupted::quick}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_FALSE(parts.has("results/creep/checkpoint.h5"));
  expect_same_history(whole, "results/creep", parts, "results/creep", 1e-7);
  const auto a = column(whole, "results/creep/probes.csv", "stress_zz", "Pa");
  const auto b = column(parts, "results/creep/probes.csv", "stress_zz", "Pa");
  ASSERT_EQ(a.size(), b.size());
  EXPECT_NEAR(a.back(), b.back(), 1e-6 * std::abs(a.back()));
}

TEST(Continuum, PulsesGiveATableOfCycles)
{
  const command::Folder folder;
  write_scene(folder, fem::law_text(proportional()));
  const Finished done = mastic(folder, with({"run", "creep.scene", "--quiet"},
                                            {"Loading/Test = haversine", "Loading/Cycles = 5"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const std::string cycles = folder.read("results/creep/cycles.csv");
  EXPECT_EQ(times_in(cycles, "\n"), 6u) << cycles;
}

TEST(Continuum, StudyComparesCellsAndStepsWhateverTheSceneExpects)
{
  const command::Folder folder;
  write_scene(folder, redistributing());
  const Finished done = mastic(
      folder, with({"study", "creep.scene", "--quiet"},
                   {"Expect/Values = axial_strain_percent at 0 s: 1", "Body/Cell size = 40 mm"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "reference: continuum, finest cell size in mm 20"))
      << done.output;
  EXPECT_FALSE(contains(done.output, "failed")) << done.output;
  EXPECT_TRUE(contains(done.output, "within 10 %: continuum")) << done.output;
}

TEST(Continuum, OtherUnitsChangeNothing)
{
  const command::Folder one, two;
  for (const command::Folder* folder : {&one, &two})
    write_scene(*folder, redistributing());
  ASSERT_EQ(mastic(one, {"run", "creep.scene", "--quiet"}).exit_code, 0);
  ASSERT_EQ(mastic(two, with({"run", "creep.scene", "--quiet"},
                             {"Specimen/Diameter = 6 cm", "Specimen/Height = 0.12 m",
                              "Body/Cell size = 3 cm", "Loading/Axial stress = 0.4 MPa",
                              "Loading/End time = 3.3333333333333333 min"}))
                .exit_code,
            0);
  expect_same_history(one, "results/creep", two, "results/creep", 1e-8);
}

TEST(Continuum, BadInputIsOneClearErrorOnAllRanks)
{
  struct Case {
    std::string setting, message;
  };
  const command::Folder folder;
  write_scene(folder, fem::law_text(proportional()));
  std::string indefinite = fem::law_text(proportional());
  const std::size_t first = indefinite.find("S_0 [1/Pa] =\n  ") + 15;
  indefinite.insert(first, "-");
  folder.write("indefinite.law", indefinite);
  folder.write("broken.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\nnothing\n");
  folder.write("folded.msh",
               "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 "
               "0\n5 0 0 1\n6 1 0 1\n7 0.1 0.1 -0.5\n8 0 1 1\n$EndNodes\n$Elements\n1\n1 5 2 1 1 "
               "1 2 3 4 5 6 7 8\n$EndElements\n");
  const Case cases[] = {
      {"Boundary tp/Pressure = 1 kPa", "the body has no boundary 'tp'; did you mean 'top'?"},
      {"Body/Law = indefinite.law", "indefinite.law:"},
      {"Body/Law = missing.law", "missing.law cannot be read"},
      {"Loading/End time = 1e6 s", "the law was seen up to 1e+04 s only"},
      {"Temperature/Temperature = 30 degC", "names no temperature shift"},
      {"Body/Shape = file", "Shape = file needs a Mesh file"},
      {"Body/Mesh file = broken.msh", "broken.msh: not a mesh"},
      {"Body/Mesh file = folded.msh", "is inverted or folded"},
      {"Body/Edges = 1 mm, 2 mm", "three lengths are needed, found 2"},
      {"Continuum/Refinement times = 5 s", "adaptive refinement needs hexahedra"}};
  for (const Case& each : cases) {
    std::vector<std::string> settings{each.setting};
    if (contains(each.setting, "Mesh file"))
      settings.push_back("Body/Shape = file");
    if (contains(each.setting, "Edges"))
      settings.push_back("Body/Shape = box");
    if (contains(each.setting, "Refinement"))
      settings.push_back("Body/Cells = tetrahedra");
    const Finished done = mastic(folder, with({"run", "creep.scene"}, settings));
    EXPECT_EQ(done.exit_code, 2) << each.setting << '\n' << done.output;
    EXPECT_TRUE(contains(done.output, each.message)) << each.setting << '\n' << done.output;
    EXPECT_EQ(times_in(done.output, "error:"), 1u) << done.output;
    EXPECT_FALSE(folder.has("results"));
    const Finished checked = mastic(folder, with({"check", "creep.scene"}, settings));
    EXPECT_EQ(checked.exit_code, 2) << each.setting << '\n' << checked.output;
  }
  const Finished both =
      on_two_ranks(folder, with({"run", "creep.scene"}, {"Body/Law = indefinite.law"}));
  EXPECT_NE(both.exit_code, 0);
  EXPECT_EQ(times_in(both.output, "error:"), 1u) << both.output;
}

TEST(Continuum, ParticlesAreNotSharedOutOverRanks)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  folder.write("lattice.scene", networks::scene);
  const Finished done = on_two_ranks(folder, {"run", "lattice.scene"});
  EXPECT_NE(done.exit_code, 0);
  EXPECT_TRUE(contains(done.output, "mpirun is for Solver = continuum")) << done.output;
}

TEST(Point, CreepOfAPointIsThatOfTheLaw)
{
  const command::Folder folder;
  folder.write("material.law", fem::law_text(proportional()));
  folder.write("history.csv", "time_s,stress_zz_kPa\n0,-400\n10,-400\n10,0\n30,0\n");
  const Finished done = mastic(folder, {"point", "material.law", "history.csv", "-o", "out.csv"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const fem::CreepCompliance uniaxial = fem::burgers_compliance(3e8, 6e10, 2e8, 4e9);
  const auto strain = column(folder, "out.csv", "strain_zz", "1");
  EXPECT_NEAR(strain[1], -4e5 * fem::value(uniaxial, 10), 1e-12);
  EXPECT_NEAR(strain[3], -4e5 * (fem::value(uniaxial, 30) - fem::value(uniaxial, 20)), 1e-12);
  folder.write("both.csv", "time_s,stress_zz_kPa,strain_zz_percent\n0,1,1\n");
  const Finished refused = mastic(folder, {"point", "material.law", "both.csv"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(contains(refused.output, "not both")) << refused.output;
}
