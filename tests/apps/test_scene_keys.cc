#include "apps/text.h"
#include "tests/apps/scenes.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

using namespace apps;

// Every key that the program declares, as it describes it itself in a commented scene: a key added
// later is tested as well.

namespace {

struct Described {
  std::string path, key;
  std::string range; ///< "in mm, > 0"
};

/// The range "[...; default: ...]" at the end of a comment.
std::string range_in(const std::string& comment)
{
  const std::size_t begin = comment.rfind('[');
  return comment.substr(begin + 1, comment.rfind("; default: ") - begin - 1);
}

std::vector<Described> described_keys()
{
  const LoadedScene scene = scenes::load("", {"Bond law x/Classes = 0: 0"});
  std::istringstream stream(scene.schema->print(true));
  std::vector<Described> keys;
  std::string section, comment;
  for (std::string line; std::getline(stream, line);) {
    line = trimmed(line);
    if (line.starts_with("# "))
      comment += line.substr(2) + " ";
    else if (line.starts_with("subsection "))
      section = line.substr(11) + "/";
    else if (line == "end")
      section.clear();
    else if (line.starts_with("set ")) {
      const std::string key = trimmed(line.substr(4, line.find('=') - 4));
      keys.push_back({section + key, key, range_in(comment)});
    }
    if (!line.starts_with("# "))
      comment.clear();
  }
  return keys;
}

/// The unit of a key, or of the first number of pairs; nothing for plain numbers and words.
std::optional<std::string> unit_of(const Described& key)
{
  std::smatch found;
  if (std::regex_search(key.range, found, std::regex("\\bin ((N s/m)|[^ ,;\\]]+)")))
    return found[1].str();
  return std::nullopt;
}

bool is_number(const Described& key)
{
  return key.range.starts_with("a number") || key.range.starts_with("a whole number");
}

bool is_pairs(const Described& key)
{
  return key.range.starts_with("list of pairs");
}

/// Numbers just outside what a range allows.
std::vector<double> outside(const std::string& range)
{
  std::vector<double> values;
  std::smatch found;
  const std::string number = "(-?[0-9.e+]+)";
  if (std::regex_search(range, found, std::regex(number + " to " + number)))
    return {std::stod(found[1]) - 1, std::stod(found[2]) + 1};
  if (std::regex_search(range, found, std::regex("> " + number)))
    values.push_back(std::stod(found[1]));
  if (std::regex_search(range, found, std::regex(">= " + number)))
    values.push_back(std::stod(found[1]) - 1);
  if (std::regex_search(range, found, std::regex("< " + number)))
    values.push_back(std::stod(found[1]));
  if (std::regex_search(range, found, std::regex("<= " + number)))
    values.push_back(std::stod(found[1]) + 1);
  return values;
}

/// Sets one key to a text; checks that there is one error about it and that it names the key.
void expect_refused(const Described& key, const std::string& value, const std::string& reason)
{
  const std::vector<std::string> found = scenes::errors_of({key.path + " = " + value});
  ASSERT_EQ(found.size(), 1u) << key.path << " = " << value;
  EXPECT_TRUE(found[0].starts_with("--set: " + key.key + " = " + value + ": ")) << found[0];
  EXPECT_NE(found[0].find(reason), std::string::npos) << found[0];
}

} // namespace

TEST(SceneKeys, AreDescribedWithRangeAndDefault)
{
  const std::vector<Described> keys = described_keys();
  EXPECT_GT(keys.size(), 75u);
  for (const Described& key : keys)
    EXPECT_FALSE(key.range.empty()) << key.path;
}

TEST(SceneKeys, EveryDimensionalKeyRefusesAnotherDimension)
{
  int n_tested = 0;
  for (const Described& key : described_keys())
    if (unit_of(key)) {
      expect_refused(key, is_pairs(key) ? "1 mol: 1 mol" : "1 mol",
                     "'mol' cannot be converted to " + *unit_of(key));
      ++n_tested;
    }
  EXPECT_GT(n_tested, 35);
}

TEST(SceneKeys, EveryDimensionalKeyRefusesWhatIsNoNumber)
{
  for (const Described& key : described_keys())
    if (const auto unit = unit_of(key))
      for (const std::string word : {"nan", "inf", "-inf", "many"}) {
        const std::string value = word + " " + *unit;
        expect_refused(key, is_pairs(key) ? value + ": 1" : value, "does not begin with a number");
      }
}

TEST(SceneKeys, EveryPlainNumberRefusesUnits)
{
  int n_tested = 0;
  for (const Described& key : described_keys())
    if (is_number(key)) {
      expect_refused(key, "1 kPa", "a plain number is expected, without 'kPa'");
      expect_refused(key, "0.5 degrees", "a plain number is expected, without 'degrees'");
      ++n_tested;
    }
  EXPECT_GT(n_tested, 20);
}

TEST(SceneKeys, EveryKeyWithARangeRefusesValuesOutsideAndNamesTheRange)
{
  int n_tested = 0;
  for (const Described& key : described_keys()) {
    const auto unit = unit_of(key);
    if (!unit && !is_number(key))
      continue;
    for (const double value : outside(key.range)) {
      const std::string text = shortest(value) + (unit ? " " + *unit : "");
      expect_refused(key, text, "'" + text + "' is out of range, allowed: ");
      ++n_tested;
    }
  }
  EXPECT_GT(n_tested, 55);
}

TEST(SceneKeys, EveryKeyRefusesANeighbourOfItsName)
{
  for (const Described& key : described_keys()) {
    const std::vector<std::string> found = scenes::errors_of({key.path + "s = 1"});
    ASSERT_EQ(found.size(), 1u) << key.path;
    EXPECT_NE(found[0].find("there is no key '" + key.key + "s'"), std::string::npos) << found[0];
    EXPECT_NE(found[0].find("did you mean '" + key.key + "'?"), std::string::npos) << found[0];
  }
}

TEST(SceneKeys, EveryChoiceRefusesOtherWordsAndListsItsOwn)
{
  int n_tested = 0;
  for (const Described& key : described_keys())
    if (key.range.find(" | ") != std::string::npos) {
      expect_refused(key, "qqqqqqqqqq", "is not one of: " + key.range);
      ++n_tested;
    }
  EXPECT_GT(n_tested, 10);
}
