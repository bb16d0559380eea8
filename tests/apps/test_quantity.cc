#include "apps/quantity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

using namespace apps;

namespace {

/// The message of a refused quantity, or an empty text if it is taken.
std::string refusal(const std::string& text, const std::string& unit)
{
  try {
    Units().parse(text, unit, unit);
  } catch (const std::invalid_argument& problem) {
    return problem.what();
  }
  return {};
}

} // namespace

TEST(Quantity, RefusesReciprocalsAndKnowsDegrees)
{
  EXPECT_EQ(refusal("5 GPa", "1/Pa"), "'GPa' cannot be converted to 1/Pa");
  EXPECT_EQ(refusal("200 s", "1/s"), "'s' cannot be converted to 1/s");
  EXPECT_NEAR(Units().parse("180 deg", "rad", "rad"), std::acos(-1.0), 1e-15);
}

TEST(Quantity, ConvertsTheUnitsOfScenes)
{
  struct Case {
    const char *text, *unit;
    double expected;
  };
  const Case cases[] = {{"400 kPa", "Pa", 4e5},
                        {"0.4 MPa", "kPa", 400},
                        {"1 psi", "Pa", 6894.757293168361},
                        {"60.2 mm", "m", 0.0602},
                        {"2 in", "mm", 50.8},
                        {"20 degC", "K", 293.15},
                        {"5 %", "1", 0.05},
                        {"8.2e8 N s/m", "N s/m", 8.2e8},
                        {"8.2e5 kN s/m", "N s/m", 8.2e8},
                        {"3.2 N/um", "N/m", 3.2e6},
                        {"0.3 1/min", "1/s", 0.005},
                        {"2.7 g/cm^3", "kg/m^3", 2700},
                        {"2 min", "s", 120},
                        {"+5 s", "s", 5},
                        {"-5e-3 s", "s", -0.005},
                        {" 7s ", "s", 7},
                        {".5 s", "s", 0.5}};
  const Units units;
  for (const Case& each : cases) {
    const double found = units.parse(each.text, each.unit, each.unit);
    EXPECT_NEAR(found, each.expected, 4e-16 * std::abs(each.expected)) << each.text;
  }
  EXPECT_NEAR(units.parse("68 degF", "degC", "degC"), 20, 1e-13); // through 293.15 K
}

TEST(Quantity, TakesABareNumberInTheDefaultUnit)
{
  const Units units;
  EXPECT_EQ(units.parse("400", "Pa", "kPa"), 4e5);
  EXPECT_EQ(units.parse("400 ", "kPa", "kPa"), 400);
  EXPECT_TRUE(is_bare_number("-1e3"));
  EXPECT_FALSE(is_bare_number("400 kPa"));
  EXPECT_FALSE(is_bare_number("none"));
  EXPECT_EQ(unit_part(" 8 N s/m "), "N s/m");
}

TEST(Quantity, SaysWhatIsWrong)
{
  struct Case {
    const char *text, *unit, *message;
  };
  const Case cases[] = {{"400 mm", "kPa", "'mm' cannot be converted to kPa"},
                        {"400 kN", "kPa", "'kN' cannot be converted to kPa"},
                        {"5 N/m", "N s/m", "'N/m' cannot be converted to N s/m"},
                        {"400 kPasc", "kPa", "'kPasc' is not a known unit"},
                        {"400 kpa", "kPa", "'kpa' is not a known unit"},
                        {"", "kPa", "'' does not begin with a number"},
                        {"kPa", "kPa", "'kPa' does not begin with a number"},
                        {"nan kPa", "kPa", "'nan kPa' does not begin with a number"},
                        {"inf kPa", "kPa", "'inf kPa' does not begin with a number"},
                        {"-infinity", "kPa", "'-infinity' does not begin with a number"},
                        {"1e400 kPa", "kPa", "'1e400 kPa' is out of the range of numbers"},
                        {"1e-400 kPa", "kPa", "'1e-400 kPa' is out of the range of numbers"},
                        {"60,2 mm", "mm", "'60,2 mm': decimals are written with a point"},
                        {"+-5 mm", "mm", "'+-5 mm' does not begin with a number"},
                        {"0x10 mm", "mm", "'x10 mm' is not a known unit"}};
  for (const Case& each : cases)
    EXPECT_EQ(refusal(each.text, each.unit), each.message) << each.text;
}

TEST(Quantity, SurvivesUnitsThatNobodyWouldType)
{
  for (const char* text : {"1 mm mm mm^-2 )(", "1 %%%", "1 s since 2000-01-01", "1 \xff\xfe",
                           "1 m^99999999999", "1 lg(re 1 mW)", "1 /", "1 @ 3", "1 ^"})
    EXPECT_NE(refusal(text, "mm"), "") << text;
}

TEST(Quantity, RoundTripsToTheLastDigits)
{
  const Units units;
  const std::vector<std::pair<std::string, std::string>> pairs{
      {"kPa", "Pa"}, {"MPa", "psi"}, {"mm", "in"}, {"N s/m", "lbf s/in"}, {"%", "1"}};
  for (const auto& [there, back] : pairs)
    for (const double value : {1.0 / 3, 60.2, 8.2e8, 1.1e-12}) {
      const double again = units.convert(units.convert(value, there, back), back, there);
      EXPECT_NEAR(again, value, 1e-15 * value) << there << " " << back;
    }
}

TEST(Quantity, PrintsNumbersThatComeBackExactly)
{
  for (const double value :
       {0.1, 1.0 / 3, 60.2, 8.2e8, 2.2250738585072014e-308, 1.7976931348623157e308, -0.0})
    EXPECT_EQ(std::stod(shortest(value)), value) << shortest(value);
  EXPECT_EQ(shortest(0.1), "0.1");
}
