#include "tests/coupling/card_reading.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

using namespace coupling;

/// Decks run by the programs themselves; skipped where a program is not installed.
namespace {

bool installed(const std::string& program)
{
  return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
}

/// Writes the files of a card into a new folder and runs a command of the shell there; what it
/// prints is in `out`.
std::filesystem::path run(const MaterialCard& card, const std::string& command)
{
  std::string name = (std::filesystem::temp_directory_path() / "mastic-card-XXXXXX").string();
  if (!::mkdtemp(name.data()))
    throw std::runtime_error("no folder for the test");
  for (const CardFile& file : card.files)
    std::ofstream(std::filesystem::path(name) / file.name) << file.text;
  EXPECT_EQ(std::system(("cd " + name + " && (" + command + ") > out 2>&1").c_str()), 0) << name;
  return name;
}

std::string read(const std::filesystem::path& file)
{
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

} // namespace

/// CalculiX reads Abaqus decks but passes over *VISCOELASTIC: its answer is the instantaneous one.
TEST(CalculiX, ReadsTheAbaqusDeckAndGivesItsInstantaneousStrain)
{
  if (!installed("ccx"))
    GTEST_SKIP() << "ccx is not installed";
  const fem::LawRecord record = cards::isotropic_record(false);
  for (const CardUnits& units : {si_units(), millimetre_units()}) {
    const MaterialCard card = material_card(record, CardFormat::abaqus, units);
    const auto folder = run(card, "timeout 60 ccx mastic_abaqus_check");
    EXPECT_EQ(read(folder / "out").find("*ERROR"), std::string::npos);
    const auto lines = cards::lines_of(read(folder / "mastic_abaqus_check.dat"));
    std::vector<double> row; // node and displacements of node 7, moved along all three axes
    for (const std::string& line : lines)
      if (line.starts_with("         7 "))
        row = cards::numbers(line);
    ASSERT_EQ(row.size(), 4U);
    const fem::Mat6 strain = 1e5 * record.law.instantaneous;
    EXPECT_NEAR(row[1] / strain(0, 0), 1, 1e-5);
    EXPECT_NEAR(row[2] / strain(1, 0), 1, 1e-5);
    EXPECT_NEAR(row[3] / strain(2, 0), 1, 1e-5);
    std::filesystem::remove_all(folder);
  }
}

TEST(MTest, FindsTheClosedFormInTheMFrontBehaviour)
{
  if (!installed("mfront") || !installed("mtest"))
    GTEST_SKIP() << "MFront is not installed";
  for (const fem::LawRecord& record :
       {cards::isotropic_record(true), cards::anisotropic_record()}) {
    const MaterialCard card = material_card(record, CardFormat::mfront, si_units());
    const auto folder = run(card, "mfront --obuild --interface=generic MasticCreep.mfront && mtest "
                                  "mastic_mfront_check.mtest");
    EXPECT_NE(read(folder / "out").find("SUCCESS"), std::string::npos);
    std::filesystem::remove_all(folder);
  }
}
