#include "fem/supports.h"

#include <deal.II/base/function.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/numerics/vector_tools_boundary.h>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace fem {

namespace {

using Dof = dealii::types::global_dof_index;

/// Displacement per unit of the drive of all held unknowns that this rank knows.
template <int dim>
std::map<Dof, double> held_values(const Mesh<dim>& mesh, const Elements<dim>& elements,
                                  const std::vector<Support>& supports)
{
  std::map<Dof, double> held;
  std::map<std::pair<std::string, int>, int> times;
  for (const Support& support : supports)
    for (int k = 0; k < dim; ++k) {
      const int direction = dim == 2 && k == 1 ? 2 : k;
      const std::optional<double>& value = support.displacement[std::size_t(direction)];
      if (!value)
        continue;
      if (++times[{support.boundary, k}] > 1)
        throw std::invalid_argument(
            fmt::format("the displacement {} of boundary '{}' is held twice", "xyz"[direction],
                        support.boundary));
      const dealii::Functions::ConstantFunction<dim> constant(*value, dim);
      dealii::ComponentMask mask(dim, false);
      mask.set(unsigned(k), true);
      std::map<Dof, double> here;
      dealii::VectorTools::interpolate_boundary_values(
          elements.mapping(), elements.dofs(),
          std::map<dealii::types::boundary_id, const dealii::Function<dim>*>{
              {boundary_id(mesh, support.boundary), &constant}},
          here, mask);
      for (const auto& [dof, v] : here) {
        const auto [found, is_new] = held.insert({dof, v});
        if (!is_new && v != 0)
          found->second = v; // where a moved boundary meets one that is held, it moves
      }
    }
  return held;
}

/// Direction (0 to dim - 1) of each unknown of this rank.
template <int dim>
std::vector<int> component_of(const Elements<dim>& elements)
{
  const auto owned = elements.dofs().locally_owned_dofs();
  std::vector<int> result(owned.n_elements());
  for (int k = 0; k < dim; ++k) {
    dealii::ComponentMask mask(dim, false);
    mask.set(unsigned(k), true);
    for (const Dof dof : dealii::DoFTools::extract_dofs(elements.dofs(), mask))
      result[owned.index_within_set(dof)] = k;
  }
  return result;
}

/// The unknown of any rank that moves most in a motion, with its number; ties go to the lowest.
std::pair<double, Dof> largest(const Eigen::VectorXd& motion, const dealii::IndexSet& owned,
                               const dealii::AffineConstraints<double>& constraints, MPI_Comm ranks)
{
  std::pair<double, Dof> best{-1, 0};
  for (Eigen::Index k = 0; k < motion.size(); ++k) {
    const Dof dof = owned.nth_index_in_set(Dof(k));
    if (!constraints.is_constrained(dof) && std::abs(motion[k]) > best.first * (1 + 1e-9))
      best = {std::abs(motion[k]), dof};
  }
  for (const auto& each : dealii::Utilities::MPI::all_gather(ranks, best))
    if (each.first > best.first * (1 + 1e-9) ||
        (each.first >= best.first * (1 - 1e-9) && each.second < best.second))
      best = each;
  return best;
}

/// Holds the rigid motions that are left, one unknown each; \return how many.
template <int dim>
int pin(const Elements<dim>& elements, const std::map<Dof, double>& held,
        dealii::AffineConstraints<double>& constraints, std::map<Dof, double>& pinned)
{
  const Eigen::MatrixXd motions = rigid_motions(elements);
  const auto owned = elements.dofs().locally_owned_dofs();
  const auto n = motions.cols();
  Eigen::MatrixXd resisted = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [dof, value] : held)
    if (owned.is_element(dof)) {
      const auto row = motions.row(Eigen::Index(owned.index_within_set(dof)));
      resisted += row.transpose() * row;
    }
  std::vector<double> sums(resisted.data(), resisted.data() + resisted.size());
  dealii::Utilities::MPI::sum(sums, elements.ranks(), sums);
  resisted = Eigen::Map<Eigen::MatrixXd>(sums.data(), n, n);
  int n_pins = 0;
  while (true) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(resisted);
    if (solver.eigenvalues()[0] > 1e-8 * std::max(1., solver.eigenvalues()[n - 1]))
      return n_pins;
    const auto [size, dof] =
        largest(motions * solver.eigenvectors().col(0), owned, constraints, elements.ranks());
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    if (owned.is_element(dof))
      row = motions.row(Eigen::Index(owned.index_within_set(dof))).transpose();
    std::vector<double> numbers(row.data(), row.data() + n);
    dealii::Utilities::MPI::sum(numbers, elements.ranks(), numbers);
    row = Eigen::Map<Eigen::VectorXd>(numbers.data(), n);
    resisted += row * row.transpose();
    if (constraints.get_local_lines().is_element(dof)) {
      constraints.add_line(dof);
      pinned[dof] = 0;
    }
    ++n_pins;
  }
}

} // namespace

template <int dim>
Eigen::MatrixXd rigid_motions(const Elements<dim>& elements)
{
  const auto owned = elements.dofs().locally_owned_dofs();
  const std::vector<int> component = component_of(elements);
  std::map<Dof, dealii::Point<dim>> points = support_points(elements);
  dealii::Point<dim> low, high;
  for (int k = 0; k < dim; ++k) {
    low[k] = std::numeric_limits<double>::max();
    high[k] = std::numeric_limits<double>::lowest();
    for (const auto& [dof, p] : points) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
    low[k] = dealii::Utilities::MPI::min(low[k], elements.ranks());
    high[k] = dealii::Utilities::MPI::max(high[k], elements.ranks());
  }
  const dealii::Point<dim> middle = low + (high - low) / 2;
  const double size = low.distance(high) / 2;
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(owned.n_elements(), dim == 3 ? 6 : 1);
  for (Eigen::Index k = 0; k < motions.rows(); ++k) {
    const int c = component[std::size_t(k)];
    if constexpr (dim == 2) {
      motions(k, 0) = c == 1;
    } else {
      const dealii::Tensor<1, dim> x = (points.at(owned.nth_index_in_set(Dof(k))) - middle) / size;
      motions(k, c) = 1;
      motions(k, 3 + (c + 2) % 3) = -x[(c + 1) % 3]; // rotation about the axis before: -y in x, ...
      motions(k, 3 + (c + 1) % 3) = x[(c + 2) % 3];
    }
  }
  return motions;
}

template <int dim>
Supports<dim> make_supports(const Mesh<dim>& mesh, const Elements<dim>& elements,
                            const std::vector<Support>& supports)
{
  dealii::IndexSet relevant;
  dealii::DoFTools::extract_locally_relevant_dofs(elements.dofs(), relevant);
  dealii::AffineConstraints<double> hanging(relevant);
  dealii::DoFTools::make_hanging_node_constraints(elements.dofs(), hanging);
  Supports<dim> result;
  result.constraints.reinit(relevant);
  result.constraints.merge(hanging);
  const std::map<Dof, double> held = held_values(mesh, elements, supports);
  std::map<Dof, double> independent;
  for (const auto& [dof, value] : held)
    if (!hanging.is_constrained(dof)) {
      result.constraints.add_line(dof);
      independent[dof] = value;
    }
  result.n_pins = pin(elements, independent, result.constraints, independent);
  result.constraints.close();
  hanging.close();
  result.drive = elements.zero();
  bool driven = false;
  const auto owned = elements.dofs().locally_owned_dofs();
  for (const auto& [dof, value] : independent)
    if (owned.is_element(dof)) {
      result.drive(dof) = value;
      result.held.push_back(dof);
      driven = driven || value != 0;
    }
  hanging.distribute(result.drive);
  result.drive.update_ghost_values();
  result.driven = dealii::Utilities::MPI::max(int(driven), elements.ranks()) == 1;
  return result;
}

template struct Supports<2>;
template struct Supports<3>;
template Eigen::MatrixXd rigid_motions(const Elements<2>&);
template Eigen::MatrixXd rigid_motions(const Elements<3>&);
template Supports<2> make_supports(const Mesh<2>&, const Elements<2>&, const std::vector<Support>&);
template Supports<3> make_supports(const Mesh<3>&, const Elements<3>&, const std::vector<Support>&);

} // namespace fem
