#include "apps/csv_table.h"
#include "fem/law_file.h"
#include "tests/apps/command.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

using apps::Finished;
using command::contains;
using command::mastic;

namespace {

const std::string data_folder = MASTIC_SOURCE_DIR "/scenes/data";

/// D(t) of a Burgers element [1/GPa] at 25 times from 0.1 s to 1000 s.
std::string creep_table()
{
  std::string text = "time [min],creep compliance [1/MPa]\n";
  for (int k = 0; k < 25; ++k) {
    const double t = 0.1 * std::pow(10, k / 6.0);
    text += fmt::format("{},{}\n", t / 60, 1e-3 * (0.5 + t / 400 + 2 * (1 - std::exp(-t / 7))));
  }
  return text;
}

std::string error_of(const command::Folder& folder, const std::string& table,
                     std::vector<std::string> options = {})
{
  folder.write("d.csv", table);
  options.insert(options.begin(), {"fit", "d.csv", "--no-plots"});
  const Finished done = mastic(folder, options);
  EXPECT_EQ(done.exit_code, 2) << done.output;
  EXPECT_FALSE(folder.has("results"));
  return done.output;
}

} // namespace

TEST(Fit, BurgersElementComesBackInLabUnits)
{
  const command::Folder folder;
  folder.write("creep.csv", creep_table());
  const Finished done = mastic(folder, {"fit", "creep.csv", "--form", "burgers", "--no-plots",
                                        "--poisson", "0.4", "-o", "out"});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "assumed: the table has none")) << done.output;
  const std::string table = folder.read("out/parameters.csv");
  EXPECT_TRUE(contains(table, "\nE_k,500.0") || contains(table, "\nE_k,499.99")) << table;
  const fem::LawRecord record = fem::law_from_text(folder.read("out/creep.law"), "creep.law");
  EXPECT_NEAR(record.law.instantaneous(0, 0) / 0.5e-9, 1, 1e-5);
  EXPECT_NEAR(record.law.instantaneous(0, 1) / record.law.instantaneous(0, 0), -0.4, 1e-12);
  EXPECT_NEAR(record.law.terms.at(0).time / 7, 1, 1e-5);
  EXPECT_FALSE(record.temperatures.has_value());
  EXPECT_TRUE(contains(done.output, folder.read("out/report.txt")));
}

TEST(Fit, LawOfMeasuredAsphaltReproducesItsModulus)
{
  const command::Folder folder;
  const Finished done = mastic(folder, {"fit", data_folder + "/sma-20C.csv", "--shift", "free",
                                        "--no-plots", "--bootstrap", "40"});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  const fem::LawRecord record =
      fem::law_from_text(folder.read("results/sma-20C-fit/sma-20C.law"), "sma-20C.law");
  const apps::Units units;
  const apps::CsvTable table(data_folder + "/sma-20C.csv", units);
  const auto temperature = table.numbers("temperature", "K");
  const auto frequency = table.numbers("frequency", "Hz");
  const auto modulus = table.numbers("dynamic modulus", "Pa");
  std::map<std::pair<double, double>, std::pair<double, double>> extremes; // of the specimens
  for (std::size_t i = 0; i < modulus.size(); ++i) {
    auto& [low, high] =
        extremes.try_emplace({temperature[i], frequency[i]}, modulus[i], modulus[i]).first->second;
    low = std::min(low, modulus[i]);
    high = std::max(high, modulus[i]);
  }
  EXPECT_EQ(extremes.size(), 13U);
  for (const auto& [point, measured] : extremes) {
    const auto& [kelvin, hertz] = point;
    const double omega = 2 * std::numbers::pi * hertz * fem::shift_factor(record.shift, kelvin);
    const double law = 1 / std::abs(fem::complex_compliance(record.law, omega)(0, 0));
    EXPECT_GE(law, 0.93 * measured.first) << kelvin << " K " << hertz << " Hz";
    EXPECT_LE(law, 1.07 * measured.second) << kelvin << " K " << hertz << " Hz";
    const double mean = 0.5 * (measured.first + measured.second);
    EXPECT_NEAR(law / mean, 1, kelvin < 300 ? 0.06 : 0.08) << kelvin << " K " << hertz << " Hz";
  }
}

TEST(Fit, DrawsItsFigures)
{
  const command::Folder folder;
  const Finished done = mastic(folder, {"fit", data_folder + "/sma-20C.csv", "--shift", "wlf",
                                        "--form", "2s2p1d", "-o", "."});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(folder.has("fit.png")) << done.output;
  EXPECT_TRUE(folder.has("complex_modulus.png")) << done.output;
}

TEST(Fit, RefusesBadDataWithFileLineAndColumn)
{
  const command::Folder folder;
  const std::string header = "time [s],creep compliance [1/GPa]\n";
  EXPECT_EQ(error_of(folder, header + "1,0.1\n2,0.2\n"),
            "error: d.csv: a fit needs three rows or more, there are 2\n");
  EXPECT_EQ(error_of(folder, header + "1,0.1\n3,0.2\n2,0.3\n"),
            "error: d.csv:4: column 'time': 2 does not rise above the time before it (tests at "
            "other temperatures or on other specimens need a column 'temperature' or "
            "'specimen')\n");
  EXPECT_EQ(error_of(folder, header + "1,0.1\n2,-0.2\n3,0.3\n"),
            "error: d.csv:3: column 'creep compliance': -0.2 is not above 0\n");
  EXPECT_EQ(error_of(folder, header + "1,0.1\n2,nan\n3,0.3\n"),
            "error: d.csv:3: column 'creep compliance': 'nan' is not a number\n");
  EXPECT_TRUE(contains(error_of(folder, "time [s],creep compliance [GPa]\n1,1\n2,2\n3,3\n"),
                       "column 'creep compliance'"));
  EXPECT_TRUE(contains(error_of(folder, "time [s],creep compliance\n1,1\n2,2\n3,3\n"),
                       "needs a unit in its name"));
  EXPECT_TRUE(contains(error_of(folder, "time [s]\n1\n2\n3\n"), "there is no measured column"));
  EXPECT_TRUE(contains(error_of(folder, "frequency [Hz],dynamc modulus [MPa]\n1,1\n2,2\n3,3\n"),
                       "did you mean 'dynamic modulus'?"));
  EXPECT_EQ(error_of(folder, "time [s],dynamic modulus [MPa]\n1,1\n2,2\n3,3\n"),
            "error: d.csv: a dynamic modulus is measured over frequency, not over time\n");
  EXPECT_EQ(error_of(folder, "frequency [Hz],dynamic modulus [MPa],phase angle [deg]\n1,1,30\n"
                             "2,2,95\n3,3,20\n"),
            "error: d.csv:3: column 'phase angle': 95 is not between 0 and 90 degrees\n");
  EXPECT_EQ(error_of(folder, ""),
            "error: d.csv: the file is empty; the first line names the columns\n");
}

TEST(Fit, RefusesBadOptions)
{
  const command::Folder folder;
  const std::string table = creep_table();
  EXPECT_EQ(error_of(folder, table, {"--form", "prony"}),
            "error: there is no form 'prony'; forms: series, burgers, power, sigmoid, 2s2p1d\n");
  EXPECT_EQ(error_of(folder, table, {"--form", "2s2p1d"}),
            "error: d.csv: fit: the sigmoid or 2S2P1D has no closed form of creep or relaxation; "
            "it needs the dynamic modulus over frequency\n");
  EXPECT_EQ(error_of(folder, table, {"--shift", "wlf"}),
            "error: d.csv: fit: a WLF shift needs three temperatures, the data have 1\n");
  EXPECT_EQ(error_of(folder, table, {"--terms", "0"}),
            "error: --terms: '0' is neither 'auto' nor a number from 1 to 60\n");
  EXPECT_EQ(error_of(folder, table, {"--poisson", "0.5"}),
            "error: --poisson: must be above -1 and below 0.5, found 0.5\n");
  EXPECT_EQ(mastic(folder, {"fit", "none.csv"}).exit_code, 2);
  EXPECT_EQ(mastic(folder, {"fit"}).exit_code, 2);
}
