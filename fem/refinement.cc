#include "fem/refinement.h"

#include "fem/cell_states.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/grid_refinement.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/fe_dgq.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/numerics/error_estimator.h>

#include <boost/range/iterator_range.hpp>

#include <cstring>
#include <stdexcept>

namespace fem {

namespace {

using Numbers = std::vector<double>;

/// Values at the points of each child from those at the points of its parent, by the polynomial
/// through them.
template <int dim>
std::vector<dealii::FullMatrix<double>> to_children(const dealii::Quadrature<dim>& quadrature,
                                                    int order)
{
  const dealii::FE_DGQArbitraryNodes<dim> polynomial(dealii::QGauss<1>(unsigned(order) + 1));
  std::vector<dealii::FullMatrix<double>> result;
  for (unsigned child = 0; child < dealii::GeometryInfo<dim>::max_children_per_cell; ++child) {
    dealii::FullMatrix<double> values(quadrature.size(), quadrature.size());
    for (unsigned q = 0; q < quadrature.size(); ++q)
      for (unsigned j = 0; j < quadrature.size(); ++j)
        values(q, j) = polynomial.shape_value(
            j, dealii::GeometryInfo<dim>::child_to_cell_coordinates(quadrature.point(q), child));
    result.push_back(values);
  }
  return result;
}

/// The state of a child from that of its parent.
template <int dim>
Numbers child_state(const Numbers& parent, const dealii::FullMatrix<double>& displacements,
                    const dealii::FullMatrix<double>& points)
{
  const unsigned n_dofs = displacements.m(), n_q = points.m();
  const std::size_t n = (parent.size() - n_dofs) / n_q;
  Numbers child(parent.size(), 0);
  for (unsigned i = 0; i < n_dofs; ++i)
    for (unsigned j = 0; j < n_dofs; ++j)
      child[i] += displacements(i, j) * parent[j];
  for (unsigned q = 0; q < n_q; ++q)
    for (unsigned j = 0; j < n_q; ++j)
      for (std::size_t k = 0; k < n; ++k)
        child[n_dofs + q * n + k] += points(q, j) * parent[n_dofs + j * n + k];
  return child;
}

} // namespace

template <int dim>
std::vector<Numbers> refine(const Mesh<dim>& mesh, const Specimen<dim>& specimen,
                            const MaterialPoints& points, double share)
{
  using Cells = dealii::parallel::distributed::Triangulation<dim>;
  auto* const cells = dynamic_cast<Cells*>(mesh.cells.get());
  if (cells == nullptr)
    throw std::invalid_argument("a mesh of simplices cannot be refined adaptively");
  const Elements<dim>& elements = specimen.elements();
  dealii::Vector<float> indicator(mesh.cells->n_active_cells());
  dealii::KellyErrorEstimator<dim>::estimate(
      elements.mapping(), elements.dofs(),
      dealii::QGauss<dim - 1>(unsigned(elements.discretisation().order) + 1), {},
      specimen.displacement(), indicator);
  dealii::parallel::distributed::GridRefinement::refine_and_coarsen_fixed_number(*cells, indicator,
                                                                                 share, 0);

  const std::vector<Numbers> before = cell_states(specimen, points);
  std::vector<std::size_t> own(mesh.cells->n_active_cells());
  std::size_t n_own = 0;
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned())
      own[cell->active_cell_index()] = n_own++;
  cells->prepare_coarsening_and_refinement();
  const unsigned handle = cells->register_data_attach(
      [&](const typename Cells::cell_iterator& cell, typename Cells::CellStatus) {
        const Numbers& numbers = before[own[cell->active_cell_index()]];
        std::vector<char> bytes(numbers.size() * sizeof(double));
        std::memcpy(bytes.data(), numbers.data(), bytes.size());
        return bytes;
      },
      false);
  const dealii::FiniteElement<dim>& element = elements.dofs().get_fe();
  const auto to_child = to_children(elements.quadrature(), elements.discretisation().order);
  cells->execute_coarsening_and_refinement();

  std::map<dealii::CellId, Numbers> after;
  cells->notify_ready_to_unpack(
      handle, [&](const typename Cells::cell_iterator& cell, typename Cells::CellStatus status,
                  const boost::iterator_range<std::vector<char>::const_iterator>& bytes) {
        Numbers numbers(std::size_t(bytes.size()) / sizeof(double));
        std::memcpy(numbers.data(), &*bytes.begin(), numbers.size() * sizeof(double));
        if (status == Cells::CELL_PERSIST)
          after[cell->id()] = std::move(numbers);
        else
          for (unsigned child = 0; child < cell->n_children(); ++child)
            after[cell->child(child)->id()] =
                child_state<dim>(numbers, element.get_prolongation_matrix(child), to_child[child]);
      });
  std::vector<Numbers> states;
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned())
      states.push_back(std::move(after.at(cell->id())));
  return states;
}

template std::vector<Numbers> refine(const Mesh<2>&, const Specimen<2>&, const MaterialPoints&,
                                     double);
template std::vector<Numbers> refine(const Mesh<3>&, const Specimen<3>&, const MaterialPoints&,
                                     double);

} // namespace fem
