"""What the timing scripts share: the machine, other programs' load, medians, tables."""
import datetime
import os
import platform
import re
import resource
import statistics
import time


def machine():
    """Name of the processor, how many of it this program sees, and the operating system."""
    text = open("/proc/cpuinfo").read()
    def field(name):
        found = re.search(rf"^{name}\s*: (.*)$", text, re.M)
        return found.group(1) if found else "?"
    visible = len(os.sched_getaffinity(0))
    return (f"{field('model name')}, family {field('cpu family')} model {field('model')}, "
            f"{visible} visible; {platform.system()} {platform.release()}")


def today():
    return datetime.date.today().isoformat()


def busy_seconds():
    """Processor seconds that all programs have used so far."""
    user, nice, system, _, _, hard, soft = map(int, open("/proc/stat").readline().split()[1:8])
    return (user + nice + system + hard + soft) / os.sysconf("SC_CLK_TCK")


def own_seconds():
    """Processor seconds of this program and of those that it started and that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


class OtherPrograms:
    """Mean number of processors busy with other programs since it was made."""

    def __init__(self):
        self.begin = time.monotonic(), busy_seconds(), own_seconds()

    def processors(self):
        elapsed = time.monotonic() - self.begin[0]
        foreign = busy_seconds() - self.begin[1] - (own_seconds() - self.begin[2])
        return max(0.0, foreign / elapsed)


def spread(values):
    """Median, least and most as one text."""
    return f"{statistics.median(values):.3g} ({min(values):.3g} to {max(values):.3g})"


def print_table(header, rows):
    widths = [max(len(str(row[k])) for row in [header, *rows]) for k in range(len(header))]
    for row in [header, ["-" * w for w in widths], *rows]:
        print("  ".join(str(cell).ljust(w) for cell, w in zip(row, widths)).rstrip())
