"""Statistics over the runs of a study. Pure functions of arrays; distributions are SciPy's.

A rupture time that a run did not reach is infinite: it is known to be later than the end. Order
statistics (median, quantiles) need no more; means and analyses of variance leave such runs out.
"""
import numpy as np
from scipy import stats

LEVEL = 0.95  # of all intervals


def proportion_interval(count, number, level=LEVEL):
    """Clopper-Pearson interval of a probability from `count` cases among `number`."""
    tail = (1 - level) / 2
    low = stats.beta.ppf(tail, count, number - count + 1) if count else 0.0
    high = stats.beta.ppf(1 - tail, count + 1, number - count) if count < number else 1.0
    return float(low), float(high)


def order_quantile(values, share):
    """The smallest value that at least this share of the values does not exceed."""
    ordered = np.sort(values)
    return float(ordered[max(0, int(np.ceil(share * len(ordered) - 1e-9)) - 1)])


def median(values):
    """The middle value, or the mean of the two; infinite if the upper of the two is."""
    ordered = np.sort(values)
    return float((ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2)


def median_interval(values, level=LEVEL):
    """Interval of the median that holds for any distribution, and its level; widest if few values.

    From the k-th smallest to the k-th largest value, with the largest k for which the binomial
    probability of both tails is at most 1 - level.
    """
    ordered, n = np.sort(values), len(values)
    k = max(1, int(stats.binom.ppf((1 - level) / 2, n, 0.5)))
    while k > 1 and 2 * stats.binom.cdf(k - 1, n, 0.5) > 1 - level:
        k -= 1
    while 2 * stats.binom.cdf(k, n, 0.5) <= 1 - level:
        k += 1
    covered = 1 - 2 * stats.binom.cdf(k - 1, n, 0.5)
    return float(ordered[k - 1]), float(ordered[n - k]), float(covered)


def log_spread(values):
    """Geometric mean and standard deviation of the natural logarithm; nan for fewer than two."""
    logs = np.log(np.asarray(values, dtype=float))
    if len(logs) < 2:
        return (float(np.exp(logs[0])) if len(logs) else np.nan), np.nan
    return float(np.exp(np.mean(logs))), float(np.std(logs, ddof=1))


def _columns(levels):
    """Indicator columns of a factor, without its first level."""
    found = sorted(set(levels))
    return [np.array([float(level == each) for level in levels]) for each in found[1:]]


def _residual(y, factors):
    """Residual sum of squares and rank of the model with these factors as main effects."""
    design = np.column_stack([np.ones(len(y)), *(c for f in factors for c in _columns(f))])
    fit, _, rank, _ = np.linalg.lstsq(design, y, rcond=None)
    return float(np.sum((y - design @ fit) ** 2)), int(rank)


def variance_table(y, factors):
    """Analysis of variance of main effects: what each factor explains beyond all the others (type II).

    factors: name -> level of each value. Rows (source, sum of squares, degrees of freedom, F, p); the
    last row is the residual. Factors with one level, or whose effect the others already hold, have
    no degrees of freedom and are left out; without residual degrees of freedom F and p are nan.
    """
    y = np.asarray(y, dtype=float)
    used = {name: list(levels) for name, levels in factors.items() if len(set(levels)) > 1}
    rest, rank = _residual(y, used.values())
    freedom = len(y) - rank
    rows = []
    for name in used:
        without, lower = _residual(y, [f for other, f in used.items() if other != name])
        if (degrees := rank - lower) < 1:
            continue
        squares = max(0.0, without - rest)
        noise = 1e-20 * float(np.sum((y - y.mean()) ** 2))  # a residual that is only rounding
        f = squares / degrees / (rest / freedom) if freedom > 0 and rest > noise else np.nan
        p = float(stats.f.sf(f, degrees, freedom)) if np.isfinite(f) else np.nan
        rows.append((name, squares, degrees, f, p))
    return rows + [("residual", rest, freedom, np.nan, np.nan)]


def curves_at(times, curves):
    """Values of curves (time, value, ruptured) at common times, one row each.

    Beyond its end a curve is infinite if the run ruptured there, else unknown (nan).
    """
    rows = []
    for time, value, ruptured in curves:
        row = np.interp(times, time, value)
        row[times > time[-1] * (1 + 1e-12)] = np.inf if ruptured else np.nan
        rows.append(row)
    return np.array(rows)


def band(rows, low=0.1, high=0.9):
    """Median, low and high order quantile at each time; nan where a curve is not known."""
    known = ~np.isnan(rows).any(axis=0)
    result = np.full((3, rows.shape[1]), np.nan)
    for k in np.flatnonzero(known):
        column = rows[:, k]
        result[:, k] = median(column), order_quantile(column, low), order_quantile(column, high)
    return result
