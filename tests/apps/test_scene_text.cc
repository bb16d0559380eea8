#include "apps/scene_text.h"
#include "tests/apps/command.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

using namespace apps;

namespace {

/// "Section/Key = value @ place" of each entry.
std::vector<std::string> entries(const SceneText& scene)
{
  std::vector<std::string> lines;
  for (const SceneEntry& entry : scene.entries)
    lines.push_back(entry.path() + " = " + entry.value + " @ " + entry.place);
  return lines;
}

std::vector<std::string> messages(const SceneText& scene)
{
  std::vector<std::string> lines;
  for (const Diagnostic& each : scene.diagnostics)
    lines.push_back(each.place + ": " + each.message);
  return lines;
}

SceneText scan(const std::string& text)
{
  return scan_scene(text, "a.scene", ".");
}

using Lines = std::vector<std::string>;

} // namespace

TEST(SceneText, KnowsSectionKeyValueAndLine)
{
  const SceneText scene = scan("# a comment\n"
                               "set Title = Creep at 400 kPa = much # and another\n"
                               "\n"
                               "subsection Loading\n"
                               "\tset\tAxial stress\t=\t400 kPa\t\n"
                               "  set Stress history = 0 s: 1 kPa, \\\n"
                               "     5 s: 2 kPa, \\ # more to come\n"
                               "     6 s: 0 kPa\n"
                               "end\n"
                               "set Empty =\n");
  EXPECT_EQ(entries(scene),
            (Lines{"Title = Creep at 400 kPa = much @ a.scene:2",
                   "Loading/Axial stress = 400 kPa @ a.scene:5",
                   "Loading/Stress history = 0 s: 1 kPa, 5 s: 2 kPa, 6 s: 0 kPa @ a.scene:6",
                   "Empty =  @ a.scene:10"}));
  EXPECT_EQ(messages(scene), Lines{});
}

TEST(SceneText, TakesLineEndsOfOtherSystemsAndNoLastLineEnd)
{
  const SceneText scene =
      scan("set A = 1\r\nsubsection B\r\n  set C = 2 \\\r\n 3\r\nend\r\nset D = 4");
  EXPECT_EQ(entries(scene),
            (Lines{"A = 1 @ a.scene:1", "B/C = 2 3 @ a.scene:3", "D = 4 @ a.scene:6"}));
  EXPECT_EQ(messages(scene), Lines{});
}

TEST(SceneText, SkipsTheMarkBeforeUtf8)
{
  const command::Folder folder;
  folder.write("a.scene", "\xEF\xBB\xBFset Title = ein Würfel\n");
  const SceneText scene = read_scene_text(folder / "a.scene");
  EXPECT_EQ(entries(scene), Lines{"Title = ein Würfel @ " + (folder / "a.scene").string() + ":1"});
}

TEST(SceneText, ReportsEveryLineItDoesNotUnderstand)
{
  const SceneText scene = scan("Axial stress = 400 kPa\n"
                               "set Axial stress 400 kPa\n"
                               "set = 400 kPa\n"
                               "end\n"
                               "include\n"
                               "subsection\n"
                               "subsection A\n"
                               "subsection B\n"
                               "end\n"
                               "set x = 1 \\\n");
  const std::string or_else =
      "' is neither 'set KEY = VALUE', 'subsection NAME', 'end' nor 'include FILE'";
  EXPECT_EQ(messages(scene),
            (Lines{"a.scene:1: 'Axial stress = 400 kPa" + or_else,
                   "a.scene:2: write 'set KEY = VALUE'", "a.scene:3: write 'set KEY = VALUE'",
                   "a.scene:4: 'end' without a 'subsection' to close",
                   "a.scene:5: write 'include FILE'", "a.scene:6: 'subsection" + or_else,
                   "a.scene:10: the file ends in the middle of a continued line",
                   "a.scene:10: 'subsection A' is not closed by 'end'"}));
}

TEST(SceneText, IncludesFilesWhereTheyStand)
{
  const command::Folder folder;
  std::filesystem::create_directory(folder / "parts");
  folder.write("a.scene", "set A = 1\ninclude parts/b.inc\nsubsection S\n"
                          "  include parts/c.inc\n  set Last = 4\nend\n");
  folder.write("parts/b.inc", "subsection B\n  set Key = 2\nend\n");
  folder.write("parts/c.inc", "set Key = 3\n");
  const SceneText scene = read_scene_text(folder / "a.scene");
  const std::string at = (folder / "").string();
  EXPECT_EQ(entries(scene),
            (Lines{"A = 1 @ " + at + "a.scene:1", "B/Key = 2 @ " + at + "parts/b.inc:2",
                   "S/Key = 3 @ " + at + "parts/c.inc:1", "S/Last = 4 @ " + at + "a.scene:5"}));
  EXPECT_EQ(messages(scene), Lines{});
}

TEST(SceneText, KeepsSectionsOfAnIncludedFileInsideIt)
{
  const command::Folder folder;
  folder.write("a.scene", "subsection S\n  include b.inc\nend\n  include c.inc\nset Top = 1\n");
  folder.write("b.inc", "end\n");
  folder.write("c.inc", "subsection Open\n");
  const SceneText scene = read_scene_text(folder / "a.scene");
  const std::string at = (folder / "").string();
  EXPECT_EQ(messages(scene), (Lines{at + "b.inc:1: 'end' without a 'subsection' to close",
                                    at + "c.inc:1: 'subsection Open' is not closed by 'end'"}));
  EXPECT_EQ(entries(scene), Lines{"Top = 1 @ " + at + "a.scene:5"});
}

TEST(SceneText, FindsLoopsOfIncludesAndMissingFiles)
{
  const command::Folder folder;
  folder.write("a.scene", "include b.inc\ninclude none.inc\ninclude .\n");
  folder.write("b.inc", "set Key = 1\ninclude ./a.scene\n");
  const SceneText scene = read_scene_text(folder / "a.scene");
  const std::string at = (folder / "").string();
  EXPECT_EQ(messages(scene),
            (Lines{at + "b.inc:2: 'include ./a.scene': the file includes itself, directly or "
                        "through others",
                   at + "a.scene:2: 'include none.inc': " + at +
                       "none.inc cannot be read: there is no such file, or you may not read it",
                   at + "a.scene:3: 'include .': " + at + ". is a folder, not a file"}));
  EXPECT_EQ(scene.entries.size(), 1u);
}

TEST(SceneText, ReadsOverrides)
{
  const SceneEntry entry = override_entry(" Loading / Axial stress =  500 kPa ");
  EXPECT_EQ(entry.path(), "Loading/Axial stress");
  EXPECT_EQ(entry.value, "500 kPa");
  EXPECT_EQ(entry.place, "--set");
  EXPECT_EQ(override_entry("Bonds/Maxwell viscosity = 8 N s/m").value, "8 N s/m");
  EXPECT_EQ(override_entry("Title =").value, "");
}

TEST(SceneText, RefusesOverridesThatASceneCouldNotHold)
{
  for (const char* text : {"Title", "", "= 3", "Loading/ = 3"})
    EXPECT_THROW(override_entry(text), std::invalid_argument) << text;
  for (const char* text : {"Title = a # b", "Title = a\nset Solver = linear", "Title = a\\"})
    EXPECT_THROW(override_entry(text), std::invalid_argument) << text;
}

TEST(SceneText, RefusesAFileThatCannotBeRead)
{
  const command::Folder folder;
  EXPECT_THROW(read_scene_text(folder / "none.scene"), std::invalid_argument);
  EXPECT_THROW(read_scene_text(folder.path()), std::invalid_argument);
}
