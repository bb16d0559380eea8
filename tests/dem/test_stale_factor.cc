#include "dem/stale_factor.h"

#include "dem/quasistatic.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

using namespace dem;

namespace {

const BondLaw asphalt_law{laws::burgers_set("asphalt"), 11, 1};

/// The tangent of a bonded block at rest.
struct Tangent {
  Tangent()
  {
    const Assembly assembly = assemblies::block(4, 5, asphalt_law, 3);
    const QuasistaticModel model =
        make_quasistatic_model(assembly, ramp(Loading::Control::displacement, 1, 1),
                               event_runs::constant_strength, {}, event_runs::never);
    const QuasistaticState state = start(model);
    const std::vector<LawStep> laws{
        law_step(model.assembly.laws[0].creep, model.scheme, 0, state.links.n_parts)};
    const LinkStep step{&model.assembly, &model.bodies, &state.links, state.centre, laws, 0.5, 1e-3,
                        Geometry::finite};
    const std::vector<Vec3> none(state.centre.size(), Vec3::Zero());
    dofs = model.dofs;
    links_of = body_links(state.links, state.centre.size());
    stiffness = laws[0].stiffness();
    matrix.hold.assign(state.centre.size(), 1e-6 * stiffness);
    for (std::size_t k = 0; k < state.links.link.size(); ++k) {
      matrix.ends.push_back({state.links.link[k].first, state.links.link[k].second});
      matrix.tangent.push_back(answer(step, k, {none, none}).tangent);
    }
    b = Eigen::VectorXd::LinSpaced(dofs.n_dofs, -1, 1);
  }

  /// The same with every so manieth link gone.
  LinkMatrix damaged(std::size_t every) const
  {
    LinkMatrix result = matrix;
    for (std::size_t k = 0; k < result.tangent.size(); k += every) {
      LinkTangent& t = result.tangent[k];
      t.k_n = t.k_s = t.k_v = t.k_t = t.k_b = 0;
    }
    return result;
  }

  Eigen::VectorXd solve(StaleFactor& factor, const LinkMatrix& of) const
  {
    return factor.solve(of, links_of, dofs, b, 1e-8, stiffness, 1).value();
  }

  LinkDofs dofs;
  BodyLinks links_of;
  LinkMatrix matrix;
  double stiffness;
  Eigen::VectorXd b;
};

/// K x with the values of an assembly.
Eigen::VectorXd assembled_product(const SymmetricPattern& pattern, std::span<const double> values,
                                  const Eigen::VectorXd& x)
{
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (int c = 0; c < pattern.size(); ++c)
    for (int p = pattern.column_start[c]; p < pattern.column_start[c + 1]; ++p) {
      y[pattern.row[p]] += values[p] * x[c];
      if (pattern.row[p] != c)
        y[c] += values[p] * x[pattern.row[p]];
    }
  return y;
}

} // namespace

TEST(LinkAssembly, IsTheMatrixOfTheProduct)
{
  for (const bool platen_is_free : {false, true}) {
    Tangent tangent;
    if (platen_is_free)
      tangent.dofs.platen_dof = tangent.dofs.n_dofs++;
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(tangent.dofs.n_dofs, -1, 2);
    LinkAssembly assembly(tangent.matrix.ends, tangent.dofs);
    for (const LinkMatrix& matrix : {tangent.matrix, tangent.damaged(3)}) {
      const Eigen::VectorXd expected = product(matrix, tangent.links_of, tangent.dofs, x, 1);
      const Eigen::VectorXd found =
          assembled_product(assembly.pattern(), assembly.values(matrix), x);
      EXPECT_LT((found - expected).norm(), 1e-13 * expected.norm());
    }
  }
}

TEST(LinkAssembly, CountsWhatCarriesOutside)
{
  const Tangent tangent;
  std::vector<LinkAssembly::Ends> pairs = tangent.matrix.ends;
  pairs.resize(pairs.size() - 7);
  LinkAssembly assembly(pairs, tangent.dofs);
  EXPECT_EQ(assembly.n_outside(tangent.matrix), 7);
  EXPECT_EQ(assembly.n_outside(tangent.damaged(1)), 0);
}

TEST(StaleFactor, AnalysesAnewWhenOthersCarry)
{
  const Tangent tangent;
  LinkMatrix apart = tangent.damaged(2);
  for (LinkTangent& each : apart.tangent)
    if (!each.carries())
      each.gap = 1;
  StaleFactor factor;
  for (int n = 0; n < 12; ++n)
    tangent.solve(factor, apart);
  EXPECT_EQ(factor.statistics().n_analyses, 1);
  const long n_before = factor.statistics().n_factor_nonzeros;
  tangent.solve(factor, tangent.matrix); // stale, or the factorisation that finds them
  for (int n = 0; factor.statistics().n_analyses == 1 && n < 20; ++n)
    tangent.solve(factor, n % 2 == 0 ? tangent.matrix : tangent.damaged(3));
  EXPECT_EQ(factor.statistics().n_analyses, 2);
  EXPECT_GT(factor.statistics().n_factor_nonzeros, n_before);
}

TEST(StaleFactor, ServesTheSameMatrixAgain)
{
  const Tangent tangent;
  StaleFactor factor;
  for (int n = 0; n < 4; ++n) {
    const Eigen::VectorXd x = tangent.solve(factor, tangent.matrix);
    const Eigen::VectorXd left =
        tangent.b - product(tangent.matrix, tangent.links_of, tangent.dofs, x, 1);
    EXPECT_LT(left.norm(), 1e-7 * tangent.b.norm());
  }
  EXPECT_EQ(factor.statistics().n_factorisations, 1);
}

TEST(StaleFactor, IsTriedLessOftenTheMoreOftenItFailed)
{
  // Two matrices that have little in common take turns.
  const Tangent tangent;
  const LinkMatrix one = tangent.damaged(2);
  LinkMatrix other = tangent.damaged(2);
  for (std::size_t k = 0; k < other.tangent.size(); ++k)
    other.tangent[k] = k % 2 == 0 ? tangent.matrix.tangent[k] : one.tangent[0];
  StaleFactor factor;
  for (int n = 0; n < 21; ++n)
    tangent.solve(factor, n % 2 == 0 ? one : other);
  const StaleFactor::Statistics& counts = factor.statistics();
  const long n_tries = counts.n_solves - counts.n_factorisations;
  EXPECT_EQ(counts.n_factorisations, 21);
  EXPECT_GE(n_tries, 3);
  EXPECT_LE(n_tries, 5); // of 10, if each failure were the first
  EXPECT_GT(factor.wear().n_failures, 1);
}
