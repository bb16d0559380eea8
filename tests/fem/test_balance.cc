#include "fem/balance.h"

#include "bodies.h"
#include "fem/cell_states.h"
#include "fem/refinement.h"

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

const BodyLoads pressed{{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}};

/// Costs of the cells of this rank: those near one end of the box cost more.
std::vector<double> costs_of(const Mesh<3>& mesh)
{
  std::vector<double> costs;
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned())
      costs.push_back(cell->center()[2] < 0.5 ? 10 : 1);
  return costs;
}

double sum_over_ranks(const std::vector<double>& costs)
{
  double sum = 0;
  for (const double each : costs)
    sum += each;
  return sum;
}

/// Steps of a body whose cells go to other ranks on the way, and of one whose cells stay.
void expect_the_same_after_moving(Mesh<3>& mesh, int order)
{
  const ComplianceLaw law = bodies::burgers_in_shear();
  Body<3> stays(mesh, {order}, pressed, law);
  stays.step({true, 1e6, 0}, 0);
  stays.step({true, 1e6, 0}, 10);
  const std::size_t n_cells = mesh.cells->n_global_active_cells();
  const Sharing sharing = new_sharing(mesh, costs_of(mesh));
  const auto states =
      move_cells(mesh, sharing.rank_of_cell, cell_states(stays.specimen, stays.points));
  EXPECT_EQ(mesh.cells->n_global_active_cells(), n_cells);
  const auto costs = dealii::Utilities::MPI::all_gather(ranks, sum_over_ranks(costs_of(mesh)));
  EXPECT_NEAR(imbalance(costs), sharing.imbalance, 1e-12);
  EXPECT_LT(sharing.imbalance, 1.2);

  Body<3> moved(mesh, {order}, pressed, law);
  restore_cell_states(moved.specimen, moved.points, states, stays.specimen.drive_displacement());
  moved.points.set_last_step(stays.points.last_step());
  EXPECT_NEAR(moved.specimen.displacement().l2_norm() / stays.specimen.displacement().l2_norm(), 1,
              1e-13);
  for (Body<3>* body : {&stays, &moved})
    body->step({true, 1e6, 0}, 25);
  EXPECT_NEAR(moved.specimen.drive_displacement() / stays.specimen.drive_displacement(), 1, 1e-10);
}

} // namespace

TEST(Balance, ImbalanceIsTheLargestOverTheMean)
{
  EXPECT_EQ(imbalance(std::vector<double>{1, 3}), 1.5);
  EXPECT_EQ(imbalance(std::vector<double>{2, 2, 2}), 1);
  EXPECT_EQ(imbalance(std::vector<double>{0, 0}), 1);
}

TEST(Balance, RowsAreCutWhereTheBusiestRankHasLeast)
{
  using Costs = std::vector<double>;
  using Ranks = std::vector<int>;
  EXPECT_EQ(ranks_of_row(Costs{1, 1, 1, 1}, 2), (Ranks{0, 0, 1, 1}));
  EXPECT_EQ(ranks_of_row(Costs{9, 1, 1, 1}, 2), (Ranks{0, 1, 1, 1}));
  EXPECT_EQ(ranks_of_row(Costs{1, 1, 1, 9}, 3), (Ranks{0, 0, 1, 2})); // 9 cannot be divided
  EXPECT_EQ(ranks_of_row(Costs{1, 2, 3, 4, 5}, 2), (Ranks{0, 0, 0, 1, 1}));
  EXPECT_EQ(ranks_of_row(Costs{0, 0, 0}, 3), (Ranks{0, 1, 2}));
  EXPECT_EQ(ranks_of_row(Costs{5}, 1), (Ranks{0}));
  EXPECT_THROW(ranks_of_row(Costs{1}, 2), std::invalid_argument);
}

TEST(Balance, BodiesGoOnTheSameWhereverTheirCellsAre)
{
  for (const int order : {1, 2})
    for (const bool simplices : {false, true}) {
      Mesh<3> mesh = box(ranks, {1, 1, 2}, {0.5, 0, simplices});
      expect_the_same_after_moving(mesh, order);
    }
  Mesh<3> curved = cylinder(ranks, 1, 2, {0.5, 1, false});
  expect_the_same_after_moving(curved, 1);
}

TEST(Balance, CellsMoveFromMeshesWithHangingNodes)
{
  Mesh<3> mesh = box(ranks, {1, 1, 2}, {0.5});
  {
    Body<3> body(mesh, {1}, pressed, bodies::elastic(1e9, 0.3));
    body.step({true, 1e6, 0}, 0);
    refine(mesh, body.specimen, body.points, 0.3);
  }
  ASSERT_TRUE(mesh.cells->has_hanging_nodes());
  expect_the_same_after_moving(mesh, 2);
  EXPECT_TRUE(mesh.cells->has_hanging_nodes());
  expect_the_same_after_moving(mesh, 1); // and once more
}
