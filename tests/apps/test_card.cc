#include "tests/apps/command.h"
#include "tests/fem/tables.h"

#include "fem/law_file.h"

#include <gtest/gtest.h>

using apps::Finished;
using command::contains;
using command::mastic;

namespace {

std::string law_file()
{
  fem::LawRecord record;
  record.law = tables::anisotropic_law();
  record.first_time = 0.1;
  record.last_time = 1000;
  return fem::law_text(record);
}

} // namespace

TEST(CardVerb, WritesCardDeckAndNoteAndPrintsWhatIsLost)
{
  const command::Folder folder;
  folder.write("mix.law", law_file());
  const Finished done = mastic(
      folder, {"card", "mix.law", "--format", "abaqus", "--output", "cards", "--units", "mm"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "The format is isotropic")) << done.output;
  EXPECT_TRUE(contains(folder.read("cards/mastic_abaqus.inp"), "*VISCOELASTIC, TIME=PRONY"));
  EXPECT_TRUE(contains(folder.read("cards/mastic_abaqus.inp"), "mm, t, s, N, MPa, K"));
  EXPECT_TRUE(folder.has("cards/mastic_abaqus_check.inp"));
  EXPECT_TRUE(contains(folder.read("cards/note.txt"), "Largest error of D(t)"));
  EXPECT_EQ(mastic(folder, {"card", "mix.law", "--format", "mfront"}).exit_code, 0);
  EXPECT_TRUE(folder.has("mix-mfront/MasticCreep.mfront"));
}

TEST(CardVerb, WritesTheBondLawOfASceneForPfc)
{
  const command::Folder folder;
  folder.write("creep.scene", mastic(folder, {"new", "creep"}).output);
  const Finished done = mastic(folder, {"card", "creep.scene", "--format", "pfc", "-o", "cards"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(folder.read("cards/mastic_pfc.dat"), "bur_knk "));
}

TEST(CardVerb, RefusesWithTheNearestName)
{
  const command::Folder folder;
  folder.write("mix.law", law_file());
  const auto refusal = [&](const std::vector<std::string>& arguments) {
    const Finished done = mastic(folder, arguments);
    EXPECT_EQ(done.exit_code, 2);
    return done.output;
  };
  EXPECT_EQ(refusal({"card", "mix.law", "--format", "abacus"}),
            "error: there is no format 'abacus'; formats: abaqus, ansys, ls-dyna, mfront, moose, "
            "tables, pfc; did you mean 'abaqus'?\n");
  EXPECT_EQ(refusal({"card", "mix.law", "--format", "abaqus", "--units", "inch"}),
            "error: there are no units 'inch': say si (m, kg, s, Pa) or mm (mm, t, s, MPa)\n");
  EXPECT_EQ(refusal({"card", "none.law", "--format", "abaqus"}),
            "error: none.law: there is no such file\n");
  folder.write("bad.law", "no law");
  EXPECT_TRUE(contains(refusal({"card", "bad.law", "--format", "abaqus"}), "bad.law:1: "));
}
