#include "apps/csv_table.h"
#include "apps/text.h"
#include "dem/hdf5_file.h"
#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

const std::vector<std::string> creep{"Loading/Axial stress = 1000 kPa", "Loading/End time = 20 s",
                                     "Output/History times = 12", "Output/Snapshot times = 5 s",
                                     "Output/Folder = out"};

/// A finished run of a lattice that breaks some bonds.
struct FinishedRun {
  command::Folder folder;
  Finished run;

  explicit FinishedRun(const std::vector<std::string>& settings = {},
                       const std::vector<std::string>& options = {})
  {
    networks::write_lattice(folder);
    std::vector<std::string> arguments{"run", "net.scene"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    run = mastic(folder, with(with(arguments, creep), settings));
  }
  dem::Hdf5File result() const { return dem::Hdf5File::open(folder / "out/result.h5"); }
  std::string exported(const std::vector<std::string>& what) const
  {
    std::vector<std::string> arguments{"export", "out"};
    arguments.insert(arguments.end(), what.begin(), what.end());
    const Finished done = mastic(folder, arguments);
    EXPECT_EQ(done.exit_code, 0) << done.output;
    return done.output;
  }
};

/// Columns of a CSV text by name; empty cells are not-a-number.
std::map<std::string, std::vector<double>> columns(const std::string& csv)
{
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = apps::split(line, ',');
  std::map<std::string, std::vector<double>> result;
  for (const std::string& name : names)
    result[name];
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = apps::split(line, ',');
    EXPECT_EQ(cells.size(), names.size()) << line;
    for (std::size_t k = 0; k < names.size(); ++k)
      result[names[k]].push_back(cells[k].empty() ? NAN : std::stod(cells[k]));
  }
  return result;
}

/// Equal to the last bit, or both not-a-number.
bool same(const std::vector<double>& a, const std::vector<double>& b)
{
  bool equal = a.size() == b.size();
  for (std::size_t k = 0; equal && k < a.size(); ++k)
    equal = a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k]));
  return equal;
}

/// All datasets below a group, with their full names.
std::vector<std::string> datasets(const dem::Hdf5File& file, const std::string& group)
{
  std::vector<std::string> names;
  for (const std::string& member : file.members(group)) {
    const std::string name = group.empty() ? member : group + "/" + member;
    try {
      for (const std::string& each : datasets(file, name))
        names.push_back(each);
    } catch (const std::runtime_error&) { // it has no members: a dataset
      names.push_back(name);
    }
  }
  return names;
}

} // namespace

TEST(Results, LeaveTheseFilesAndNoOthers)
{
  const FinishedRun done;
  ASSERT_EQ(done.run.exit_code, 0) << done.run.output;
  const std::vector<std::string> found = done.folder.files("out");
  EXPECT_EQ(std::set<std::string>(found.begin(), found.end()),
            (std::set<std::string>{"history.csv", "breakages.csv", "result.h5"}));
  const std::vector<std::string> all = done.folder.files();
  EXPECT_EQ(all.size(), 6u) << "something was left outside of the result folder";
  EXPECT_TRUE(contains(done.run.output, "  results in out\n"));
}

TEST(Results, NameColumnsWithUnits)
{
  const FinishedRun done;
  const std::string history = done.folder.read("out/history.csv");
  EXPECT_EQ(history.substr(0, history.find('\n')),
            "time_s,axial_stress_kPa,axial_strain_percent,strain_rate_per_s,"
            "creep_compliance_per_GPa,elastic_modulus_MPa,strength_factor,broken_bonds");
  const std::string breakages = done.folder.read("out/breakages.csv");
  EXPECT_EQ(breakages.substr(0, breakages.find('\n')),
            "time_s,pass,bond,first_particle,second_particle,shear_mode,tensile_force_N,"
            "shear_force_N,strength_factor,axial_strain_percent,x_mm,y_mm,z_mm");
  auto rows = columns(history);
  EXPECT_EQ(rows["time_s"].front(), 0);
  EXPECT_EQ(rows["time_s"].back(), 20);
  EXPECT_EQ(rows["time_s"].size(), 13u); // 12 times and the start
  EXPECT_NEAR(rows["axial_stress_kPa"].back(), 1000, 1e-9);
  EXPECT_GT(rows["axial_strain_percent"].back(), 0); // compression positive
  EXPECT_GT(rows["broken_bonds"].back(), 10);
  EXPECT_EQ(rows["broken_bonds"].back(), double(columns(breakages)["bond"].size()));
}

TEST(Results, NameColumnsOfParticleLoadsToo)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv",
               "x_mm,y_mm,z_mm,r_mm,held,fz_N\n0,0,2,2,bottom,0\n0,0,6,2,free,3.2\n");
  const Finished done = mastic(
      folder, with({"run", "net.scene"}, {"Loading/Test = particle loads", "Loading/End time = 0 s",
                                          "Strength/Distribution = none", "Output/Folder = out"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const std::string history = folder.read("out/history.csv");
  EXPECT_EQ(history.substr(0, history.find('\n')),
            "time_s,load_factor,mean_displacement_mm,strength_factor,broken_bonds");
  const auto rows = columns(history);
  EXPECT_EQ(rows.at("load_factor"), std::vector<double>{1});
  ASSERT_EQ(rows.at("mean_displacement_mm").size(), 1u); // 3.2 N on 3.2e6 N/m
  EXPECT_NEAR(rows.at("mean_displacement_mm")[0], 1e-3, 1e-17);
}

TEST(Results, HoldTheSameNumbersInAllForms)
{
  const FinishedRun done;
  const dem::Hdf5File file = done.result();
  for (const std::string table : {"history", "breakages"}) {
    const std::string exported = done.exported({table});
    EXPECT_EQ(exported, done.folder.read("out/" + table + ".csv"));
    const auto found = columns(exported);
    EXPECT_EQ(found.size(), file.members(table).size());
    for (const auto& [name, values] : found)
      EXPECT_TRUE(same(values, file.read_doubles(table + "/" + name))) << table << " " << name;
  }
}

TEST(Results, ExportSnapshotsAtFullPrecision)
{
  const FinishedRun done;
  const dem::Hdf5File file = done.result();
  ASSERT_EQ(file.members("snapshots"), (std::vector<std::string>{"0000", "0001", "0002"}));
  EXPECT_EQ(file.number_attribute("snapshots/0001", "time_s"), 5);
  const auto check = [&](const std::string& csv, const std::vector<std::string>& names,
                         const std::string& dataset, double factor) {
    const auto found = columns(csv);
    const std::vector<double> stored = file.read_doubles(dataset);
    ASSERT_EQ(stored.size() % 3, 0u);
    for (int k = 0; k < 3; ++k) {
      std::vector<double> expected;
      for (std::size_t i = std::size_t(k); i < stored.size(); i += 3)
        expected.push_back(factor * stored[i]);
      EXPECT_TRUE(same(found.at(names[std::size_t(k)]), expected)) << names[std::size_t(k)];
    }
  };
  const std::string particles = done.exported({"particles", "--time", "5 s"});
  check(particles, {"x_mm", "y_mm", "z_mm"}, "packing/centre", 1e3);
  check(particles, {"ux_mm", "uy_mm", "uz_mm"}, "snapshots/0001/displacement", 1e3);
  check(particles, {"rotation_x_rad", "rotation_y_rad", "rotation_z_rad"},
        "snapshots/0001/rotation", 1);
  const std::string bonds = done.exported({"bonds"}); // the last
  check(bonds, {"force_x_N", "force_y_N", "force_z_N"}, "snapshots/0002/bond_force", 1);
  check(bonds, {"moment_x_N_m", "moment_y_N_m", "moment_z_N_m"}, "snapshots/0002/bond_moment", 1);
  const std::vector<double> state = columns(bonds).at("state");
  const auto n_damaged = std::ssize(state) - std::ranges::count(state, 0.0);
  EXPECT_EQ(double(n_damaged),
            columns(done.folder.read("out/history.csv")).at("broken_bonds").back());
}

TEST(Results, ExportNamesTheNearestSnapshotAndTheTablesThereAre)
{
  const FinishedRun done;
  const Finished near = mastic(done.folder, {"export", "out", "bonds", "--time", "4900 ms"});
  EXPECT_EQ(near.exit_code, 0);
  EXPECT_TRUE(contains(near.output, "note: nearest snapshot is at 5 s; there are: 0, 5, 20 s\n"));
  const Finished typo = mastic(done.folder, {"export", "out", "breakage"});
  EXPECT_EQ(typo.exit_code, 2);
  EXPECT_EQ(typo.output,
            "error: there is no table 'breakage'; tables: history, breakages, cycles, energy, "
            "particles, bonds, complex_modulus, probes; did you mean 'breakages'?\n");
  const Finished absent = mastic(done.folder, {"export", "out", "complex_modulus"});
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_TRUE(contains(absent.output, "error: the result has no table 'complex_modulus'"));
  const Finished unit = mastic(done.folder, {"export", "out", "bonds", "--time", "5 mm"});
  EXPECT_EQ(unit.exit_code, 2);
  EXPECT_EQ(unit.output, "error: 'mm' cannot be converted to s\n");
}

TEST(Results, GiveEveryNumberAUnit)
{
  const FinishedRun done({"Solver = linear"});
  const dem::Hdf5File file = done.result();
  const std::set<std::string> counts{
      "packing/material_class", "bonds/particles", "bonds/law", "bonds/id",
      "scene/as_typed",         "scene/resolved"};
  int n_tested = 0;
  for (const std::string& name : datasets(file, "")) {
    if (counts.contains(name) || name.ends_with("/bond_state"))
      continue;
    std::string unit;
    EXPECT_NO_THROW(unit = file.text_attribute(name, "unit")) << name;
    EXPECT_NE(unit, "") << name;
    ++n_tested;
  }
  EXPECT_GT(n_tested, 40);
  EXPECT_EQ(file.text_attribute("history/axial_stress_kPa", "unit"), "kPa");
  EXPECT_EQ(file.text_attribute("snapshots/0000/bond_moment", "unit"), "N m");
  EXPECT_EQ(file.text_attribute("complex_modulus/phase_angle_degrees", "unit"), "degree");
}

TEST(Results, SayWhereTheyComeFrom)
{
  const FinishedRun done({"Strength/Seed = 7", "Title = A title"});
  const dem::Hdf5File file = done.result();
  EXPECT_TRUE(file.is_complete());
  EXPECT_EQ(file.text_attribute("", "kind"), "result");
  EXPECT_EQ(file.text_attribute("", "program"), "mastic " MASTIC_VERSION);
  EXPECT_EQ(file.text_attribute("", "name"), "net");
  EXPECT_EQ(file.text_attribute("", "title"), "A title");
  EXPECT_EQ(file.text_attribute("", "solver"), "events");
  EXPECT_EQ(file.text_attribute("", "end"), "end of the load history");
  EXPECT_EQ(file.number_attribute("", "strength_seed"), 7);
  EXPECT_EQ(file.number_attribute("", "storage_version"), 1);
  EXPECT_TRUE(file.text_attribute("", "estimated_values").starts_with("Maxwell stiffness, "));
  for (const char* attribute : {"revision", "compiler", "written_utc", "solver_reason",
                                "solver_statistics", "sign", "machine"})
    EXPECT_NE(file.text_attribute("", attribute), "") << attribute;
  EXPECT_EQ(file.text_attribute("", "control"), "force");
  for (const char* count : {"unknowns", "bonds", "steps", "solves", "factorisations"})
    EXPECT_GE(file.number_attribute("", count), 1) << count;
  EXPECT_EQ(file.read_text("scene/as_typed"), networks::scene);
  EXPECT_TRUE(contains(file.read_text("scene/resolved"), "\n  set Axial stress = 1000 kPa\n"));

  const Finished info = mastic(done.folder, {"info", "out"});
  EXPECT_EQ(info.exit_code, 0);
  for (const char* line :
       {"out/result.h5: result\n", "  solver               events\n", "  particles            96\n",
        "  strength_seed        7\n", "  snapshots at         0, 5, 20 s\n",
        "  set Axial stress = 1000 kPa\n"})
    EXPECT_TRUE(contains(info.output, line)) << line << info.output;
}

TEST(Results, OfALinearRunHoldTheComplexModulus)
{
  const FinishedRun done({"Strength/Distribution = none"});
  ASSERT_EQ(done.run.exit_code, 0) << done.run.output;
  EXPECT_EQ(done.exported({"complex_modulus"}), done.folder.read("out/complex_modulus.csv"));
  auto table = columns(done.folder.read("out/complex_modulus.csv"));
  EXPECT_EQ(table["frequency_Hz"], (std::vector<double>{0.01, 0.1, 1, 10, 25}));
  // At high frequency the specimen answers as fast as at once.
  const double elastic = columns(done.folder.read("out/history.csv"))["elastic_modulus_MPa"].back();
  EXPECT_NEAR(table["complex_modulus_MPa"].back(), elastic, 1e-3 * elastic);
}

TEST(Results, OfTheExplicitSolverHoldAnAudit)
{
  const FinishedRun done({"Solver = dynamic", "Loading/Axial stress = 1 kPa"}, {"--threads", "1"});
  ASSERT_EQ(done.run.exit_code, 0) << done.run.output;
  EXPECT_TRUE(contains(done.run.output, "  scaling audit against 'events' (x = 0.001): strain off"))
      << done.run.output;
  const auto audit = columns(done.folder.read("out/audit.csv"));
  const double found = audit.at("strain_percent").back();
  EXPECT_EQ(found, columns(done.folder.read("out/history.csv")).at("axial_strain_percent").back());
  EXPECT_GT(found, 0);
  EXPECT_NEAR(found, audit.at("exact_strain_percent").back(), 0.02 * found);
  EXPECT_EQ(done.result().text_attribute("", "end"), "end of the load history");
}

TEST(Results, TellOfParticlesWithoutBonds)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n0,0,6,2,top\n"
                                "9,0,4,2,free\n9,9,4,2,free\n");
  const Finished done = mastic(folder, with({"run", "net.scene"}, {"Loading/End time = 1 s"}));
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_TRUE(contains(done.output, "  note: 2 of the particles hang on nothing: 2, 3\n"))
      << done.output;
}

TEST(Results, OfAnEarlierRunAreReplaced)
{
  const FinishedRun done({"Output/ParaView = true", "Output/Snapshot times = 2 s, 5 s"});
  EXPECT_TRUE(done.folder.has("out/paraview/bonds_0003.vtp"));
  const std::string before = done.folder.read("out/history.csv");
  const Finished again =
      mastic(done.folder, with(with({"run", "net.scene"}, creep),
                               {"Output/ParaView = true", "Loading/Axial stress = 900 kPa"}));
  ASSERT_EQ(again.exit_code, 0) << again.output;
  EXPECT_NE(done.folder.read("out/history.csv"), before);
  EXPECT_TRUE(done.folder.has("out/paraview/bonds_0002.vtp"));
  EXPECT_FALSE(done.folder.has("out/paraview/bonds_0003.vtp"));
  for (const std::string& name : done.folder.files("out"))
    EXPECT_FALSE(name.ends_with(".part")) << name;
}

TEST(Results, OfALostEquilibriumAreWrittenAndHaveTheirExitCode)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("bonds.csv", "a,b,normal_strength_N\n0,1,10\n");
  const Finished done =
      mastic(folder, with({"run", "net.scene"},
                          {"Loading/Axial stress = -400 kPa", "Output/Folder = out"}));
  EXPECT_EQ(done.exit_code, 5) << done.output;
  EXPECT_TRUE(contains(done.output, "lost equilibrium: no chain of bonds connects the platens"));
  const dem::Hdf5File file = dem::Hdf5File::open(folder / "out/result.h5");
  EXPECT_EQ(file.text_attribute("", "end"), "lost equilibrium");
  EXPECT_TRUE(contains(file.text_attribute("", "end_reason"), "no chain of bonds"));
  const auto breakages = columns(folder.read("out/breakages.csv"));
  EXPECT_EQ(breakages.at("time_s"), std::vector<double>{0});
  EXPECT_EQ(breakages.at("shear_mode"), std::vector<double>{0});
  EXPECT_EQ(breakages.at("z_mm"), std::vector<double>{4});
  const double force = 400e3 * std::numbers::pi * 0.016 * 0.016 / 4;
  EXPECT_NEAR(breakages.at("tensile_force_N")[0], force, 1e-9 * force);
}
