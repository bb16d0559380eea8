#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

// What is wrong with the input is said before anything is computed or written, with exit code 2.

namespace {

using Settings = std::vector<std::string>;

struct BadInput {
  std::string name;
  Settings settings;
  std::string file, content; ///< a file to be written over, and with what
  std::string message;       ///< up to the end of its line
};

/// A verb on two spheres with a bad input: it must say so and leave nothing.
void expect_refused(const std::string& verb, const BadInput& bad)
{
  SCOPED_TRACE(verb + " " + bad.name);
  const command::Folder folder;
  networks::write_pair(folder);
  if (!bad.file.empty())
    folder.write(bad.file, bad.content);
  const std::size_t n_files = folder.files().size();
  const Finished done = mastic(folder, with({verb, "net.scene"}, bad.settings));
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_TRUE(contains(done.output, bad.message + "\n")) << done.output;
  EXPECT_EQ(folder.files().size(), n_files) << "something was written";
}

const std::string head = "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n";

const BadInput cases[] = {
    {"UnknownKey",
     {},
     "net.scene",
     networks::scene + "subsection Loading\n  set Axial stres = 1 kPa\nend\n",
     "net.scene:13: error: there is no key 'Axial stres' in section 'Loading'; did you mean 'Axial "
     "stress'?"},
    {"WrongType",
     {},
     "net.scene",
     networks::scene + "set Solver = fast\n",
     "net.scene:12: error: Solver = fast: 'fast' is not one of: auto | linear | events | "
     "quasistatic | dynamic | continuum"},
    {"OutOfRange",
     {"Dynamic/Local damping = 1"},
     "",
     "",
     "--set: error: Local damping = 1: '1' is out of range, allowed: >= 0 and < 1"},
    {"WrongUnit",
     {"Specimen/Diameter = 16 kN"},
     "",
     "",
     "--set: error: Diameter = 16 kN: 'kN' cannot be converted to mm; expected: in mm, > 0"},
    {"NotANumber",
     {"Bonds/Maxwell stiffness = nan N/m"},
     "",
     "",
     "--set: error: Maxwell stiffness = nan N/m: 'nan N/m' does not begin with a number; expected: "
     "in N/m, > 0"},
    {"NegativeStiffness",
     {"Bonds/Kelvin stiffness = -5e5 N/m"},
     "",
     "",
     "--set: error: Kelvin stiffness = -5e5 N/m: '-5e5 N/m' is out of range, allowed: >= 0 N/m"},
    {"ZeroViscosity",
     {"Bonds/Maxwell viscosity = 0 N s/m"},
     "",
     "",
     "--set: error: Maxwell viscosity = 0 N s/m: '0 N s/m' is out of range, allowed: > 0 N s/m"},
    {"ZeroShearRatio",
     {"Bonds/Normal to shear ratio = 0"},
     "",
     "",
     "--set: error: Normal to shear ratio = 0: '0' is out of range, allowed: > 0"},
    {"NegativeTime",
     {"Loading/End time = -1 s"},
     "",
     "",
     "--set: error: End time = -1 s: '-1 s' is out of range, allowed: >= 0 s"},
    {"ZeroReferenceRate",
     {"Strength/Reference rate = 0 1/s"},
     "",
     "",
     "--set: error: Reference rate = 0 1/s: '0 1/s' is out of range, allowed: > 0 1/s"},
    {"ColdBeyondTheShiftLaw",
     {"Temperature/Shift law = WLF", "Temperature/Temperature = -80 degC"},
     "",
     "",
     "--set: error: Temperature: WLF shift: the temperature must be above 201.15 K (reference - "
     "C2), found 193.15 K"},
    {"SolverThatCannot",
     {"Solver = linear", "Bond law a/Classes = 0: 0", "Bond law a/Maxwell viscosity = none"},
     "",
     "",
     "--set: error: Solver: the bonds follow several laws that are not proportional, so that their "
     "forces depend on history; use dynamic or auto"},
    {"StiffnessInOtherUnits",
     {"Bonds/Maxwell stiffness = 3.2 N/m"},
     "",
     "",
     "--set: error: Maxwell stiffness: 3.2 N/m makes a modulus of about 6.4e+02 Pa, outside 1e5 to "
     "1e12 Pa; if that is meant, set Accept unusual values = true"},
    {"RadiiInOtherUnits",
     {},
     "particles.csv",
     "x_m,y_m,z_m,r_m,held\n0,0,2,2,bottom\n0,0,6,2,top\n",
     "particles.csv:2: a radius of 2 m is outside 1e-6 to 1 m; if that is meant, set Accept "
     "unusual values = true"},
    {"MissingInclude",
     {},
     "net.scene",
     "include none.inc\n" + networks::scene,
     "net.scene:1: error: 'include none.inc': none.inc cannot be read: there is no such file, or "
     "you may not read it"},
    {"MissingParticleFile",
     {"Specimen/File = none.csv"},
     "",
     "",
     "none.csv cannot be read: there is no such file, or you may not read it"},
    {"MissingBondFile",
     {"Specimen/Bond file = none.csv"},
     "",
     "",
     "none.csv cannot be read: there is no such file, or you may not read it"},
    {"MissingColumn",
     {},
     "particles.csv",
     "x_mm,y_mm,r_mm\n0,0,2\n",
     "particles.csv: there is no column 'z' (with its unit, such as z_m)"},
    {"NotANumberInATable",
     {},
     "particles.csv",
     head + "0,0,nan,2,top\n",
     "particles.csv:3: column 'z': 'nan' is not a number"},
    {"NegativeRadius",
     {},
     "particles.csv",
     head + "0,0,6,-2,top\n",
     "particles.csv:3: the radius must be > 0, found -0.002 m"},
    {"CoincidentCentres",
     {},
     "particles.csv",
     head + "0,0,2,2,top\n",
     "particles.csv:3: the sphere overlaps the one at particles.csv:2 by more than a tenth "
     "of the smaller radius; if that is meant, set Accept unusual values = true"},
    {"BondToNobody",
     {},
     "bonds.csv",
     "a,b\n0,2\n",
     "bonds.csv: bond 0 between particles 0 and 2: there are particles 0 to 1 only"},
    {"BondTwice",
     {},
     "bonds.csv",
     "a,b\n0,1\n1,0\n",
     "bonds.csv: bond 1 between particles 1 and 0: this pair is already bonded"},
    {"BondOverAWideGap",
     {},
     "particles.csv",
     head + "0,0,30,2,top\n",
     "bonds.csv:2: the spheres 0 and 1 are 24 mm apart, more than 5 times the smaller radius; if "
     "that "
     "is meant, set Accept unusual values = true"},
    {"BondToItself",
     {},
     "bonds.csv",
     "a,b\n1,1\n",
     "bonds.csv: bond 0 between particles 1 and 1: a particle cannot be bonded to itself"},
    {"NothingHolds",
     {},
     "bonds.csv",
     "a,b\n",
     "the specimen cannot carry the load: no chain of bonds connects the platens any more (2 "
     "particles, 0 bonds, 1 particles glued to the lower platen, 1 to the upper one)"},
    {"PackingThatIsText",
     {"Specimen/File = p.h5"},
     "p.h5",
     "no packing",
     "p.h5: this is not an HDF5 file, or it is damaged"},
};

} // namespace

TEST(BadInput, IsRefusedBeforeAnythingIsWritten)
{
  for (const BadInput& bad : cases)
    expect_refused("run", bad);
}

TEST(BadInput, IsFoundByCheckAsWell)
{
  for (const BadInput& bad : cases)
    if (bad.name == "UnknownKey" || bad.name == "ColdBeyondTheShiftLaw" ||
        bad.name == "SolverThatCannot" || bad.name == "BondTwice" || bad.name == "NothingHolds")
      expect_refused("check", bad);
}

TEST(BadInput, IsToldInFullBeforeTheFirstStep)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("net.scene", networks::scene + "set Solver = fast\nset Titel = x\n");
  const Finished run = mastic(folder, with({"run", "net.scene"}, {"Loading/End time = soon"}));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(
      run.output,
      "net.scene:12: error: Solver = fast: 'fast' is not one of: auto | linear | events | "
      "quasistatic | "
      "dynamic | continuum\n"
      "net.scene:13: error: there is no key 'Titel'; did you mean 'Title'?\n"
      "--set: error: End time = soon: 'soon' does not begin with a number; expected: in s, >= "
      "0\n");
}
