#include "tests/apps/scenes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using scenes::errors_of;

namespace {

using Lines = std::vector<std::string>;

struct Refused {
  Lines settings;
  std::string message;
};

} // namespace

TEST(SceneCheck, RefusesKeysThatDoNotGoTogether)
{
  const Refused cases[] = {
      {{"Specimen/Source = file"}, "Specimen/File (not set): Source = file needs a File"},
      {{"Specimen/Bond file = b.csv"}, "--set: Bond file: a list of bonds needs Source = file"},
      {{"Specimen/Grading = sma11"},
       "--set: Grading: no grading is called 'sma11'; known: sma10, sma10-uniform, sma10-gap, "
       "table"},
      {{"Specimen/Grading table = 2 mm: 0 %, 4 mm: 100 %"},
       "--set: Grading table: is used with Grading = table only"},
      {{"Bonds/Kelvin stiffness = 1e5 N/m, 2e5 N/m"},
       "Bonds/Kelvin viscosity (not set): there are 2 Kelvin stiffnesses and 1 viscosities; give "
       "one of each per branch"},
      {{"Loading/Test = constant rate", "Loading/Strain rate = 0 1/s"},
       "--set: Strain rate: a constant rate of 0 leads nowhere"},
      {{"Loading/Test = constant rate", "Loading/End strain = none"},
       "--set: End strain: constant rate needs an End strain"},
      {{"Loading/Release time = 2000 s"}, "--set: Release time: must come before the End time"},
      {{"Loading/Test = particle loads"},
       "--set: Test: particle loads come from a particle file: Source = file"},
      {{"Loading/Test = constant rate", "Loading/True stress = true"},
       "--set: True stress: goes with tests at prescribed stress only"},
      {{"Loading/Test = stress history"},
       "Loading/Stress history (not set): loading: at least two points in time are needed"},
      {{"Loading/Test = strain history", "Loading/Strain history = 0 s: 0 %, 5 s: 1 %, 4 s: 2 %"},
       "--set: Strain history: loading: times must not decrease and not be negative; point 3 is at "
       "4 s"},
      {{"Loading/Test = sine", "Loading/Stress amplitude = 0 kPa"},
       "--set: Stress amplitude: pulses of 0 lead nowhere"},
      {{"Loading/Test = haversine", "Loading/Peak stress = 0 kPa"},
       "--set: Peak stress: pulses of 0 lead nowhere"},
      {{"Loading/Test = haversine", "Loading/Points per pulse = 18"},
       "--set: Points per pulse: must be a multiple of 4"},
      {{"Loading/Test = block pulses", "Loading/Rest time = 0 s"},
       "--set: Rest time: block pulses without a rest are one pulse"},
      {{"Loading/Test = sine", "Loading/Cycles = 1000000"},
       "--set: Cycles: 1000000 cycles of 16 points make 1.6e+07 points in time, more than 1e+07"},
      {{"Solver = events", "Loading/Confining stress = 100 kPa"},
       "--set: Solver: takes no Confining stress; use quasistatic"},
      {{"Solver = dynamic", "Temperature/Shift law = WLF",
        "Temperature/Temperature history = 0 s: 20 degC, 60 s: 30 degC"},
       "--set: Solver: takes no Temperature history; use quasistatic"},
      {{"Temperature/Temperature history = 0 s: 20 degC, 60 s: 30 degC"},
       "--set: Temperature history: without a Shift law the temperature has no effect"},
      {{"Temperature/Shift law = WLF", "Temperature/Temperature = 20 degC",
        "Temperature/Temperature history = 0 s: 20 degC, 60 s: 30 degC"},
       "--set: Temperature: give either Temperature or Temperature history"},
      {{"Temperature/Shift law = WLF",
        "Temperature/Temperature history = 10 s: 20 degC, 6 s: 30 degC"},
       "--set: Temperature history: times must not decrease and not be "
       "negative; point 2 is at 6 s"},
      {{"Temperature/Shift law = WLF",
        "Temperature/Temperature history = 0 s: 20 degC, 6 s: -80 degC"},
       "--set: Temperature history: WLF shift: the temperature must be above 201.15 K (reference - "
       "C2), found 193.15 K"},
      {{"Solver = linear", "Loading/True stress = true"},
       "--set: Solver: linear takes nominal stress only; use events"},
      {{"Solver = events", "Bonds/After breakage = friction"},
       "--set: After breakage: friction needs the solver dynamic"},
      {{"Study/Vary = Loading/Axial stress"}, "--set: Vary: a study needs both Vary and Values"},
      {{"Study/Vary = Output/Folder", "Study/Values = a, b"},
       "--set: Vary: 'Output/Folder' cannot be varied"},
      {{"Study/Vary = Study/Values", "Study/Values = a, b"},
       "--set: Vary: 'Study/Values' cannot be varied"},
      {{"Study/Vary = Loading/Axial stress", "Study/Values = 1 kPa,, 2 kPa"},
       "--set: Values: there is nothing between two separators"},
      {{"Study/Vary = Loading/Axial stress", "Study/Values = 1 kPa, 2 kPa, 1 kPa"},
       "--set: Values: '1 kPa' comes twice"}};
  for (const Refused& each : cases)
    EXPECT_EQ(errors_of(each.settings), Lines{each.message}) << each.message;
}

TEST(SceneCheck, RefusesBondLawsThatCannotBe)
{
  const Refused cases[] = {
      {{"Bond law a/Maxwell stiffness = 1e6 N/m"},
       "Bond law a/Classes (not set): say for which pairs of classes the law is, such as '0: 1'"},
      {{"Bond law a/Classes = 0: 0.5"}, "--set: Classes: '0: 0.5' are not whole numbers"},
      {{"Bond law a/Classes = 0: 1", "Bond law b/Classes = 1: 0"},
       "--set: Classes: the pair 1: 0 has a law already, 'Bond law a'"},
      {{"Solver = events", "Bond law a/Classes = 0: 1", "Bond law a/Kelvin viscosity = 1e3 N s/m"},
       "--set: Solver: the bonds follow several laws that are not proportional, so that their "
       "forces depend on history; use dynamic or auto"},
      {{"Solver = linear", "Bond law a/Classes = 0: 1", "Bond law a/Maxwell viscosity = none"},
       "--set: Solver: the bonds follow several laws that are not proportional, so that their "
       "forces depend on history; use dynamic or auto"}};
  for (const Refused& each : cases)
    EXPECT_EQ(errors_of(each.settings), Lines{each.message}) << each.message;
}

TEST(SceneCheck, RefusesUnusualValuesUnlessTheyAreMeant)
{
  const Refused cases[] = {
      {{"Bonds/Maxwell stiffness = 3.2 N/m"},
       "--set: Maxwell stiffness: 3.2 N/m makes a modulus of about 6.4e+02 Pa, outside 1e5 to 1e12 "
       "Pa; if that is meant, set Accept unusual values = true"},
      {{"Bonds/Maxwell stiffness = 3.2e10 N/m"},
       "--set: Maxwell stiffness: 3.2e+10 N/m makes a modulus of about 6.4e+12 Pa, outside 1e5 to "
       "1e12 Pa; if that is meant, set Accept unusual values = true"},
      {{"Specimen/Density = 2.7 kg/m^3"},
       "--set: Density: 2.7 kg/m^3 is outside 500 to 10000; if that is meant, set Accept unusual "
       "values = true"},
      {{"Specimen/Density = 2700 g/cm^3"},
       "--set: Density: 2.7e+06 kg/m^3 is outside 500 to 10000; if that is meant, set Accept "
       "unusual values = true"}};
  for (const Refused& each : cases) {
    EXPECT_EQ(errors_of(each.settings), Lines{each.message});
    Lines meant = each.settings;
    meant.push_back("Accept unusual values = true");
    EXPECT_EQ(errors_of(meant), Lines{}) << each.message;
  }
}

TEST(SceneCheck, WarnsOfWideBondsAndVanishingStrength)
{
  EXPECT_EQ(scenes::warnings(scenes::load("", {"Bonds/Radius multiplier = 1.5"})),
            Lines{"--set: Radius multiplier: a multiplier above 1 makes the bond wider than the "
                  "smaller sphere"});
  EXPECT_EQ(scenes::warnings(
                scenes::load("", {"Strength/Rate floor = 0 1/s", "Strength/Rate window = 0 s",
                                  "Strength/Rate window fraction = 0"})),
            Lines{"--set: Rate floor: without window and floor the strength falls to 0 as the "
                  "strain rate does"});
}

TEST(SceneCheck, WarnsOfRatesAveragedOverPartsOfCycles)
{
  const auto warned = [](const Lines& more) {
    Lines settings{"Loading/Test = haversine", "Strength/Rate window fraction = 0"};
    settings.insert(settings.end(), more.begin(), more.end());
    return scenes::warnings(scenes::load("", settings)).size();
  };
  EXPECT_EQ(warned({}), 0u);
  EXPECT_EQ(warned({"Strength/Rate window = 2 s"}), 0u);
  EXPECT_EQ(warned({"Strength/Rate window = 0.1 s"}), 1u);
  EXPECT_EQ(warned({"Loading/Rest time = 0.5 s"}), 1u);
  EXPECT_EQ(warned({"Strength/Rate window fraction = 0.01"}), 1u);
  EXPECT_EQ(warned({"Strength/Rate window = 0.1 s", "Strength/Distribution = none"}), 0u);
}

TEST(SceneCheck, WithoutPresetTheUncertainKeysMustBeSet)
{
  const Lines found = errors_of({"Bonds/Preset = none", "Strength/Distribution = Weibull",
                                 "Strength/Scale = 60 N", "Bonds/Kelvin stiffness = 1e5 N/m"});
  EXPECT_EQ(found, (Lines{"Bonds/Maxwell stiffness (not set): Preset = none: 'Bonds/Maxwell "
                          "stiffness' must be set",
                          "Bonds/Maxwell viscosity (not set): Preset = none: 'Bonds/Maxwell "
                          "viscosity' must be set",
                          "Bonds/Kelvin viscosity (not set): Preset = none: 'Bonds/Kelvin "
                          "viscosity' must be set",
                          "Strength/Modulus (not set): Preset = none: 'Strength/Modulus' must be "
                          "set"}));
}
