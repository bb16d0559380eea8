"""Damage and rate data for modellers from creep tests with breakage: tables of pure numbers."""
import numpy as np
from curves import before_collapse, flow_time, power_law, smoothed_rate

COLUMNS = ("axial_stress_kPa", "minimum_creep_rate_per_s", "time_of_minimum_s", "strain_at_minimum_percent",
           "rupture_time_s", "monkman_grant_product", "broken_share")


def creep_row(r):
    """Rate data of one creep test; nan where the test does not show it.

    The minimum creep rate is that of the smoothed curve before the collapse, if a rise follows it or
    the specimen collapses; else the rate was still falling when the test ended.
    """
    (time, strain), (full, release) = r.curve(), r.loaded()
    held = (time >= full) & (time <= release)
    time, strain, collapsed = before_collapse(time[held], strain[held])
    centre, rate = smoothed_rate(time, 0.01 * strain * np.sign(strain[-1]))
    ruptured = collapsed or r.about["end"] == "lost equilibrium"
    stress = float(np.median(np.abs(r.stress[r.stress != 0])))
    row = dict.fromkeys(COLUMNS, np.nan)
    row.update(axial_stress_kPa=stress, broken_share=len(r.breakages["time_s"]) / max(1, r.n_bonds),
               rupture_time_s=r.end if ruptured else np.nan)
    k = flow_time(rate)
    row["rise_follows"] = k is not None
    if k is None and ruptured and len(rate):
        positive = np.where(rate > 0, rate, np.inf)
        k = int(np.argmin(positive))
    if k is not None and np.isfinite(rate[k]) and rate[k] > 0:
        row.update(minimum_creep_rate_per_s=float(rate[k]), time_of_minimum_s=float(centre[k]),
                   strain_at_minimum_percent=float(np.interp(centre[k], time, np.abs(strain))))
        if ruptured:
            row["monkman_grant_product"] = row["minimum_creep_rate_per_s"] * r.end
    return row


def fitted(rows, x, y):
    """Power law through the rows that have both columns: exponent, factor, and how many rows."""
    points = np.array([(row[x], row[y]) for row in rows
                       if np.isfinite(row[x]) and np.isfinite(row[y]) and row[y] > 0])
    if len({p[0] for p in map(tuple, points)}) < 2:
        return None
    exponent, factor = power_law(points[:, 0], points[:, 1])
    return exponent, factor, len(points)


def compliance_growth(r):
    """Share of broken bonds, and compliance over its value when the fewest were broken.

    Elastic compliance of the damaged network if the solver knows it, else the creep compliance over
    that of the first time, which holds creep as well as damage.
    """
    broken = r.history["broken_bonds"] / r.n_bonds
    modulus = r.history.get("elastic_modulus_MPa")
    if modulus is not None and np.isfinite(modulus).sum() > 1:
        kept = np.isfinite(modulus) & (modulus > 0)
        value = 1 / modulus[kept]
        return broken[kept], value / value[0], True
    compliance = np.abs(r.history["creep_compliance_per_GPa"])
    kept = np.isfinite(compliance) & (compliance > 0)
    return broken[kept], compliance[kept] / compliance[kept][0], False


def text(rows, fits):
    """The table as CSV; below it, as comment lines, the power laws."""
    lines = [",".join(("run", *COLUMNS))]
    for name, row in rows:
        lines.append(",".join([name] + ["" if np.isnan(row[c]) else f"{row[c]:.10g}" for c in COLUMNS]))
    for label, fit in fits:
        lines.append(f"# {label}: " + ("not enough runs" if fit is None else
                                       f"exponent {fit[0]:.4g}, factor {fit[1]:.4g}, {fit[2]} runs"))
    return "\n".join(lines) + "\n"
