#include "apps/body_damage.h"

#include "apps/continuum_volumes.h"

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace apps {

namespace {

constexpr unsigned n_corners = 8;

/// Joins the lists of all ranks on the first one.
std::vector<double> gathered(MPI_Comm ranks, const std::vector<double>& own)
{
  std::vector<double> all;
  for (const std::vector<double>& part : dealii::Utilities::MPI::gather(ranks, own))
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

} // namespace

template <int dim>
BodyDamage body_damage(const fem::Elements<dim>& elements, const coupling::BreakingPoints& points)
{
  std::vector<double> vertices;
  for (const auto& cell : elements.dofs().active_cell_iterators())
    if (cell->is_locally_owned())
      for (unsigned k = 0; k < n_corners; ++k) {
        const auto& place = cell->vertex(std::min(k, cell->n_vertices() - 1));
        for (unsigned c = 0; c < 3; ++c)
          vertices.push_back(c < unsigned(dim) ? place[c] : 0);
      }
  BodyDamage damage{gathered(elements.ranks(), vertices),
                    volume_fields(points, elements.points_per_cell())};
  for (fem::CellField& field : damage.fields)
    field.values = gathered(elements.ranks(), field.values);
  return damage;
}

void write_damage(dem::Hdf5File& file, const BodyDamage& damage)
{
  file.write("damage/vertices", damage.vertices, "m", 3 * int(n_corners));
  for (const fem::CellField& field : damage.fields)
    file.write("damage/" + field.name, field.values, field.name.ends_with("_s") ? "s" : "1");
}

template BodyDamage body_damage(const fem::Elements<2>&, const coupling::BreakingPoints&);
template BodyDamage body_damage(const fem::Elements<3>&, const coupling::BreakingPoints&);

} // namespace apps
