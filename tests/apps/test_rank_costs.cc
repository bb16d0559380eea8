#include "apps/rank_costs.h"

#include <gtest/gtest.h>

using apps::common_cost;
using apps::RankCosts;
using apps::RankTime;
using apps::saving;

TEST(RankCosts, WhatAllCellsTakeAlikeIsThatOfTheRankThatWaitedLeast)
{
  const std::vector<RankTime> equal{{5, 2, 10}, {1, 6, 10}}; // the second waited for the first
  EXPECT_DOUBLE_EQ(common_cost(equal), 0.2);
  const std::vector<RankTime> unequal{{5, 2, 5}, {1, 6, 20}};
  EXPECT_DOUBLE_EQ(common_cost(unequal), 0.3);
  const std::vector<RankTime> clocks_that_err{{5, -1e-9, 5}, {1, 6, 20}};
  EXPECT_EQ(common_cost(clocks_that_err), 0);
}

TEST(RankCosts, SavesWhatEqualCostsWouldNotHaveWaited)
{
  EXPECT_DOUBLE_EQ(saving(3, 1.5, 1), 3);
  EXPECT_DOUBLE_EQ(saving(3, 1.5, 1.25), 1.5);
  EXPECT_LT(saving(3, 1.5, 1.6), 0);
  EXPECT_EQ(saving(0, 1, 1), 0);
}

TEST(RankCosts, OfACellAreThoseOfItsPointsWhatWasBeforeCountsHalf)
{
  const apps::Ranks ranks; // one
  RankCosts costs;
  costs.begin(2, ranks);
  EXPECT_EQ(costs.price(), 2);
  EXPECT_FALSE(costs.is_due(std::vector<double>{0.1, 0.1, 0.1, 0.1}, ranks));
  const std::vector<double> first{100, 200, 0, 400}, then{100, 300, 0, 400}; // two cells
  EXPECT_TRUE(costs.is_due(first, ranks));
  costs.look(first, 2, ranks);
  constexpr double own = 1; // what this test takes itself is far less [s]
  EXPECT_NEAR(costs.of_cells()[0], 300, own);
  EXPECT_NEAR(costs.of_cells()[1], 400, own);
  costs.look(then, 2, ranks);
  EXPECT_NEAR(costs.of_cells()[0], 150 + 100, own);
  EXPECT_NEAR(costs.of_cells()[1], 200, own);
  EXPECT_EQ(costs.imbalance(), 1);
  EXPECT_EQ(costs.waited(), 0);
  costs.begin(1, ranks);
  EXPECT_EQ(costs.price(), 1);
  EXPECT_TRUE(costs.of_cells().empty());
}
