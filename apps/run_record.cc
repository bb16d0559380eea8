#include "apps/run_record.h"

#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace apps {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <typename Rows, typename Function>
Column column(const std::string& name, const std::string& unit, const Rows& rows, Function&& value)
{
  Column result{name, unit, {}};
  for (const auto& row : rows)
    result.values.push_back(value(row));
  return result;
}

/// Three columns of a vector field.
void add_components(std::vector<Column>& columns, const std::vector<std::string>& names,
                    const std::string& unit, const std::vector<dem::Vec3>& field, double factor)
{
  for (int k = 0; k < 3; ++k)
    columns.push_back(
        column(names[k], unit, field, [&](const dem::Vec3& v) { return factor * v[k]; }));
}

std::vector<double> flat(const std::vector<dem::Vec3>& vectors)
{
  std::vector<double> numbers;
  for (const dem::Vec3& v : vectors)
    numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
  return numbers;
}

std::vector<dem::Vec3> vectors(const std::vector<double>& numbers)
{
  std::vector<dem::Vec3> result;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
    result.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return result;
}

} // namespace

Snapshot network_snapshot(const dem::ElasticNetwork& network, double time,
                          std::span<const dem::BondStatus> status, const Eigen::VectorXd& dofs,
                          const Eigen::VectorXd& elastic)
{
  Snapshot snapshot{time, {}, {}, {}, {}, {}};
  for (std::size_t i = 0; i < network.radius.size(); ++i) {
    const dem::ParticleMotion m = dem::motion(network, dofs, dem::Index(i));
    snapshot.displacement.push_back(m.displacement);
    snapshot.rotation.push_back(m.rotation);
  }
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const dem::BondLoad load = dem::bond_load(network.bonds[b], status[b],
                                              dem::deformation(network, network.bonds[b], elastic));
    snapshot.force.push_back(load.force);
    snapshot.moment.push_back(load.moment);
    snapshot.state.push_back(std::uint8_t(status[b]));
  }
  return snapshot;
}

Face face_of(const dem::Assembly& assembly)
{
  return {dem::loaded_by_platen(assembly), assembly.area, assembly.gauge_length};
}

std::vector<Column> history_columns(const Face& face, std::span<const dem::Response> rows)
{
  using dem::Response;
  std::vector<Column> columns;
  columns.push_back(column("time_s", "s", rows, [](const Response& r) { return r.time; }));
  if (face.platen) {
    const double area = face.area, length = face.length;
    columns.push_back(column("axial_stress_kPa", "kPa", rows,
                             [&](const Response& r) { return -r.force / area / 1e3; }));
    columns.push_back(column("axial_strain_percent", "%", rows,
                             [](const Response& r) { return -100 * r.strain; }));
    columns.push_back(
        column("strain_rate_per_s", "1/s", rows, [](const Response& r) { return -r.strain_rate; }));
    double largest = 0;
    for (const Response& r : rows)
      largest = std::max(largest, std::abs(r.force));
    columns.push_back(column("creep_compliance_per_GPa", "1/GPa", rows, [&](const Response& r) {
      return std::abs(r.force) > 1e-9 * largest ? r.strain / (r.force / area) * 1e9 : nan;
    }));
    columns.push_back(column("elastic_modulus_MPa", "MPa", rows, [&](const Response& r) {
      return r.compliance > 0 ? length / (area * r.compliance) / 1e6 : nan;
    }));
  } else {
    columns.push_back(column("load_factor", "1", rows, [](const Response& r) { return r.force; }));
    columns.push_back(column("mean_displacement_mm", "mm", rows,
                             [&](const Response& r) { return 1e3 * r.strain * face.length; }));
  }
  columns.push_back(column("strength_factor", "1", rows, [](const Response& r) {
    return std::isfinite(r.strength_factor) ? r.strength_factor : nan;
  }));
  columns.push_back(
      column("broken_bonds", "1", rows, [](const Response& r) { return double(r.n_broken); }));
  return columns;
}

std::vector<Column> breakage_columns(const dem::Assembly& assembly,
                                     const std::vector<dem::Breakage>& breakages)
{
  using dem::Breakage;
  const auto& ends = assembly.bonds.ends;
  const auto centre = [&](const Breakage& b, int k) {
    return 500 * (assembly.particles.centre[ends[b.bond][0]][k] +
                  assembly.particles.centre[ends[b.bond][1]][k]);
  };
  return {
      column("time_s", "s", breakages, [](const Breakage& b) { return b.time; }),
      column("pass", "1", breakages, [](const Breakage& b) { return double(b.pass); }),
      column("bond", "1", breakages, [](const Breakage& b) { return double(b.bond); }),
      column("first_particle", "1", breakages,
             [&](const Breakage& b) { return double(ends[b.bond][0]); }),
      column("second_particle", "1", breakages,
             [&](const Breakage& b) { return double(ends[b.bond][1]); }),
      column("shear_mode", "1", breakages,
             [](const Breakage& b) { return double(b.mode == dem::BreakMode::shear); }),
      column("tensile_force_N", "N", breakages, [](const Breakage& b) { return b.normal_force; }),
      column("shear_force_N", "N", breakages, [](const Breakage& b) { return b.shear_force; }),
      column("strength_factor", "1", breakages,
             [](const Breakage& b) { return b.strength_factor; }),
      column("axial_strain_percent", "%", breakages,
             [](const Breakage& b) { return -100 * b.strain; }),
      column("x_mm", "mm", breakages, [&](const Breakage& b) { return centre(b, 0); }),
      column("y_mm", "mm", breakages, [&](const Breakage& b) { return centre(b, 1); }),
      column("z_mm", "mm", breakages, [&](const Breakage& b) { return centre(b, 2); }),
  };
}

std::vector<Column> particle_columns(const dem::Particles& particles, const Snapshot& snapshot)
{
  std::vector<Column> columns;
  Column number{"particle", "1", {}}, radius{"r_mm", "mm", {}};
  for (std::size_t i = 0; i < particles.size(); ++i) {
    number.values.push_back(double(i));
    radius.values.push_back(1e3 * particles.radius[i]);
  }
  columns.push_back(number);
  add_components(columns, {"x_mm", "y_mm", "z_mm"}, "mm", particles.centre, 1e3);
  columns.push_back(radius);
  add_components(columns, {"ux_mm", "uy_mm", "uz_mm"}, "mm", snapshot.displacement, 1e3);
  add_components(columns, {"rotation_x_rad", "rotation_y_rad", "rotation_z_rad"}, "rad",
                 snapshot.rotation, 1);
  return columns;
}

std::vector<Column> bond_columns(const std::vector<std::array<dem::Index, 2>>& ends,
                                 const Snapshot& snapshot)
{
  std::vector<Column> columns;
  Column number{"bond", "1", {}}, first{"first_particle", "1", {}},
      second{"second_particle", "1", {}}, state{"state", "1", {}};
  for (std::size_t b = 0; b < ends.size(); ++b) {
    number.values.push_back(double(b));
    first.values.push_back(double(ends[b][0]));
    second.values.push_back(double(ends[b][1]));
    state.values.push_back(double(snapshot.state[b]));
  }
  columns = {number, first, second, state};
  add_components(columns, {"force_x_N", "force_y_N", "force_z_N"}, "N", snapshot.force, 1);
  add_components(columns, {"moment_x_N_m", "moment_y_N_m", "moment_z_N_m"}, "N m", snapshot.moment,
                 1);
  return columns;
}

std::string csv(const std::vector<Column>& columns)
{
  std::string text;
  for (std::size_t c = 0; c < columns.size(); ++c)
    text += (c ? "," : "") + columns[c].name;
  text += '\n';
  const std::size_t n = columns.empty() ? 0 : columns[0].values.size();
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double value = columns[c].values[row];
      text += c ? "," : "";
      if (!std::isnan(value)) // an empty cell: not defined
        text += fmt::format("{}", value == 0 ? 0.0 : value);
    }
    text += '\n';
  }
  return text;
}

void write_columns(dem::Hdf5File& file, const std::string& group,
                   const std::vector<Column>& columns)
{
  std::string names;
  for (const Column& column : columns) {
    file.write(group + "/" + column.name, column.values, column.unit);
    names += (names.empty() ? "" : ",") + column.name;
  }
  file.set_attribute(group, "columns", names); // HDF5 sorts its members
}

std::vector<Column> stored_columns(const dem::Hdf5File& file, const std::string& group)
{
  std::vector<Column> columns;
  for (const std::string& name : split(file.text_attribute(group, "columns"), ','))
    columns.push_back({name, file.text_attribute(group + "/" + name, "unit"),
                       file.read_doubles(group + "/" + name)});
  return columns;
}

void write_snapshot(dem::Hdf5File& file, const std::string& group, const Snapshot& snapshot)
{
  file.write(group + "/displacement", flat(snapshot.displacement), "m", 3);
  file.write(group + "/rotation", flat(snapshot.rotation), "rad", 3);
  file.write(group + "/bond_force", flat(snapshot.force), "N", 3);
  file.write(group + "/bond_moment", flat(snapshot.moment), "N m", 3);
  file.write(group + "/bond_state", snapshot.state);
  file.set_attribute(group, "time_s", snapshot.time);
  file.set_attribute(group + "/bond_state", "meaning",
                     std::string("0 intact, 1 pressed contact, 2 gone"));
}

Snapshot read_snapshot(const dem::Hdf5File& file, const std::string& group)
{
  return {file.number_attribute(group, "time_s"),
          vectors(file.read_doubles(group + "/displacement")),
          vectors(file.read_doubles(group + "/rotation")),
          vectors(file.read_doubles(group + "/bond_force")),
          vectors(file.read_doubles(group + "/bond_moment")),
          file.read_bytes(group + "/bond_state")};
}

void write_record(dem::Hdf5File& file, const std::string& group, const RunRecord& record)
{
  std::vector<double> rows;
  for (const dem::Response& r : record.history)
    rows.insert(rows.end(), {r.time, r.force, r.strain, r.strain_rate, r.strength_factor,
                             r.compliance, double(r.n_broken)});
  file.write(group + "/responses", rows, "SI", 7);
  file.set_attribute(group, "n_snapshots", double(record.snapshots.size()));
  for (std::size_t k = 0; k < record.snapshots.size(); ++k)
    write_snapshot(file, fmt::format("{}/snapshots/{:04}", group, k), record.snapshots[k]);
}

RunRecord read_record(const dem::Hdf5File& file, const std::string& group)
{
  RunRecord record;
  const std::vector<double> rows = file.read_doubles(group + "/responses");
  for (std::size_t k = 0; k + 6 < rows.size(); k += 7)
    record.history.push_back({rows[k], rows[k + 1], rows[k + 2], rows[k + 3], rows[k + 4],
                              rows[k + 5], long(rows[k + 6])});
  const auto n = int(file.number_attribute(group, "n_snapshots"));
  for (int k = 0; k < n; ++k)
    record.snapshots.push_back(read_snapshot(file, fmt::format("{}/snapshots/{:04}", group, k)));
  return record;
}

} // namespace apps
