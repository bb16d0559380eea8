#include "apps/paraview.h"

#include "apps/files.h"

#include <fmt/format.h>

#include <cstring>
#include <span>
#include <type_traits>

namespace apps {

namespace {

std::string base64(std::span<const unsigned char> bytes)
{
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - k);
    unsigned triple = 0;
    for (std::size_t j = 0; j < 3; ++j)
      triple = triple << 8 | (j < n ? bytes[k + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += j <= n ? digits[triple >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

/// A data array of the VTK XML formats: length in bytes, then the numbers, as base64.
template <typename T>
std::string data_array(const std::string& name, const std::vector<T>& values, int components)
{
  const std::string type = std::is_same_v<T, double>         ? "Float64"
                           : std::is_same_v<T, std::int64_t> ? "Int64"
                                                             : "UInt8";
  std::vector<unsigned char> bytes(8 + values.size() * sizeof(T));
  const std::uint64_t length = values.size() * sizeof(T);
  std::memcpy(bytes.data(), &length, 8);
  if (!values.empty())
    std::memcpy(bytes.data() + 8, values.data(), length);
  return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                     "format=\"binary\">{}</DataArray>\n",
                     type, name, components, base64(bytes));
}

std::vector<double> flat(const std::vector<dem::Vec3>& vectors)
{
  std::vector<double> numbers;
  for (const dem::Vec3& v : vectors)
    numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
  return numbers;
}

std::vector<dem::Vec3> displaced(const dem::Particles& particles, const Snapshot& snapshot)
{
  std::vector<dem::Vec3> points = particles.centre;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] += snapshot.displacement[i];
  return points;
}

/// Cells of k points each, listed one after the other.
std::string cells(const std::string& kind, const std::vector<std::int64_t>& connectivity, int k)
{
  std::vector<std::int64_t> offsets;
  for (std::size_t end = std::size_t(k); end <= connectivity.size(); end += std::size_t(k))
    offsets.push_back(std::int64_t(end));
  return fmt::format("<{}>\n{}{}</{}>\n", kind, data_array("connectivity", connectivity, 1),
                     data_array("offsets", offsets, 1), kind);
}

std::string poly_data(std::size_t n_points, const std::string& counts, const std::string& content)
{
  return fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
                     "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<Piece "
                     "NumberOfPoints=\"{}\" {}>\n{}</Piece>\n</PolyData>\n</VTKFile>\n",
                     n_points, counts, content);
}

std::string particle_file(const dem::Particles& particles, const Snapshot& snapshot)
{
  std::vector<std::int64_t> number(particles.size());
  for (std::size_t i = 0; i < number.size(); ++i)
    number[i] = std::int64_t(i);
  const std::string content = "<PointData>\n" + data_array("radius_m", particles.radius, 1) +
                              data_array("displacement_m", flat(snapshot.displacement), 3) +
                              data_array("rotation_rad", flat(snapshot.rotation), 3) +
                              data_array("particle", number, 1) + "</PointData>\n<Points>\n" +
                              data_array("points", flat(displaced(particles, snapshot)), 3) +
                              "</Points>\n" + cells("Verts", number, 1);
  return poly_data(particles.size(), fmt::format("NumberOfVerts=\"{}\"", particles.size()),
                   content);
}

std::string bond_file(const dem::Assembly& assembly, const Snapshot& snapshot)
{
  std::vector<std::int64_t> ends;
  std::vector<double> tension;
  for (std::size_t b = 0; b < assembly.bonds.size(); ++b) {
    const auto [i, j] = assembly.bonds.ends[b];
    ends.insert(ends.end(), {i, j});
    const dem::Vec3 n = (assembly.particles.centre[j] - assembly.particles.centre[i]).normalized();
    tension.push_back(snapshot.force[b].dot(n));
  }
  const std::string content =
      "<CellData>\n" + data_array("force_N", flat(snapshot.force), 3) +
      data_array("tensile_force_N", tension, 1) +
      data_array("moment_N_m", flat(snapshot.moment), 3) + data_array("state", snapshot.state, 1) +
      "</CellData>\n<Points>\n" +
      data_array("points", flat(displaced(assembly.particles, snapshot)), 3) + "</Points>\n" +
      cells("Lines", ends, 2);
  return poly_data(assembly.particles.size(),
                   fmt::format("NumberOfLines=\"{}\"", assembly.bonds.size()), content);
}

std::string collection(const std::string& stem, const std::vector<Snapshot>& snapshots)
{
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n"
                     "<Collection>\n";
  for (std::size_t k = 0; k < snapshots.size(); ++k)
    text += fmt::format("<DataSet timestep=\"{}\" file=\"{}_{:04}.vtp\"/>\n", snapshots[k].time,
                        stem, k);
  return text + "</Collection>\n</VTKFile>\n";
}

} // namespace

void write_paraview(const std::filesystem::path& folder, const dem::Assembly& assembly,
                    const std::vector<Snapshot>& snapshots)
{
  std::filesystem::create_directories(folder);
  for (const auto& old : std::filesystem::directory_iterator(folder))
    if (old.path().extension() == ".vtp") // of a run before
      std::filesystem::remove(old.path());
  for (std::size_t k = 0; k < snapshots.size(); ++k) {
    write_text_file(folder / fmt::format("particles_{:04}.vtp", k),
                    particle_file(assembly.particles, snapshots[k]));
    write_text_file(folder / fmt::format("bonds_{:04}.vtp", k), bond_file(assembly, snapshots[k]));
  }
  write_text_file(folder / "particles.pvd", collection("particles", snapshots));
  write_text_file(folder / "bonds.pvd", collection("bonds", snapshots));
}

} // namespace apps
