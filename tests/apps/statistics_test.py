#!/usr/bin/python3
"""Tests of the statistics over the runs of a study, against closed forms.

usage: statistics_test.py [FOLDER OF statistics_of_runs.py]
"""
import sys
import unittest
from pathlib import Path

here = Path(__file__).resolve().parents[2] / "apps"
sys.path.insert(0, sys.argv.pop(1) if sys.argv[1:] and Path(sys.argv[1]).is_dir() else str(here))
sys.dont_write_bytecode = True

import numpy as np  # noqa: E402
import statistics_of_runs as statistics  # noqa: E402

INF = np.inf


class Proportion(unittest.TestCase):
    def test_bounds_of_none_and_all_are_powers(self):
        low, high = statistics.proportion_interval(0, 10)
        self.assertEqual(low, 0)
        self.assertAlmostEqual(high, 1 - 0.025**0.1, places=12)
        low, high = statistics.proportion_interval(10, 10)
        self.assertAlmostEqual(low, 0.025**0.1, places=12)
        self.assertEqual(high, 1)

    def test_is_symmetric(self):
        a, b = statistics.proportion_interval(3, 10), statistics.proportion_interval(7, 10)
        self.assertAlmostEqual(a[0], 1 - b[1], places=12)
        self.assertTrue(a[0] < 0.3 < a[1])


class Median(unittest.TestCase):
    def test_counts_ruptures_that_did_not_come_as_later(self):
        self.assertEqual(statistics.median([5, INF, 1, 3, INF]), 5)
        self.assertEqual(statistics.median([1, 3, INF, INF]), INF)
        self.assertEqual(statistics.median([1, 2, 4, INF]), 3)

    def test_interval_has_the_binomial_level(self):
        low, high, level = statistics.median_interval(np.arange(10.0))
        self.assertEqual((low, high), (1, 8))  # second smallest, second largest
        self.assertAlmostEqual(level, 1 - 2 * 11 / 1024, places=12)
        low, high, level = statistics.median_interval(np.arange(5.0))
        self.assertEqual((low, high), (0, 4))  # too few for 95 %: the widest
        self.assertAlmostEqual(level, 1 - 2 / 32, places=12)

    def test_interval_holds_the_median_as_often_as_it_says(self):
        draws = np.random.default_rng(1).exponential(size=(4000, 20))
        hits = 0
        for row in draws:
            low, high, level = statistics.median_interval(row)
            hits += low <= np.log(2) <= high
        self.assertGreaterEqual(level, 0.95)
        self.assertAlmostEqual(hits / 4000, level, delta=4 * np.sqrt(level * (1 - level) / 4000))


class LogSpread(unittest.TestCase):
    def test_of_powers(self):
        mean, spread = statistics.log_spread([np.exp(1), np.exp(3)])
        self.assertAlmostEqual(mean, np.exp(2), places=12)
        self.assertAlmostEqual(spread, np.sqrt(2), places=12)

    def test_of_one_value_is_unknown(self):
        mean, spread = statistics.log_spread([4.0])
        self.assertAlmostEqual(mean, 4)
        self.assertTrue(np.isnan(spread))


class Variance(unittest.TestCase):
    def test_balanced_design_splits_the_sum_of_squares(self):
        rng = np.random.default_rng(2)
        a, b = np.repeat([0, 1, 2], 8), np.tile(np.repeat([0, 1], 4), 3)
        y = 2.0 * a + 5.0 * b + rng.normal(size=24)
        rows = {row[0]: row for row in statistics.variance_table(y, {"a": a, "b": b})}
        means = lambda f: np.array([y[f == level].mean() for level in f])
        squares_a, squares_b = np.sum((means(a) - y.mean())**2), np.sum((means(b) - y.mean())**2)
        rest = np.sum((y - y.mean())**2) - squares_a - squares_b
        self.assertAlmostEqual(rows["a"][1], squares_a, places=9)
        self.assertAlmostEqual(rows["b"][1], squares_b, places=9)
        self.assertAlmostEqual(rows["residual"][1], rest, places=9)
        self.assertEqual([rows[k][2] for k in ("a", "b", "residual")], [2, 1, 20])
        self.assertAlmostEqual(rows["a"][3], squares_a / 2 / (rest / 20), places=9)

    def test_two_groups_are_the_test_of_student(self):
        y = np.array([1.0, 2.0, 4.0, 6.0, 7.5, 9.0, 7.0])
        group = ["x", "x", "x", "y", "y", "y", "y"]
        (_, _, degrees, f, p), rest = statistics.variance_table(y, {"g": group})
        x, z = y[:3], y[3:]
        pooled = (np.sum((x - x.mean())**2) + np.sum((z - z.mean())**2)) / 5
        self.assertAlmostEqual(f, (x.mean() - z.mean())**2 / (pooled * (1 / 3 + 1 / 4)), places=9)
        self.assertEqual((degrees, rest[2]), (1, 5))
        from scipy import stats
        self.assertAlmostEqual(p, stats.ttest_ind(x, z).pvalue, places=12)

    def test_order_of_runs_and_names_of_levels_do_not_matter(self):
        rng = np.random.default_rng(3)
        y, a, b = rng.normal(size=10), list("xxxyyxyxyy"), list("1123123123")
        order = rng.permutation(10)
        one = statistics.variance_table(y, {"a": a, "b": b})
        other = statistics.variance_table(y[order], {
            "a": [{"x": "q", "y": "b"}[a[k]] for k in order], "b": [b[k] for k in order]})
        for row, same in zip(one, other):
            np.testing.assert_allclose(row[1:4], same[1:4], rtol=1e-9)

    def test_factors_that_cannot_be_told_apart_are_left_out(self):
        y, a = [1.0, 2.0, 3.0, 5.0], ["x", "x", "y", "y"]
        self.assertEqual([row[0] for row in statistics.variance_table(
            y, {"a": a, "same": a, "constant": ["k"] * 4})], ["residual"])

    def test_without_residual_freedom_there_is_no_test(self):
        rows = statistics.variance_table([1.0, 2.0, 4.0], {"a": ["x", "y", "z"]})
        self.assertTrue(np.isnan(rows[0][3]) and np.isnan(rows[0][4]))


class Bands(unittest.TestCase):
    def test_a_ruptured_curve_is_infinite_beyond_its_end_another_unknown(self):
        times = np.array([0.0, 1.0, 2.0, 3.0])
        rows = statistics.curves_at(times, [(np.array([0, 3.0]), np.array([0, 3.0]), False),
                                            (np.array([0, 1.0]), np.array([0, 2.0]), True),
                                            (np.array([0, 2.0]), np.array([0, 2.0]), False)])
        np.testing.assert_array_equal(rows[0], times)
        np.testing.assert_array_equal(rows[1], [0, 2, INF, INF])
        np.testing.assert_array_equal(rows[2], [0, 1, 2, np.nan])
        middle, low, high = statistics.band(rows)
        np.testing.assert_array_equal(middle, [0, 1, 2, np.nan])
        np.testing.assert_array_equal(low, [0, 1, 2, np.nan])
        np.testing.assert_array_equal(high, [0, 2, INF, np.nan])


if __name__ == "__main__":
    unittest.main()
