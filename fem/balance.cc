#include "fem/balance.h"

#include "fem/cell_states.h"

#include <deal.II/base/mpi.h>
#include <deal.II/base/mpi.templates.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/grid/tria_description.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace fem {

namespace {

/// Fills one rank after the other up to a most cost, or with more where that is a single cell; the
/// last one takes the rest.
std::vector<int> filled(std::span<const double> costs, int n_ranks, double most)
{
  std::vector<int> ranks;
  int rank = 0;
  double load = 0;
  std::size_t first = 0; // cell of the rank
  for (std::size_t k = 0; k < costs.size(); ++k) {
    const bool is_full = k > first && load + costs[k] > most;
    const bool others_are_due = costs.size() - k == std::size_t(n_ranks - 1 - rank);
    if ((is_full || others_are_due) && rank + 1 < n_ranks) {
      ++rank;
      load = 0;
      first = k;
    }
    load += costs[k];
    ranks.push_back(rank);
  }
  return ranks;
}

std::vector<double> loads(std::span<const double> costs, std::span<const int> ranks, int n_ranks)
{
  std::vector<double> sums(std::size_t(n_ranks), 0.);
  for (std::size_t k = 0; k < costs.size(); ++k)
    sums[std::size_t(ranks[k])] += costs[k];
  return sums;
}

/// Middle and cost of each cell of all ranks, rank by rank.
template <int dim>
struct AllCells {
  std::vector<dealii::Point<dim>> middles;
  std::vector<double> costs;
  std::size_t first_own = 0;
};

template <int dim>
AllCells<dim> all_cells(const Mesh<dim>& mesh, std::span<const double> costs)
{
  std::vector<double> own;
  std::size_t k = 0;
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned()) {
      const auto middle = cell->center();
      own.insert(own.end(), middle.begin_raw(), middle.end_raw());
      own.push_back(costs[k++]);
    }
  const MPI_Comm ranks = mesh.cells->get_communicator();
  const auto gathered = dealii::Utilities::MPI::all_gather(ranks, own);
  AllCells<dim> all;
  for (std::size_t rank = 0; rank < gathered.size(); ++rank) {
    if (rank == dealii::Utilities::MPI::this_mpi_process(ranks))
      all.first_own = all.costs.size();
    for (auto from = gathered[rank].begin(); from != gathered[rank].end(); from += dim + 1) {
      all.middles.emplace_back();
      std::copy_n(from, dim, all.middles.back().begin_raw());
      all.costs.push_back(*(from + dim));
    }
  }
  return all;
}

/// The cells in the order of the curve.
template <int dim>
std::vector<std::size_t> along_curve(const std::vector<dealii::Point<dim>>& middles)
{
  constexpr int bits = 20; // of a coordinate
  const auto place = dealii::Utilities::inverse_Hilbert_space_filling_curve(middles, bits);
  std::vector<std::size_t> order(middles.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return place[a] < place[b]; });
  return order;
}

/// Names and states of cells on their way to a rank.
using Parcel = std::pair<std::vector<std::string>, std::vector<std::vector<double>>>;

/// The stored cells that a rank has after all have been sent to where they belong.
template <int dim>
StoredCells exchanged(const Mesh<dim>& mesh, const std::vector<int>& rank_of_cell,
                      std::vector<std::vector<double>> states)
{
  const MPI_Comm ranks = mesh.cells->get_communicator();
  const int me = int(dealii::Utilities::MPI::this_mpi_process(ranks));
  StoredCells mine;
  std::map<unsigned, Parcel> parcels;
  std::size_t k = 0;
  for (const auto& cell : mesh.cells->active_cell_iterators()) {
    if (!cell->is_locally_owned())
      continue;
    const int to = rank_of_cell[k];
    auto& names = to == me ? mine.names : parcels[unsigned(to)].first;
    auto& numbers = to == me ? mine.states : parcels[unsigned(to)].second;
    names.push_back(cell->id().to_string());
    numbers.push_back(std::move(states[k++]));
  }
  for (auto& [from, parcel] : dealii::Utilities::MPI::some_to_some(ranks, parcels)) {
    std::ranges::move(parcel.first, std::back_inserter(mine.names));
    std::ranges::move(parcel.second, std::back_inserter(mine.states));
  }
  return mine;
}

/// The same cells, each on its new rank.
template <int dim>
std::shared_ptr<dealii::parallel::TriangulationBase<dim>>
on_ranks(const dealii::parallel::TriangulationBase<dim>& cells,
         const std::vector<int>& rank_of_cell)
{
  dealii::LinearAlgebra::distributed::Vector<double> partition(
      cells.global_active_cell_index_partitioner().lock());
  std::size_t k = 0;
  for (const auto& cell : cells.active_cell_iterators())
    if (cell->is_locally_owned())
      partition(cell->global_active_cell_index()) = rank_of_cell[k++];
  partition.update_ghost_values();
  const auto description =
      dealii::TriangulationDescription::Utilities::create_description_from_triangulation(cells,
                                                                                         partition);
  auto moved = std::make_shared<dealii::parallel::fullydistributed::Triangulation<dim>>(
      cells.get_communicator());
  for (const auto id : cells.get_manifold_ids())
    if (id != dealii::numbers::flat_manifold_id)
      moved->set_manifold(id, cells.get_manifold(id));
  moved->create_triangulation(description);
  return moved;
}

} // namespace

double imbalance(std::span<const double> costs)
{
  const double sum = std::accumulate(costs.begin(), costs.end(), 0.);
  return sum > 0 ? std::ranges::max(costs) * double(costs.size()) / sum : 1;
}

std::vector<int> ranks_of_row(std::span<const double> costs, int n_ranks)
{
  if (costs.size() < std::size_t(n_ranks))
    throw std::invalid_argument(
        fmt::format("{} cells cannot be shared out over {} ranks", costs.size(), n_ranks));
  const double sum = std::accumulate(costs.begin(), costs.end(), 0.);
  double below = 0, most = sum;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (below + most);
    const auto each = loads(costs, filled(costs, n_ranks, middle), n_ranks);
    (std::ranges::max(each) <= middle ? most : below) = middle;
  }
  return filled(costs, n_ranks, most);
}

template <int dim>
Sharing new_sharing(const Mesh<dim>& mesh, std::span<const double> costs)
{
  const AllCells<dim> all = all_cells(mesh, costs);
  const std::vector<std::size_t> order = along_curve(all.middles);
  std::vector<double> row;
  for (const std::size_t cell : order)
    row.push_back(all.costs[cell]);
  const int n_ranks = int(dealii::Utilities::MPI::n_mpi_processes(mesh.cells->get_communicator()));
  const std::vector<int> ranks = ranks_of_row(row, n_ranks);
  Sharing sharing{std::vector<int>(costs.size()), imbalance(loads(row, ranks, n_ranks))};
  for (std::size_t k = 0; k < order.size(); ++k)
    if (order[k] >= all.first_own && order[k] < all.first_own + costs.size())
      sharing.rank_of_cell[order[k] - all.first_own] = ranks[k];
  return sharing;
}

template <int dim>
std::vector<std::vector<double>> move_cells(Mesh<dim>& mesh, const std::vector<int>& rank_of_cell,
                                            std::vector<std::vector<double>> states)
{
  const StoredCells stored = exchanged(mesh, rank_of_cell, std::move(states));
  mesh.cells = on_ranks(*mesh.cells, rank_of_cell);
  return own_states(mesh, stored);
}

template Sharing new_sharing(const Mesh<2>&, std::span<const double>);
template Sharing new_sharing(const Mesh<3>&, std::span<const double>);
template std::vector<std::vector<double>> move_cells(Mesh<2>&, const std::vector<int>&,
                                                     std::vector<std::vector<double>>);
template std::vector<std::vector<double>> move_cells(Mesh<3>&, const std::vector<int>&,
                                                     std::vector<std::vector<double>>);

} // namespace fem
