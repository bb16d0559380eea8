#include "fem/mesh.h"

#include "bodies.h"
#include "fem/probes.h"

#include <deal.II/grid/grid_tools.h>

#include <fstream>
#include <numbers>
#include <unistd.h>

using namespace fem;
using bodies::ranks;

namespace {

using std::numbers::pi;

template <int dim>
double area(const Mesh<dim>& mesh, const Elements<dim>& elements, const std::string& name)
{
  return elements.boundary_area(boundary_id(mesh, name));
}

/// Volume and areas of boundaries that a shape must have.
template <int dim>
struct Shape {
  std::string name;
  std::function<Mesh<dim>(const Fineness&)> make;
  double cell_size, volume;
  std::map<std::string, double> areas;
};

/// Relative error of volume and areas; all boundaries must be named in the shape.
template <int dim>
double error(const Shape<dim>& shape, const Fineness& fineness, int order)
{
  const Mesh<dim> mesh = shape.make(fineness);
  const Elements<dim> elements(mesh, {order});
  double worst = std::abs(elements.volume() / shape.volume - 1);
  EXPECT_EQ(mesh.boundaries.size(), shape.areas.size()) << shape.name;
  for (const auto& [name, exact] : shape.areas)
    worst = std::max(worst, std::abs(area(mesh, elements, name) / exact - 1));
  return worst;
}

const double strip_arc = 0.1 * std::asin(0.0127 / 0.1);

const std::vector<Shape<3>> round_shapes{
    {"cylinder",
     [](const Fineness& f) { return cylinder(ranks, 0.1, 0.2, f); },
     0.05,
     pi * 0.0025 * 0.2,
     {{"bottom", pi * 0.0025}, {"top", pi * 0.0025}, {"side", pi * 0.1 * 0.2}}},
    {"hollow cylinder",
     [](const Fineness& f) { return hollow_cylinder(ranks, 0.2, 0.1, 0.1, f); },
     0.05,
     pi * 0.0075 * 0.1,
     {{"bottom", pi * 0.0075},
      {"top", pi * 0.0075},
      {"side", pi * 0.2 * 0.1},
      {"inner", pi * 0.1 * 0.1}}},
    {"disc",
     [](const Fineness& f) { return strip_loaded_disc(ranks, 0.1, 0.05, 0.0127, f); },
     0.02,
     pi * 0.0025 * 0.05,
     {{"bottom", strip_arc * 0.05},
      {"top", strip_arc * 0.05},
      {"rim", (pi * 0.1 - 2 * strip_arc) * 0.05},
      {"front", pi * 0.0025},
      {"back", pi * 0.0025}}},
    {"hollow sphere",
     [](const Fineness& f) { return hollow_sphere(ranks, 0.2, 0.1, f); },
     0.05,
     pi / 6 * (0.001 - 0.000125),
     {{"inner", pi / 2 * 0.0025},
      {"side", pi / 2 * 0.01},
      {"left", pi / 4 * 0.0075},
      {"front", pi / 4 * 0.0075},
      {"bottom", pi / 4 * 0.0075}}}};

/// Why something is refused.
std::string refusal(const std::function<void()>& action)
{
  try {
    action();
  } catch (const std::invalid_argument& problem) {
    return problem.what();
  }
  return "accepted";
}

/// A file with a text, one per rank.
struct TextFile {
  std::filesystem::path path;

  explicit TextFile(const std::string& text)
      : path(std::filesystem::temp_directory_path() /
             ("mesh-" + std::to_string(getpid()) + "-" +
              std::to_string(dealii::Utilities::MPI::this_mpi_process(ranks)) + ".msh"))
  {
    std::ofstream(path) << text;
  }
  ~TextFile() { std::filesystem::remove(path); }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
};

/// Two cubes of edge 10 above one another in format 2.2: named regions, and sides of which two have
/// names.
const std::string two_cubes = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 "foot"
2 2 "upper platen"
3 7 "stone"
3 8 "mastic film"
$EndPhysicalNames
$Nodes
12
1 0 0 0
2 10 0 0
3 10 10 0
4 0 10 0
5 0 0 10
6 10 0 10
7 10 10 10
8 0 10 10
9 0 0 20
10 10 0 20
11 10 10 20
12 0 10 20
$EndNodes
$Elements
5
1 3 2 1 1 1 2 3 4
2 3 2 2 2 9 10 11 12
3 3 2 5 3 1 2 6 5
4 5 2 7 1 1 2 3 4 5 6 7 8
5 5 2 8 2 5 6 7 8 9 10 11 12
$EndElements
)";

/// A square of two triangles in format 4.1.
const std::string two_triangles = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "bottom"
1 2 "top"
2 3 "body"
$EndPhysicalNames
$Entities
0 2 1 0
1 0 0 0 1 0 0 1 1 0
2 0 1 0 1 1 0 1 2 0
1 0 0 0 1 1 0 1 3 2 1 2
$EndEntities
$Nodes
1 4 1 4
2 1 0 4
1
2
3
4
0 0 0
1 0 0
1 1 0
0 1 0
$EndNodes
$Elements
3 4 1 4
1 1 1 1
1 1 2
1 2 1 1
2 3 4
2 1 2 2
3 1 2 3
4 1 3 4
$EndElements
)";

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

} // namespace

TEST(Shapes, FlatSidesAreExact)
{
  for (const bool simplices : {false, true}) {
    const Shape<3> block{
        "box",
        [](const Fineness& f) {
          return box(ranks, {1, 2, 3}, f);
        },
        0.7,
        6,
        {{"left", 6}, {"right", 6}, {"front", 3}, {"back", 3}, {"bottom", 2}, {"top", 2}}};
    EXPECT_LE(error(block, {0.7, 1, simplices}, 1), 1e-12);
    const Shape<2> tube{
        "section",
        [](const Fineness& f) { return meridian(ranks, 4, 2, 3, f); },
        0.7,
        9 * pi,
        {{"inner", 6 * pi}, {"side", 12 * pi}, {"bottom", 3 * pi}, {"top", 3 * pi}}};
    EXPECT_LE(error(tube, {0.7, 1, simplices}, 1), 1e-12);
  }
  const Mesh<2> full = meridian(ranks, 4, 0, 3, {1});
  EXPECT_NEAR(Elements<2>(full, {1}).volume(), 12 * pi, 1e-12);
  EXPECT_EQ(full.boundaries.count("axis"), 1U);
}

TEST(Shapes, RoundSidesConvergeAndKeepRoundWhenRefined)
{
  for (const auto& shape : round_shapes)
    for (const bool simplices : {false, true}) {
      const double coarse = error(shape, {shape.cell_size, 0, simplices}, 1);
      const double fine = error(shape, {shape.cell_size, 1, simplices}, 1);
      EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3) << shape.name << simplices;
      if (!simplices) { // edges of tetrahedra stay straight where cells reach the axis
        EXPECT_LE(error(shape, {shape.cell_size, 1}, 2), 2e-4) << shape.name;
      }
    }
}

TEST(Shapes, CellsAreNoLargerThanWanted)
{
  for (const auto& shape : round_shapes) {
    const Mesh<3> mesh = shape.make({shape.cell_size / 2});
    const double largest = dealii::GridTools::maximal_cell_diameter(*mesh.cells);
    EXPECT_LE(largest, std::sqrt(3) * 1.3 * shape.cell_size / 2) << shape.name;
  }
}

TEST(Shapes, StripsOfADiscHaveTheirWidthAndPlace)
{
  for (const double width : {0.005, 0.0127, 0.03}) {
    const Mesh<3> mesh = strip_loaded_disc(ranks, 0.1, 0.05, width, {0.01});
    for (const auto& [name, height] : {std::pair{"bottom", 0.}, std::pair{"top", 0.1}}) {
      double widest = 0, off = 0;
      for (const auto& cell : mesh.cells->active_cell_iterators())
        if (cell->is_locally_owned())
          for (const auto& face : cell->face_iterators())
            if (face->at_boundary() && face->boundary_id() == boundary_id(mesh, name))
              for (unsigned v = 0; v < face->n_vertices(); ++v) {
                const auto p = face->vertex(v);
                widest = std::max(widest, 2 * std::abs(p[0]));
                off = std::max(off, std::abs(p[2] - height));
              }
      EXPECT_NEAR(dealii::Utilities::MPI::max(widest, ranks), width, 1e-12) << name;
      EXPECT_NEAR(dealii::Utilities::MPI::max(off, ranks),
                  0.05 - std::sqrt(0.0025 - width * width / 4), 1e-12)
          << name;
    }
    const auto [low, high] = extent(mesh);
    EXPECT_NEAR(low[2], 0, 1e-12);
    EXPECT_NEAR(high[2], 0.1, 1e-12);
    EXPECT_NEAR(high[1] - low[1], 0.05, 1e-12);
  }
}

TEST(Shapes, UnknownBoundariesAndPlacesAndOrdersAreRefused)
{
  const Mesh<3> mesh = box(ranks, {1, 1, 1}, {0.5});
  EXPECT_EQ(refusal([&] { boundary_id(mesh, "lid"); }),
            "the body has no boundary 'lid'; its boundaries are: back, bottom, front, left, right, "
            "top");
  EXPECT_NE(refusal([&] { Elements<3>(mesh, {4}); }).find("have the orders 1 to 3"),
            std::string::npos);
  const Specimen<3> body(mesh, {1}, {}, 1e-8);
  for (const Vec3& outside : {Vec3(0.5, 0.5, 1.01), Vec3(7, 0, 0)})
    EXPECT_NE(refusal([&] { Probes<3>(body, {outside}); }).find("is not in the body"),
              std::string::npos);
  EXPECT_NE(refusal([&] {
              make_supports<3>(mesh, body.elements(),
                               {{"top", {0, 0, 0}}, {"top", {std::nullopt, 1, std::nullopt}}});
            }).find("the displacement y of boundary 'top' is held twice"),
            std::string::npos);
}

TEST(GmshMesh, ReadsNamesAndRegionsOfFormat22)
{
  const TextFile file(two_cubes);
  const Mesh<3> mesh = gmsh_mesh<3>(ranks, file.path, 1e-3, 1);
  EXPECT_FALSE(mesh.simplices);
  EXPECT_EQ(mesh.cells->n_global_active_cells(), 16U);
  const Elements<3> elements(mesh, {1});
  EXPECT_NEAR(elements.volume(), 2e-6, 1e-18);
  EXPECT_NEAR(area(mesh, elements, "foot"), 1e-4, 1e-16);
  EXPECT_NEAR(area(mesh, elements, "upper platen"), 1e-4, 1e-16);
  EXPECT_NEAR(area(mesh, elements, "5"), 1e-4, 1e-16);
  ASSERT_EQ(mesh.regions.size(), 2U);
  double stone = 0;
  const auto regions = elements.regions();
  for (std::size_t q = 0; q < regions.size(); ++q)
    stone += regions[q] == mesh.regions.at("stone") ? elements.weights()[q] : 0;
  EXPECT_NEAR(dealii::Utilities::MPI::sum(stone, ranks), 1e-6, 1e-18);
  EXPECT_EQ(mesh.regions.count("mastic film"), 1U);
}

TEST(GmshMesh, ReadsFormat41)
{
  const TextFile file(two_triangles);
  const Mesh<2> mesh = gmsh_mesh<2>(ranks, file.path, 2, 2);
  EXPECT_TRUE(mesh.simplices);
  EXPECT_EQ(mesh.cells->n_global_active_cells(), 32U);
  const Elements<2> elements(mesh, {2});
  EXPECT_NEAR(elements.volume(), 8 * pi, 1e-12);
  EXPECT_NEAR(area(mesh, elements, "bottom"), 4 * pi, 1e-12);
  EXPECT_NEAR(area(mesh, elements, "top"), 4 * pi, 1e-12);
  EXPECT_EQ(mesh.regions.at("body"), 3U);
}

TEST(GmshMesh, RefusesWhatItCannotUse)
{
  const auto refused3 = [](const std::string& text) {
    const TextFile file(text);
    return refusal([&] { gmsh_mesh<3>(ranks, file.path, 1, 0); });
  };
  const auto refused2 = [](const std::string& text) {
    const TextFile file(text);
    return refusal([&] { gmsh_mesh<2>(ranks, file.path, 1, 0); });
  };
  EXPECT_EQ(refusal([] { gmsh_mesh<3>(ranks, "/no/such.msh", 1, 0); }),
            "mesh /no/such.msh: cannot be read");
  const std::string empty = two_cubes.substr(0, two_cubes.find("$Elements"));
  for (const std::string& text :
       {std::string("hello\n"), std::string(), empty, empty + "$Elements\n0\n$EndElements\n",
        two_triangles, replaced(two_cubes, "2.2 0 8", "9.9 0 8"),
        replaced(two_cubes, "2.2 0 8", "2.2 1 8"),
        replaced(two_cubes, "5 2 7 1 1 2 3 4 5 6 7 8", "5 2 7 1 1 2 3 4 5 6 7 99"),
        two_cubes.substr(0, two_cubes.find("4 5 2 7"))}) {
    const std::string reason = refused3(text);
    EXPECT_EQ(reason.substr(0, 5), "mesh ") << text;
  }
  EXPECT_NE(refused3(replaced(two_cubes, "2.2 0 8", "2.2 1 8")).find("a binary file"),
            std::string::npos);
  const std::string mixed = replaced(two_triangles, "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0",
                                     "$Nodes\n1 6 1 6\n2 1 0 6\n1\n2\n3\n4\n5\n6\n0 0 0");
  const std::string with_square =
      replaced(replaced(replaced(mixed, "0 1 0\n$EndNodes", "0 1 0\n2 0 0\n2 1 0\n$EndNodes"),
                        "$Elements\n3 4 1 4", "$Elements\n4 5 1 5"),
               "4 1 3 4\n$End", "4 1 3 4\n2 1 3 1\n5 2 5 6 3\n$End");
  EXPECT_NE(refused2(with_square).find("cells of one kind are needed"), std::string::npos);
  EXPECT_EQ(refused2(two_triangles), "accepted");
}
