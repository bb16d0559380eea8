#include "fem/law_file.h"

#include "tests/fem/tables.h"

using namespace fem;

namespace {

LawRecord record()
{
  LawRecord result;
  result.law = tables::anisotropic_law();
  result.reference_temperature = 293.15;
  result.shift = WlfShift{10.1, 1.0 / 3, 293.15};
  result.first_time = 0.1;
  result.last_time = 1e4 / 3;
  result.temperatures = {277.15, 318.15};
  result.relative_error = 0.01 / 7;
  result.provenance = {"made by a test = yes", "second line"};
  return result;
}

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text)
{
  try {
    law_from_text(text, "my.law");
  } catch (const std::invalid_argument& problem) {
    return problem.what();
  }
  return "accepted";
}

} // namespace

TEST(LawFile, GivesBackEveryBit)
{
  const LawRecord given = record(), found = law_from_text(law_text(given), "my.law");
  EXPECT_EQ(found.law.instantaneous, given.law.instantaneous);
  EXPECT_EQ(found.law.fluidity, given.law.fluidity);
  ASSERT_EQ(found.law.terms.size(), given.law.terms.size());
  for (std::size_t k = 0; k < found.law.terms.size(); ++k) {
    EXPECT_EQ(found.law.terms[k].time, given.law.terms[k].time);
    EXPECT_EQ(found.law.terms[k].compliance, given.law.terms[k].compliance);
  }
  EXPECT_EQ(std::get<WlfShift>(found.shift).c2, 1.0 / 3);
  EXPECT_EQ(found.last_time, given.last_time);
  EXPECT_EQ(found.temperatures, given.temperatures);
  EXPECT_EQ(found.relative_error, given.relative_error);
  EXPECT_EQ(found.provenance, given.provenance);
  EXPECT_EQ(law_text(found), law_text(given));
}

TEST(LawFile, KeepsEveryKindOfShift)
{
  LawRecord given = record();
  for (const TemperatureShift& shift :
       {TemperatureShift{}, TemperatureShift{ArrheniusShift{2e5, 293.15}},
        TemperatureShift{FreeShift{{277.15, 293.15}, {1.9, 0}, 293.15}}}) {
    given.shift = shift;
    const LawRecord found = law_from_text(law_text(given), "my.law");
    EXPECT_EQ(found.shift.index(), shift.index());
    EXPECT_DOUBLE_EQ(shift_factor(found.shift, 280), shift_factor(shift, 280));
  }
}

TEST(LawFile, RefusesWithTheLine)
{
  const std::string good = law_text(record());
  EXPECT_EQ(refusal(good), "accepted");
  EXPECT_EQ(refusal(""), "my.law:1: the law file is cut off here: no line 'end'");
  EXPECT_EQ(refusal(replaced(good, "mastic law 1", "mastic law 2")),
            "my.law:1: not a law file of this version: the first line must be 'mastic law 1'");
  EXPECT_EQ(refusal(replaced(good, "relative error", "relative eror")),
            "my.law:10: unknown key 'relative eror'");
  EXPECT_EQ(refusal(replaced(good, "relative error = ", "relative error = x")).substr(0, 11),
            "my.law:10: ");
  EXPECT_NE(refusal(replaced(good, "shift = wlf", "shift = wfl")).find("unknown shift 'wfl'"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(good, "retardation time [s] = 5", "retardation time [s] = 300"))
                .find("occurs twice"),
            std::string::npos);
  EXPECT_NE(refusal(good + "more\n").find("nothing may follow"), std::string::npos);
  EXPECT_NE(refusal(replaced(good, "valid reduced time [s]", "# valid")).find("is missing"),
            std::string::npos);
}

TEST(LawFile, RefusesAnyTextThatIsCutOff)
{
  const std::string good = law_text(record());
  for (std::size_t length = 0; length + 2 < good.size(); length += 7)
    EXPECT_EQ(refusal(good.substr(0, length)).substr(0, 7), "my.law:") << length;
}

TEST(LawFile, RefusesALawThatIsNotAdmissible)
{
  LawRecord given = record();
  given.law.terms[0].compliance(0, 0) = -1e-9;
  EXPECT_NE(refusal(law_text(given)).find("its smallest eigenvalue is"), std::string::npos);
}
