#include "tests/apps/scenes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using namespace apps;
using scenes::errors;
using scenes::errors_of;
using scenes::load;

namespace {

using Lines = std::vector<std::string>;

} // namespace

TEST(Scene, EmptyTextIsTheDefaultScene)
{
  const LoadedScene scene = load("");
  EXPECT_EQ(scene.diagnostics.size(), 0u);
  EXPECT_EQ(scene.scene->solver, SolverChoice::automatic);
  EXPECT_DOUBLE_EQ(scene.scene->specimen.diameter, 0.0602);
  EXPECT_EQ(scene.scene->load.stress, 4e5);
  EXPECT_EQ(scene.scene->temperature.temperature, 293.15);
  EXPECT_EQ(scene.scene->load.strain_limit, 0.1);
  EXPECT_EQ(scene.scene->bonds.maxwell_viscosity, 8.2e8);
  EXPECT_EQ(scene.scene->load.release_time, std::nullopt);
  EXPECT_EQ(scene.scene->output.frequencies.size(), 5u);
}

TEST(Scene, SaysAllThatIsWrongAtOnceWithPlaceKeyAndRange)
{
  const LoadedScene scene = load("set Solver = event\n"
                                 "subsection Specimen\n"
                                 "  set Diameter = -60 mm\n"
                                 "  set Solid fracton = 0.7\n"
                                 "  set Particles = 600.5\n"
                                 "  set Height = 120 kg\n"
                                 "end\n"
                                 "subsection Loadings\n"
                                 "  set Axial stress = 400 kPa\n"
                                 "  set Test = creep\n"
                                 "end\n"
                                 "set Axial stress = 400 kPa\n"
                                 "subsection Loading\n"
                                 "  set True stress = yes\n"
                                 "  set Release time = soon\n"
                                 "  set Stress history = 0 s: 0 kPa, 5 s\n"
                                 "end\n"
                                 "subsection Output\n"
                                 "  set Snapshot times = 1 s, 2 m\n"
                                 "end\n");
  EXPECT_EQ(
      errors(scene),
      (Lines{
          "a.scene:1: Solver = event: 'event' is not one of: auto | linear | events | quasistatic "
          "| dynamic | continuum; "
          "did you mean 'events'?",
          "a.scene:3: Diameter = -60 mm: '-60 mm' is out of range, allowed: > 0 mm",
          "a.scene:4: there is no key 'Solid fracton' in section 'Specimen'; did you mean 'Solid "
          "fraction'?",
          "a.scene:5: Particles = 600.5: '600.5' is not a whole number; expected: a whole "
          "number, >= 1",
          "a.scene:6: Height = 120 kg: 'kg' cannot be converted to mm; expected: in mm, > 0",
          "a.scene:9: there is no section 'Loadings'; did you mean 'Loading'?",
          "a.scene:12: there is no key 'Axial stress'; did you mean 'Loading/Axial stress'?",
          "a.scene:14: True stress = yes: 'yes' is not one of: true | false",
          "a.scene:15: Release time = soon: 'soon' does not begin with a number; expected: in "
          "s, > 0, or 'never'",
          "a.scene:16: Stress history = 0 s: 0 kPa, 5 s: '5 s' is not of the form 'a: b'; "
          "expected: list of pairs 'a: b', in s and in kPa",
          "a.scene:19: Snapshot times = 1 s, 2 m: 'm' cannot be converted to s; expected: list, "
          "each in s, >= 0; or 'none'"}));
}

TEST(Scene, ListsWhatThereIsIfNothingIsNear)
{
  EXPECT_EQ(errors(load("set Km = 1\nsubsection Study\n  set Km = 1\nend\n"
                        "subsection Bond law\n  set Classes = 0: 1\n  set Friction = 1\nend\n"
                        "subsection Nonsense\n  set Km = 1\nend\n")),
            (Lines{"a.scene:6: give it a name: 'subsection Bond law NAME'",
                   "a.scene:1: there is no key 'Km'; keys outside of sections are: Title, Solver, "
                   "Small strain, "
                   "Accept unusual values",
                   "a.scene:3: there is no key 'Km' in section 'Study'; its keys are: Vary, "
                   "Values, Scene files",
                   "a.scene:10: there is no section 'Nonsense'; sections are: Specimen, Bonds, "
                   "Temperature, Strength, Loading, Quasistatic, Dynamic, Output, Study, Volume "
                   "element, Body, Continuum, Volumes, Probes, Expect, "
                   "Repeat"}));
}

TEST(Scene, RefusesAKeyThatIsSetTwiceInAFile)
{
  const std::string text = "set Title = a\nset Solver = events\nset Title = b\n";
  EXPECT_EQ(errors(load(text)), Lines{"a.scene:3: 'Title' is set twice, first at a.scene:1"});
}

TEST(Scene, LetsTheCommandLineAndLaterFilesOverride)
{
  const std::string text = "subsection Loading\n  set Axial stress = 400 kPa\nend\n";
  const LoadedScene scene =
      load(text, {"Loading/Axial stress = 500 kPa", "Loading/Axial stress = 0.6 MPa"});
  EXPECT_EQ(errors(scene), Lines{});
  EXPECT_EQ(scene.scene->load.stress, 6e5);
  EXPECT_EQ(errors(load(text, {"Loading/Axial stres = 1 kPa", "nonsense"})),
            (Lines{"--set: --set \"nonsense\": write \"Section/Key = value\"",
                   "--set: there is no key 'Axial stres' in section 'Loading'; did you mean 'Axial "
                   "stress'?"}));
}

TEST(Scene, NotesNumbersWithoutUnit)
{
  const LoadedScene scene = load("subsection Loading\n"
                                 "  set Axial stress = 400\n"
                                 "  set Stress history = 0 s: 0 kPa, 5: 400 kPa\n"
                                 "end\n"
                                 "subsection Output\n"
                                 "  set Snapshot times = 10\n"
                                 "  set History times = 10\n"
                                 "end\n");
  EXPECT_EQ(scenes::notes(scene),
            (Lines{"a.scene:2: Axial stress = 400: no unit given, taken as kPa",
                   "a.scene:3: Stress history = 0 s: 0 kPa, 5: 400 kPa: no unit given, taken as s "
                   "and kPa",
                   "a.scene:6: Snapshot times = 10: no unit given, taken as s"}));
  EXPECT_EQ(scene.scene->load.stress, 4e5);
}

TEST(Scene, DoesNotMistakeATemperatureForADifference)
{
  EXPECT_EQ(
      errors_of({"Temperature/WLF C2 = 92 degC"}),
      Lines{"--set: WLF C2 = 92 degC: a difference of temperatures is expected, '92 degC' is a "
            "temperature: write K; expected: in K, > 0"});
  EXPECT_EQ(load("", {"Temperature/Temperature = 300 K"}).scene->temperature.temperature, 300);
}

TEST(Scene, ComesBackFromItsPrintedForm)
{
  const LoadedScene first = load(
      "set Title = a = b\n",
      {"Solver = dynamic", "Specimen/Diameter = 2.37 in", "Specimen/Grading = table",
       "Specimen/Grading table = 2 mm: 0 %, 0.4 cm: 33.3 %, 10 mm: 100 %",
       "Bonds/Maxwell viscosity = none", "Bonds/Kelvin stiffness = 1e5 N/m, 3.3 N/mm",
       "Bonds/Kelvin viscosity = 1e6 N s/m, 7 kN s/m", "Temperature/Temperature = 68 degF",
       "Bond law soft/Classes = 0: 1, 1: 1", "Bond law soft/Maxwell stiffness = 1e6",
       "Loading/Test = stress history", "Loading/Stress history = 0 s: 1 psi, 1 min: 0.3 MPa",
       "Loading/Strain limit = 0.07", "Output/Frequencies = none", "Output/Snapshot times = 3 s"});
  ASSERT_EQ(errors(first), Lines{});
  const LoadedScene second = load(first.schema->print(false));
  EXPECT_EQ(errors(second), Lines{});
  EXPECT_EQ(second.schema->print(false), first.schema->print(false));
  const Scene &a = *first.scene, &b = *second.scene;
  EXPECT_EQ(b.title, "a = b");
  EXPECT_EQ(b.solver, SolverChoice::dynamic);
  EXPECT_EQ(b.specimen.diameter, a.specimen.diameter);
  EXPECT_NEAR(b.specimen.diameter, 2.37 * 0.0254, 1e-17);
  EXPECT_EQ(b.specimen.grading_table, a.specimen.grading_table);
  EXPECT_EQ(b.specimen.grading_table.size(), 3u);
  EXPECT_EQ(b.bonds.maxwell_viscosity, std::nullopt);
  EXPECT_EQ(b.bonds.kelvin_stiffness, a.bonds.kelvin_stiffness);
  EXPECT_EQ(b.bonds.kelvin_viscosity, a.bonds.kelvin_viscosity);
  EXPECT_EQ(b.temperature.temperature, a.temperature.temperature);
  EXPECT_EQ(b.more_bonds.at("soft")->class_pairs, a.more_bonds.at("soft")->class_pairs);
  EXPECT_EQ(b.more_bonds.at("soft")->maxwell_stiffness, 1e6);
  EXPECT_EQ(b.load.stress_history, a.load.stress_history);
  EXPECT_EQ(b.load.strain_limit, a.load.strain_limit);
  EXPECT_TRUE(b.output.frequencies.empty());
  EXPECT_EQ(b.output.snapshot_times, std::vector<double>{3});
}

TEST(Scene, CommentedPrintIsASceneToo)
{
  const LoadedScene scene = load("", {"Title = x"});
  const LoadedScene again = load(scene.schema->print(true));
  EXPECT_EQ(errors(again), Lines{});
  EXPECT_EQ(again.schema->print(false), scene.schema->print(false));
}

TEST(Scene, TellsWhichValuesAreEstimates)
{
  EXPECT_EQ(estimated_keys(load("", {"Strength/Distribution = none"})),
            "Maxwell stiffness, Maxwell viscosity, Kelvin stiffness, Kelvin viscosity, Radius "
            "multiplier");
  EXPECT_EQ(estimated_keys(
                load("", {"Strength/Distribution = none", "Bonds/Maxwell stiffness = 1e6 N/m"})),
            "Maxwell viscosity, Kelvin stiffness, Kelvin viscosity, Radius multiplier");
}
