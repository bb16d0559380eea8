#include "tests/coupling/card_reading.h"

#include <filesystem>
#include <fstream>

using namespace coupling;

namespace {

/// Creep with the update of the behaviour: stress along axis 1 in steps, by Newton's method with
/// the tangent; prints time, strain 11, 22, 23, difference of tangent and difference quotient.
constexpr const char* driver = R"(
int main()
{
  StrainStensor eto, sig, er[n_terms];
  real t = 0;
  real wrong = 0;
  for (const real end : {1e-9, 0.01, 0.1, 1., 10., 100., 1000., 10000.})
    for (int step = 0; step != 3; ++step) {
      const real dt = (step + 1) * (end - t) / 6 > 0 ? (end - t) / (3 - step) : 0;
      StrainStensor deto, tried_sig, tried_er[n_terms];
      Stensor4 Dt;
      for (int pass = 0; pass != 4; ++pass) {
        tried_sig = sig;
        for (int k = 0; k != n_terms; ++k)
          tried_er[k] = er[k];
        update(deto, tried_sig, tried_er, dt, Dt);
        StrainStensor missing;
        const real load = (t + dt) / 1e-9 < 1 ? (t + dt) / 1e-9 * 1e5 : 1e5;
        missing[0] = load;
        missing = missing - tried_sig;
        const Stensor4 compliance = invert(Dt);
        for (int i = 0; i != 6; ++i)
          for (int j = 0; j != 6; ++j)
            deto[i] += compliance(i, j) * missing[j];
      }
      StrainStensor more = deto, more_sig = sig, more_er[n_terms];
      for (int k = 0; k != n_terms; ++k)
        more_er[k] = er[k];
      more[3] += 1e-5;
      Stensor4 unused;
      update(more, more_sig, more_er, dt, unused);
      for (int i = 0; i != 6; ++i)
        wrong = std::max(wrong, std::abs((more_sig[i] - tried_sig[i]) / 1e-5 - Dt(i, 3)) /
                                    std::abs(Dt(3, 3)));
      for (int i = 0; i != 6; ++i)
        eto[i] += deto[i];
      sig = tried_sig;
      for (int k = 0; k != n_terms; ++k)
        er[k] = tried_er[k];
      t += dt;
      std::printf("%.17g %.17g %.17g %.17g %.3g\n", t, eto[0], eto[1], eto[5], wrong);
    }
}
)";

std::string program_of(const std::string& behaviour)
{
  const std::size_t begin = behaviour.find("@Integrator{") + 12;
  const std::string body = behaviour.substr(begin, behaviour.rfind('}') - begin);
  const auto lines = cards::lines_of(behaviour);
  const std::string constant = lines.at(cards::find(lines, "@IntegerConstant"));
  return "#include \"tests/coupling/mfront_stand_in.h\"\n#include <algorithm>\n#include <cstdio>\n"
         "constexpr int " +
         constant.substr(17) +
         "\nvoid update(const StrainStensor& deto, StrainStensor& sig, StrainStensor* er, real dt, "
         "Stensor4& Dt)\n{\n  const real T = TEMPERATURE, dT = 0;\n"
         "  const bool computeTangentOperator_ = true;\n(void)T;\n(void)dT;\n" +
         body + "}\n" + driver;
}

/// What the driver prints at a temperature [K].
std::vector<std::vector<double>> run(const std::string& behaviour, double temperature)
{
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mastic-mfront-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "check.cc") << program_of(behaviour);
  const std::string command = std::string("c++ -std=c++17 -I") + MASTIC_SOURCE_DIR +
                              " -DTEMPERATURE=" + std::to_string(temperature) + " -o " +
                              (folder / "check").string() + " " + (folder / "check.cc").string() +
                              " && " + (folder / "check").string() + " > " +
                              (folder / "out").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream file(folder / "out");
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);)
    rows.push_back(cards::numbers(line));
  std::filesystem::remove_all(folder);
  return rows;
}

void expect_creep(const fem::LawRecord& record, double temperature)
{
  const MaterialCard card = material_card(record, CardFormat::mfront, si_units());
  const auto rows = run(cards::text_of(card.files, "MasticCreep.mfront"), temperature);
  ASSERT_EQ(rows.size(), 24U);
  const double shift = fem::shift_factor(record.shift, temperature);
  for (std::size_t i = 3; i < rows.size(); ++i) {
    const fem::Mat6 exact = 1e5 * fem::compliance(record.law, rows[i].at(0) / shift);
    EXPECT_NEAR(rows[i].at(1) / exact(0, 0), 1, 1e-7);
    EXPECT_NEAR(rows[i].at(2), exact(1, 0), 1e-7 * exact(0, 0));
    EXPECT_NEAR(rows[i].at(3), exact(3, 0), 1e-7 * exact(0, 0)); // 23, last in TFEL's order
    EXPECT_LT(rows[i].at(4), 1e-6);
  }
}

} // namespace

TEST(MFrontCard, UpdateGivesTheAnisotropicCreepLaw)
{
  expect_creep(cards::anisotropic_record(), 293.15);
}

TEST(MFrontCard, UpdateShiftsTimeWithTemperature)
{
  fem::LawRecord record = cards::anisotropic_record();
  expect_creep(record, 303.15);
  record.shift = fem::ArrheniusShift{1e5, 293.15};
  expect_creep(record, 283.15);
  record.shift = fem::FreeShift{{277.15, 293.15, 310, 320}, {1.9, 0, -1.5, -2}, 293.15};
  expect_creep(record, 280);
  expect_creep(record, 315);
}

TEST(MFrontCard, DeckExpectsTheClosedForm)
{
  const fem::LawRecord record = cards::anisotropic_record();
  const MaterialCard card = material_card(record, CardFormat::mfront, millimetre_units());
  const auto lines = cards::lines_of(cards::text_of(card.files, "mastic_mfront_check.mtest"));
  const std::string test = lines.at(cards::find(lines, "@Test<function> 'EXX'"));
  EXPECT_EQ(std::ranges::count(test, '*'), 1 + std::ptrdiff_t(record.law.terms.size()));
  EXPECT_NE(lines.at(cards::find(lines, "@ImposedStress")).find("1.000000000000e-01"),
            std::string::npos); // 100 kPa in MPa
}
