#include "fem/agreement.h"

#include "bodies.h"
#include "fem/march.h"

using namespace fem;
using bodies::ranks;

namespace {

/// What a point that fails was about to do.
enum class Moment { evaluate, commit, overload, change, share };

/// Points of a law that fail on the last rank, from a time on.
class FailingPoints final : public MaterialPoints {
public:
  FailingPoints(LawPoints points, Moment moment, double from)
      : points_(std::move(points)), moment_(moment), from_(from)
  {
  }

  std::size_t size() const override { return points_.size(); }
  void begin_step(double time, double) override { time_ = time; }
  ConstitutiveAnswer evaluate(std::span<const Vec6> increment, double step) override
  {
    fail_at(Moment::evaluate);
    return points_.evaluate(increment, step);
  }
  StepError step_error(std::span<const double> weights) const override
  {
    return points_.step_error(weights);
  }
  double share_without_change() override
  {
    fail_at(Moment::share);
    return 1;
  }
  void commit() override
  {
    fail_at(Moment::commit);
    points_.commit();
  }
  double overload() override
  {
    fail_at(Moment::overload);
    return moment_ == Moment::change && time_ >= from_ ? 2 : 0;
  }
  void change(double) override { fail_at(Moment::change); }
  std::span<const Vec6> stress() const override { return points_.stress(); }
  std::span<const Vec6> strain() const override { return points_.strain(); }
  double last_step() const override { return points_.last_step(); }
  void set_last_step(double step) override { points_.set_last_step(step); }
  std::size_t numbers_per_point() const override { return points_.numbers_per_point(); }
  void store(std::size_t point, std::span<double> numbers) const override
  {
    points_.store(point, numbers);
  }
  void restore(std::size_t point, std::span<const double> numbers) override
  {
    points_.restore(point, numbers);
  }

private:
  void fail_at(Moment moment) const
  {
    const unsigned n = dealii::Utilities::MPI::n_mpi_processes(ranks);
    if (moment == moment_ && time_ >= from_ &&
        dealii::Utilities::MPI::this_mpi_process(ranks) == n - 1)
      throw std::runtime_error("the point has failed");
  }

  LawPoints points_;
  Moment moment_;
  double from_, time_ = 0;
};

std::string message_of(const std::function<void()>& work)
{
  try {
    work();
  } catch (const RankFailure& failure) {
    return failure.what();
  }
  return "";
}

} // namespace

TEST(Agreement, WhatFailsOnOneRankFailsOnAllWithItsMessage)
{
  const unsigned me = dealii::Utilities::MPI::this_mpi_process(ranks);
  const unsigned last = dealii::Utilities::MPI::n_mpi_processes(ranks) - 1;
  together(ranks, [] {});
  const std::string found = message_of([&] {
    together(ranks, [&] {
      if (me == last)
        throw std::runtime_error("no room");
    });
  });
  EXPECT_EQ(found, last == 0 ? "no room" : "on rank " + std::to_string(last) + ": no room");
  EXPECT_THROW(together(ranks,
                        [&] {
                          if (me == last)
                            throw std::invalid_argument("no such size");
                        }),
               std::invalid_argument);
  const std::string memory = message_of([] { together(ranks, [] { throw std::bad_alloc(); }); });
  EXPECT_EQ(memory, "the memory does not suffice");
}

TEST(Agreement, PointsThatFailOnOneRankEndTheMarchOnAll)
{
  const ComplianceLaw law = bodies::burgers_in_shear();
  const Mesh<3> mesh = box(ranks, {1, 1, 1}, {0.5});
  const BodyLoads loads{{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}};
  const auto load = [](double) { return LoadState{true, 1e6, 0}; };
  const History history{load, load, [](double t) { return t; }};
  for (const Moment moment :
       {Moment::evaluate, Moment::commit, Moment::overload, Moment::change, Moment::share}) {
    Specimen<3> specimen(mesh, {1}, loads, 1e-10);
    const LawPoints points({&law, 1}, std::vector<int>(specimen.elements().n_points(), 0),
                           TimeScheme::stress_linear);
    FailingPoints failing(points, moment, 1);
    MarchState state;
    apply_jump(specimen, failing, state, history);
    const std::string found = message_of([&] {
      while (state.time < 100)
        march_step(specimen, failing, state, history, {1e-4, 0.1, 3}, 100);
    });
    EXPECT_NE(found.find("the point has failed"), std::string::npos) << int(moment);
    EXPECT_GT(state.time, 0.5);
    EXPECT_LT(state.time, 100);
    EXPECT_FALSE(state.has_lost); // that would be the body's end, not the program's
    EXPECT_EQ(dealii::Utilities::MPI::sum(1u, ranks),
              dealii::Utilities::MPI::n_mpi_processes(ranks)); // they still hear each other
  }
}
