#include "apps/fit_data.h"
#include "apps/measured.h"
#include "dem/hdf5_file.h"
#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

using command::contains;
using command::mastic;
using command::with;

namespace {

const std::string table = "time [s],axial strain [%],axial stress [kPa]\n"
                          "1,0.2,400\n10,0.4,400\n100,0.8,400\n1,0.6,600\n10,0.9,600\n";

apps::LoadedScene scene_at(const command::Folder& folder, const std::string& stress)
{
  return apps::load_scene_text("", "a.scene", folder.path(),
                               {"Output/Measured = lab.csv", "Loading/Axial stress = " + stress});
}

} // namespace

TEST(Measured, StrainOverStressIsACompliance)
{
  const command::Folder folder;
  folder.write("lab.csv", table);
  const apps::FitData data = apps::read_fit_data(folder / "lab.csv");
  ASSERT_EQ(data.measurements.points.size(), 5u);
  EXPECT_DOUBLE_EQ(data.measurements.points[1].value, 0.004 / 400e3);
  EXPECT_DOUBLE_EQ(data.measurements.points[4].value, 0.009 / 600e3);
  folder.write("lab.csv", "time [s],axial strain [%]\n1,0.2\n2,0.3\n3,0.4\n");
  EXPECT_THROW(apps::read_fit_data(folder / "lab.csv"), std::invalid_argument);
  folder.write("lab.csv",
               "time [s],axial strain [%],axial stress [kPa]\n1,0.2,400\n1,0.3,400\n2,1,400\n");
  EXPECT_THROW(apps::read_fit_data(folder / "lab.csv"), std::invalid_argument);
}

TEST(Measured, RowsAtTheStressOfTheSceneBelongToIt)
{
  const command::Folder folder;
  folder.write("lab.csv", table);
  const apps::MeasuredCurve curve = apps::measured_curve(scene_at(folder, "0.6 MPa"));
  ASSERT_EQ(curve.time, (std::vector<double>{1, 10}));
  EXPECT_NEAR(curve.strain[1], 0.009, 1e-15);
  EXPECT_NEAR(apps::measured_curve(scene_at(folder, "-400 kPa")).strain[2], -0.008, 1e-15);
  EXPECT_THROW(apps::measured_curve(scene_at(folder, "500 kPa")), std::invalid_argument);
  folder.write("lab.csv", "time [s],creep compliance [1/GPa]\n1,2\n10,3\n100,4\n");
  EXPECT_NEAR(apps::measured_curve(scene_at(folder, "500 kPa")).strain[2], 0.002, 1e-15);
  folder.write("lab.csv", "time [s],relaxation modulus [MPa]\n1,2\n10,3\n100,4\n");
  EXPECT_THROW(apps::measured_curve(scene_at(folder, "500 kPa")), std::invalid_argument);
  const apps::LoadedScene none = apps::load_scene_text("", "a.scene", folder.path(), {});
  EXPECT_TRUE(apps::measured_curve(none).time.empty());
}

TEST(Measured, AgreementIsTheRootOfTheMeanSquareOverTheLargestStrain)
{
  const std::vector<apps::Column> history{{"time_s", "s", {0, 10, 20}},
                                          {"axial_strain_percent", "%", {0, 1, 1}}};
  const apps::MeasuredCurve curve{{5, 15, 20, 30}, {0.005, 0.013, 0.006, 0.5}};
  const apps::Agreement found = apps::agreement(curve, history);
  EXPECT_EQ(found.n_points, 3u); // the last one comes after the end
  EXPECT_NEAR(found.difference, std::sqrt((9e-6 + 16e-6) / 3) / 0.013, 1e-12);
  EXPECT_TRUE(std::isnan(apps::agreement({{30}, {1}}, history).difference));
}

TEST(Measured, IsComparedAndStored)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  folder.write("lab.csv", table);
  const std::vector<std::string> settings{"Loading/End time = 50 s", "Output/History times = 5",
                                          "Output/Measured = lab.csv"};
  const apps::Finished run = mastic(folder, with({"run", "net.scene", "--quiet"}, settings));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(contains(run.output, "  measured: rms difference ")) << run.output;
  EXPECT_TRUE(contains(run.output, " of the largest strain, 2 points\n")) << run.output;
  const dem::Hdf5File result = dem::Hdf5File::open(folder / "results/net/result.h5");
  EXPECT_EQ(result.read_doubles("measured/time_s"), (std::vector<double>{1, 10, 100}));
  EXPECT_GT(result.number_attribute("measured", "relative_rms_difference"), 0);
  const apps::Finished wrong =
      mastic(folder, with({"check", "net.scene"}, {"Output/Measured = nowhere.csv"}));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_TRUE(contains(wrong.output, "Output/Measured: error: ")) << wrong.output;
  const apps::Finished rate =
      mastic(folder, with({"check", "net.scene"},
                          {"Output/Measured = lab.csv", "Loading/Test = constant rate"}));
  EXPECT_TRUE(contains(rate.output, "only a creep test can be compared")) << rate.output;
}
