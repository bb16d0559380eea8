#include "fem/probes.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_dgq.h>
#include <deal.II/grid/grid_tools.h>

#include <fmt/format.h>

#include <stdexcept>

namespace fem {

namespace {

/// A place in the coordinates of a body: of a meridian section, radius and height.
template <int dim>
dealii::Point<dim> point_of(const Vec3& place)
{
  if constexpr (dim == 3)
    return {place[0], place[1], place[2]};
  else
    return {std::hypot(place[0], place[1]), place[2]};
}

/// Shares of the points of a cell in the value at a place.
template <int dim>
std::vector<double> point_weights(const Elements<dim>& elements, const dealii::Point<dim>& unit,
                                  std::size_t cell)
{
  const std::size_t n_q = elements.points_per_cell();
  std::vector<double> weights;
  if (elements.dofs().get_fe().reference_cell().is_simplex()) {
    double volume = 0;
    for (std::size_t q = 0; q < n_q; ++q)
      volume += elements.weights()[cell * n_q + q];
    for (std::size_t q = 0; q < n_q; ++q)
      weights.push_back(elements.weights()[cell * n_q + q] / volume);
    return weights;
  }
  const dealii::FE_DGQArbitraryNodes<dim> polynomial(
      dealii::QGauss<1>(unsigned(elements.discretisation().order) + 1));
  for (unsigned q = 0; q < n_q; ++q)
    weights.push_back(polynomial.shape_value(q, unit));
  return weights;
}

} // namespace

template <int dim>
Probes<dim>::Probes(const Specimen<dim>& specimen, const std::vector<Vec3>& places)
    : places_(places.size())
{
  const Elements<dim>& elements = specimen.elements();
  const auto& handler = elements.dofs();
  const auto& element = handler.get_fe();
  std::vector<std::size_t> own(handler.get_triangulation().n_active_cells(), 0);
  std::size_t n_own = 0;
  for (const auto& cell : handler.active_cell_iterators())
    if (cell->is_locally_owned())
      own[cell->active_cell_index()] = n_own++;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const dealii::Point<dim> point = point_of<dim>(places[k]);
    const unsigned me = dealii::Utilities::MPI::this_mpi_process(elements.ranks());
    unsigned owner = std::numeric_limits<unsigned>::max();
    std::pair<typename dealii::DoFHandler<dim>::active_cell_iterator, dealii::Point<dim>> found;
    try {
      found = dealii::GridTools::find_active_cell_around_point(elements.mapping(), handler, point);
      if (found.first.state() == dealii::IteratorState::valid && found.first->is_locally_owned())
        owner = me;
    } catch (const dealii::ExceptionBase&) { // not in the cells that this rank knows
    }
    const unsigned first = dealii::Utilities::MPI::min(owner, elements.ranks());
    if (first == std::numeric_limits<unsigned>::max())
      throw std::invalid_argument(fmt::format("the probe at ({:g}, {:g}, {:g}) mm is not in the "
                                              "body",
                                              1e3 * places[k][0], 1e3 * places[k][1],
                                              1e3 * places[k][2]));
    if (first != me)
      continue;
    Place place{own[found.first->active_cell_index()], {}, {}};
    for (unsigned i = 0; i < element.n_dofs_per_cell(); ++i)
      place.shapes.push_back(element.shape_value_component(
          i, found.second, element.system_to_component_index(i).first));
    place.weights = point_weights(elements, found.second, place.cell);
    places_[k] = std::move(place);
  }
}

template <int dim>
std::vector<ProbeReading> Probes<dim>::read(const Specimen<dim>& specimen,
                                            const MaterialPoints& points) const
{
  constexpr std::size_t n = 15;
  const Elements<dim>& elements = specimen.elements();
  const auto& element = elements.dofs().get_fe();
  std::vector<double> numbers(n * places_.size(), 0);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (!places_[k])
      continue;
    const Place& place = *places_[k];
    const auto& dofs = elements.cell_dofs(place.cell);
    for (unsigned i = 0; i < dofs.size(); ++i) {
      const unsigned component = element.system_to_component_index(i).first;
      numbers[n * k + (dim == 2 && component == 1 ? 2 : component)] +=
          place.shapes[i] * specimen.displacement()(dofs[i]);
    }
    const std::size_t n_q = elements.points_per_cell();
    for (std::size_t q = 0; q < n_q; ++q)
      for (int c = 0; c < 6; ++c) {
        numbers[n * k + 3 + c] += place.weights[q] * points.strain()[place.cell * n_q + q][c];
        numbers[n * k + 9 + c] += place.weights[q] * points.stress()[place.cell * n_q + q][c];
      }
  }
  dealii::Utilities::MPI::sum(numbers, elements.ranks(), numbers);
  std::vector<ProbeReading> readings(places_.size());
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const double* const from = &numbers[n * k];
    readings[k] = {Eigen::Map<const Vec3>(from), Eigen::Map<const Vec6>(from + 3),
                   Eigen::Map<const Vec6>(from + 9)};
  }
  return readings;
}

template class Probes<2>;
template class Probes<3>;

} // namespace fem
