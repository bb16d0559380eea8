#!/usr/bin/python3
"""Tests of what the figures compute, against closed forms.

usage: plot_test.py [FOLDER OF plot.py]
"""
import sys
import unittest
from pathlib import Path

here = Path(__file__).resolve().parents[2] / "apps"
sys.path.insert(0, sys.argv.pop(1) if sys.argv[1:] and Path(sys.argv[1]).is_dir() else str(here))
sys.dont_write_bytecode = True

import numpy as np  # noqa: E402
import curves  # noqa: E402
import results  # noqa: E402
import temperature_figures  # noqa: E402

TIME = np.r_[0, np.geomspace(0.01, 2000, 400)]


def creep(a, m, b, n, time=TIME):
    """a t^m + b t^n, and the time at which its rate is least."""
    least = (a * m * (1 - m) / (b * n * (n - 1))) ** (1 / (n - m)) if b else np.inf
    return a * time**m + b * time**n, least


class SmoothedRate(unittest.TestCase):
    def test_of_a_straight_line_is_its_slope(self):
        _, rate = curves.smoothed_rate(TIME, 0.5 + 3e-4 * TIME)
        np.testing.assert_allclose(rate, 3e-4, rtol=1e-8)  # of differences of 1e-6

    def test_of_a_power_law_is_near_its_derivative(self):
        time, rate = curves.smoothed_rate(TIME, TIME**0.3)
        np.testing.assert_allclose(rate, 0.3 * time**-0.7, rtol=0.005)

    def test_windows_stay_within_the_record(self):
        half = 10 ** (curves.WINDOW / 2)
        time, _ = curves.smoothed_rate(TIME, TIME)
        self.assertGreaterEqual(time[0] / half, 0.01 * (1 - 1e-12))
        self.assertAlmostEqual(time[-1] * half**0.2, 2000)

    def test_of_a_record_shorter_than_a_window_is_empty(self):
        time, rate = curves.smoothed_rate(np.array([0, 1, 1.1]), np.array([0, 1, 2]))
        self.assertEqual((len(time), len(rate)), (0, 0))


class FlowTime(unittest.TestCase):
    def found(self, strain):
        time, rate = curves.smoothed_rate(TIME, strain)
        k = curves.flow_time(rate)
        return None if k is None else time[k]

    def test_power_law_creep_has_none(self):
        self.assertIsNone(self.found(1e-3 * TIME**0.3))

    def test_secondary_creep_has_none(self):
        self.assertIsNone(self.found(1e-3 * (1 - np.exp(-TIME / 10)) + 1e-6 * TIME))

    def test_is_where_the_rate_is_least(self):
        strain, least = creep(2e-3, 0.3, 1e-11, 2.8)
        self.assertLess(200, least)
        self.assertLess(least, 1000)
        self.assertAlmostEqual(np.log10(self.found(strain) / least), 0, delta=curves.WINDOW / 4)

    def test_rise_below_a_tenth_is_none(self):
        strain, least = creep(2e-3, 0.3, 1e-11, 2.8)
        last = np.searchsorted(TIME, 1.3 * least)
        _, rate = curves.smoothed_rate(TIME[:last], strain[:last])
        self.assertIsNone(curves.flow_time(rate))

    def test_rise_within_the_noise_is_none(self):
        time, rate = curves.smoothed_rate(TIME, TIME**0.3)
        noise = np.random.default_rng(1).normal(0, 0.2, len(time))
        rate = np.maximum(rate, np.interp(100, time, rate)) * 10**noise
        self.assertIsNone(curves.flow_time(rate))

    def test_rise_above_the_noise_is_found(self):
        strain, least = creep(2e-3, 0.3, 1e-11, 2.8)
        time, rate = curves.smoothed_rate(TIME, strain)
        k = curves.flow_time(rate * 10 ** np.random.default_rng(1).normal(0, 0.01, len(rate)))
        self.assertAlmostEqual(np.log10(time[k] / least), 0, delta=2 * curves.WINDOW)


class FlowNumber(unittest.TestCase):
    def found(self, cycle, strain):
        number, rate = curves.smoothed_rate(cycle, strain)
        k = curves.flow_time(rate)
        return None if k is None else number[k]

    def test_is_the_cycle_at_which_permanent_strain_grows_least(self):
        every = np.arange(1.0, 3001)
        growing_steps = np.unique(np.round(np.geomspace(1, 3000, 200)))
        for cycle in every, growing_steps:
            strain, least = creep(2e-2, 0.4, 1e-9, 2.5, cycle)
            self.assertLess(least, 1000)
            self.assertAlmostEqual(np.log10(self.found(cycle, strain) / least), 0,
                                   delta=curves.WINDOW / 4)

    def test_needs_a_rise(self):
        cycle = np.arange(1.0, 1001)
        self.assertIsNone(self.found(cycle, 0.1 * cycle**0.4))
        self.assertIsNone(self.found(cycle, 0.1 * cycle**0.4 + 0.01 * cycle))


class Curve(unittest.TestCase):
    def test_breakages_stand_where_they_happened(self):
        time, value = curves.event_order(np.array([0.0, 1, 2]), np.array([0.0, 4, 5]),
                                       np.array([0, 2, 2]), np.array([1.0, 1]), np.array([1.0, 2]))
        self.assertEqual(time.tolist(), [0, 1, 1, 1, 2])
        self.assertEqual(value.tolist(), [0, 1, 2, 4, 5])

    def test_collapse_is_a_jump_at_the_last_instant(self):
        time, value, collapsed = curves.before_collapse(np.array([0, 1, 2, 2, 2]),
                                                      np.array([0, 1, 2, 3, 9]))
        self.assertTrue(collapsed)
        self.assertEqual((time.tolist(), value.tolist()), ([0, 1, 2], [0, 1, 2]))
        self.assertFalse(curves.before_collapse(np.array([0, 1, 2]), np.array([0, 1, 9]))[2])


class Peak(unittest.TestCase):
    strain = np.linspace(0, 4, 401)

    def test_of_a_parabola(self):
        for sign in (1, -1):
            k, falls = curves.peak(sign * self.strain * (4 - self.strain))
            self.assertAlmostEqual(self.strain[k], 2)
            self.assertTrue(falls)

    def test_needs_a_fall(self):
        rising = self.strain <= 2.2  # 1 % below the largest
        k, falls = curves.peak((self.strain * (4 - self.strain))[rising])
        self.assertAlmostEqual(self.strain[k], 2)
        self.assertFalse(falls)


class Bins(unittest.TestCase):
    def test_of_an_even_sequence_is_its_rate(self):
        times = np.arange(0.05, 100, 0.1)
        np.testing.assert_allclose(curves.binned_rate(times, curves.bin_edges(0, 100, False)), 10)

    def test_in_log_time_are_five_per_decade(self):
        edges = curves.bin_edges(0.01, 1000, True)
        self.assertEqual(len(edges), 26)
        np.testing.assert_allclose(edges[1:] / edges[:-1], 10**0.2, rtol=1e-9)

    def test_count_every_breakage(self):
        for log in (False, True):
            times = np.geomspace(0.01, 1000, 1234)
            edges = curves.bin_edges(0.01 if log else 0, 1000, log)
            number = curves.binned_rate(times, edges) * np.diff(edges)
            self.assertAlmostEqual(number.sum(), 1234)


class FakeResult:
    """What the choice of results for reduced times looks at."""

    def __init__(self, shift, law="WLF", reference="20 degC"):
        self.shift = shift
        self.scene = {"Temperature/Shift law": law, "Temperature/Reference temperature": reference}


class ReducedTimes(unittest.TestCase):
    def comparable(self, *each):
        return len(temperature_figures.comparable(list(each)))

    def test_need_runs_that_differ_in_their_shift(self):
        self.assertEqual(self.comparable(FakeResult(1)), 0)
        self.assertEqual(self.comparable(FakeResult(2), FakeResult(2)), 0)
        self.assertEqual(self.comparable(FakeResult(1), FakeResult(2)), 2)

    def test_leave_out_runs_without_one_shift(self):  # temperatures that change, no shift law
        self.assertEqual(self.comparable(FakeResult(1), FakeResult(2), FakeResult(None)), 2)
        self.assertEqual(self.comparable(FakeResult(1), FakeResult(2), FakeResult(1, "none")), 2)

    def test_need_one_reference_temperature(self):
        self.assertEqual(self.comparable(FakeResult(1), FakeResult(2, reference="10 degC")), 0)


class Other(unittest.TestCase):
    def test_power_law(self):
        x = np.array([5e-4, 5e-3, 5e-2])
        np.testing.assert_allclose(curves.power_law(x, 3 * x**0.325), (0.325, 3))

    def test_scene_values(self):
        text = "set Title = a = b\nsubsection Loading\n  set Test = creep\nend\nset File =\n"
        self.assertEqual(results.scene_values(text),
                         {"Title": "a = b", "Loading/Test": "creep", "File": ""})


if __name__ == "__main__":
    unittest.main()
