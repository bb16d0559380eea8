"""What figures compute of curves: rates, flow time, peaks, bins. Pure functions of arrays."""
import numpy as np

WINDOW, PER_DECADE = 0.1, 100  # of smoothed rates [decades of time], and how many
BINS_PER_DECADE, BINS = 5, 50  # of breakages, over log time and over time
FALL = 0.05  # share of the stress that a maximum loses if it is a peak


def event_order(time, value, n_broken, break_time, break_value):
    """A curve with its values just before each breakage, in the order in which they happened."""
    n = np.concatenate([n_broken, np.arange(len(break_time))])
    time, value = np.concatenate([time, break_time]), np.concatenate([value, break_value])
    order = np.lexsort((n, time))
    return time[order], value[order]


def before_collapse(time, value):
    """The curve up to its last instant if it jumps there by a tenth or more; whether it does."""
    first = int(np.searchsorted(time, time[-1]))
    jumps = abs(value[-1] - value[first]) > 0.1 * abs(value[-1])
    return (time[:first + 1], value[:first + 1], True) if jumps else (time, value, False)


def smoothed_rate(time, value):
    """Slopes of chords over windows of WINDOW decades of time, centred in log time.

    Near the end the windows narrow, down to a fifth, so as to stay within the record.
    """
    half = 10 ** (WINDOW / 2)
    first, last = time[time > 0][0] * half, time[-1] / half**0.2
    if first >= last:
        return np.empty(0), np.empty(0)
    centre = np.geomspace(first, last, int(PER_DECADE * np.log10(last / first)) + 2)
    reach = np.minimum(half, time[-1] / centre)
    low, high = centre / reach, centre * reach
    return centre, (np.interp(high, time, value) - np.interp(low, time, value)) / (high - low)


def flow_time(rate):
    """Index of the least smoothed rate if a rise of more than noise follows it, else None.

    The rise, to the last rates, must exceed 10 % and three times the noise: the scatter of log
    rates about the mean of those a window before and after, in the decade before the minimum.
    """
    lag = round(WINDOW * PER_DECADE)
    if len(rate) <= 2 * lag or not np.all(rate > 0):
        return None
    k, y = int(np.argmin(rate)), np.log10(rate)
    if k == 0 or k >= len(rate) - lag:
        return None
    before = y[max(0, k - PER_DECADE):k + 1]
    bend = before[lag:-lag] - (before[:-2 * lag] + before[2 * lag:]) / 2
    noise = 1.4826 * np.median(np.abs(bend)) / np.sqrt(1.5) if len(bend) else 0
    return k if np.median(y[-lag:]) - y[k] > max(np.log10(1.1), 3 * noise) else None


def peak(stress):
    """Index of the largest stress by amount, and whether a fall by FALL follows it."""
    size = np.abs(stress)
    k = int(np.argmax(size))
    return k, bool(size[k:].min() <= (1 - FALL) * size[k])


def bin_edges(first, last, logarithmic):
    """Bins of equal width in time, or in log time."""
    last *= 1 + 1e-12
    if logarithmic:
        n = max(1, round(BINS_PER_DECADE * np.log10(last / first)))
        return np.geomspace(first, last, n + 1)
    return np.linspace(first, last, BINS + 1)


def binned_rate(times, edges):
    """Number per time in each bin."""
    return np.histogram(times, edges)[0] / np.diff(edges)


def power_law(x, y):
    """Exponent and factor of the power law nearest to points in log-log."""
    exponent, log_factor = np.polyfit(np.log(x), np.log(y), 1)
    return exponent, np.exp(log_factor)
