#include "apps/study_factors.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using apps::combined_runs;
using apps::factor_problems;

namespace {

std::vector<std::string> names(const std::vector<apps::StudyRun>& runs)
{
  std::vector<std::string> all;
  for (const apps::StudyRun& run : runs)
    all.push_back(run.name);
  return all;
}

} // namespace

TEST(StudyFactors, OneKeyGivesARunForEachValue)
{
  const auto runs = combined_runs("Loading/Axial stress", "400 kPa, 1 MPa");
  ASSERT_EQ(names(runs), (std::vector<std::string>{"400-kPa", "1-MPa"}));
  EXPECT_EQ(runs[1].value, "1 MPa");
  EXPECT_EQ(runs[1].settings(), std::vector<std::string>{"Loading/Axial stress = 1 MPa"});
}

TEST(StudyFactors, FactorsAreCombinedAndKeysThatBelongTogetherAreNot)
{
  const auto runs = combined_runs("Loading/Axial stress; Specimen/Seed & Strength/Seed",
                                  "4 kPa, 5 kPa; 1 & 1, 1 & 2, 3 & 1");
  ASSERT_EQ(names(runs), (std::vector<std::string>{"4-kPa_1_1", "4-kPa_1_2", "4-kPa_3_1",
                                                   "5-kPa_1_1", "5-kPa_1_2", "5-kPa_3_1"}));
  EXPECT_EQ(runs[5].value, "5 kPa, 3 & 1");
  EXPECT_EQ(runs[5].settings(),
            (std::vector<std::string>{"Loading/Axial stress = 5 kPa", "Specimen/Seed = 3",
                                      "Strength/Seed = 1"}));
  EXPECT_EQ(apps::varied_keys("A; B & C"), (std::vector<std::string>{"A", "B", "C"}));
}

TEST(StudyFactors, RangesOfWholeNumbersAreWrittenWithTwoDots)
{
  EXPECT_EQ(names(combined_runs("Strength/Seed", "3..5, 9")),
            (std::vector<std::string>{"3", "4", "5", "9"}));
  EXPECT_EQ(names(combined_runs("Strength/Seed", "5..3")), std::vector<std::string>{"5..3"});
}

TEST(StudyFactors, ValuesWithCommasAreSeparatedByBars)
{
  const auto runs = combined_runs("A/B; C/D", "0 s: 1 kPa, 5 s: 2 kPa | 0 s: 3 kPa; 1, 2");
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_EQ(runs[1].settings(),
            (std::vector<std::string>{"A/B = 0 s: 1 kPa, 5 s: 2 kPa", "C/D = 2"}));
}

TEST(StudyFactors, NamesDifferWhereValuesLookAlike)
{
  EXPECT_EQ(names(combined_runs("A/B", "1 kPa, 1-kPa")),
            (std::vector<std::string>{"1-kPa", "1-kPa-"}));
}

TEST(StudyFactors, SayWhatIsWrong)
{
  using Texts = std::vector<std::string>;
  EXPECT_EQ(factor_problems("", ""), Texts{});
  EXPECT_EQ(factor_problems("A/B", "1, 2"), Texts{});
  EXPECT_EQ(factor_problems("A/B; C/D", "1, 2"),
            Texts{"Values: 1 list separated by ';', but Vary names 2 factors"});
  EXPECT_EQ(factor_problems("A/B & C/D", "1 & 2, 3"),
            Texts{"Values: '3' gives 1 value, but 'A/B & C/D' is 2 keys"});
  EXPECT_EQ(factor_problems("A/B; A/B", "1; 2"), Texts{"Vary: 'A/B' comes twice"});
  EXPECT_EQ(factor_problems("A/B", "1..3, 2"), Texts{"Values: '2' comes twice"});
  EXPECT_EQ(factor_problems("A/B &", "1"),
            (Texts{"Vary: a key is missing beside '&' or ';'",
                   "Values: '1' gives 1 value, but 'A/B & ' is 2 keys"}));
  EXPECT_EQ(factor_problems("A/B; C/D", "1..200; 1..200"),
            Texts{"Values: 40000 runs are more than 10000, the most"});
}
