#include "fem/mesh.h"
#include "fem/mesh_parts.h"

#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/grid_tools.h>
#include <fmt/format.h>

#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

namespace fem {

namespace {

/// A physical group of a Gmsh file.
struct PhysicalGroup {
  int dimension;
  int number;
  std::string name;
};

/// The named groups: the section $PhysicalNames.
std::vector<PhysicalGroup> named_groups(std::istream& stream)
{
  std::vector<PhysicalGroup> groups;
  std::string line;
  while (std::getline(stream, line))
    if (line.starts_with("$PhysicalNames"))
      break;
  std::getline(stream, line); // how many
  while (std::getline(stream, line) && !line.starts_with("$EndPhysicalNames")) {
    PhysicalGroup group;
    std::istringstream words(line);
    words >> group.dimension >> group.number;
    const std::size_t first = line.find('"'), last = line.rfind('"');
    if (words && first < last)
      groups.push_back({group.dimension, group.number, line.substr(first + 1, last - first - 1)});
  }
  return groups;
}

/// deal.II takes the format for granted where its assertions are off.
void check_format(const std::filesystem::path& file, std::istream& stream)
{
  std::string word, version, is_binary;
  stream >> word >> version >> is_binary;
  if (word != "$MeshFormat")
    return; // then it says what it found
  if (version != "2.2" && version != "4.1")
    throw std::invalid_argument(fmt::format(
        "mesh {}: Gmsh format {}; the formats 2.2 and 4.1 are read", file.string(), version));
  if (is_binary != "0")
    throw std::invalid_argument(fmt::format(
        "mesh {}: a binary file; text is read (Gmsh writes it with -format msh41)", file.string()));
}

/// Reads the cells, and refuses what the element code cannot use.
template <int dim>
void read_cells(const std::filesystem::path& file, dealii::Triangulation<dim>& whole)
{
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw std::invalid_argument(fmt::format("mesh {}: cannot be read", file.string()));
  check_format(file, stream);
  stream.clear();
  stream.seekg(0);
  try {
    dealii::GridIn<dim> reader(whole);
    reader.read_msh(stream);
  } catch (const std::exception& problem) {
    std::string reason = problem.what();
    if (const auto* known = dynamic_cast<const dealii::ExceptionBase*>(&problem)) {
      std::ostringstream words;
      known->print_info(words);
      reason = words.str();
    }
    for (char& c : reason)
      c = c == '\n' ? ' ' : c;
    throw std::invalid_argument(
        fmt::format("mesh {}: not a mesh of {} that can be used (Gmsh formats 2.2 and 4.1 are "
                    "read): {}",
                    file.string(), dim == 3 ? "solid cells" : "flat cells", reason));
  }
  if (whole.n_cells() == 0)
    throw std::invalid_argument(
        fmt::format("mesh {}: it has no cells of dimension {}", file.string(), dim));
  if (!whole.all_reference_cells_are_simplex() && !whole.all_reference_cells_are_hyper_cube())
    throw std::invalid_argument(
        fmt::format("mesh {}: cells of one kind are needed, hexahedra or tetrahedra (in a section: "
                    "quadrilaterals or triangles)",
                    file.string()));
}

} // namespace

template <int dim>
Mesh<dim> gmsh_mesh(MPI_Comm ranks, const std::filesystem::path& file, double scale,
                    int n_refinements)
{
  dealii::Triangulation<dim> whole;
  read_cells(file, whole);
  dealii::GridTools::scale(scale, whole);
  std::set<int> used;
  for (const auto id : whole.get_boundary_ids())
    used.insert(int(id));
  std::map<std::string, dealii::types::boundary_id> boundaries;
  std::map<std::string, dealii::types::material_id> regions;
  std::ifstream stream(file, std::ios::binary);
  for (const PhysicalGroup& group : named_groups(stream))
    if (group.dimension == dim - 1 && used.erase(group.number))
      boundaries[group.name] = dealii::types::boundary_id(group.number);
    else if (group.dimension == dim)
      regions[group.name] = dealii::types::material_id(group.number);
  for (const int number : used)
    boundaries[fmt::format("{}", number)] = dealii::types::boundary_id(number);
  Mesh<dim> mesh = distributed(ranks, whole, {0, n_refinements}, boundaries);
  mesh.regions = regions;
  return mesh;
}

template Mesh<2> gmsh_mesh(MPI_Comm, const std::filesystem::path&, double, int);
template Mesh<3> gmsh_mesh(MPI_Comm, const std::filesystem::path&, double, int);

} // namespace fem
