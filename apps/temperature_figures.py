"""Results at several temperatures in one reduced time or frequency."""
import numpy as np
from sheet import Sheet

REFERENCE = "Temperature/Reference temperature"


def comparable(results):
    """Results that differ in their shift aT and share the temperature for which it is 1."""
    shifted = [r for r in results if r.shift and r.scene.get("Temperature/Shift law") != "none"]
    alike = len({r.scene.get(REFERENCE) for r in shifted}) == 1
    return shifted if alike and len({r.shift for r in shifted}) > 1 else []


def reference(results):
    return results[0].scene[REFERENCE].replace("degC", "\u00b0C")


def label(r):
    return r.legend(f"log aT = {np.log10(r.shift):.2f}")


def widths(results):
    """Lines that coincide stay visible: the first is the widest."""
    return np.linspace(1 + 0.8 * (len(results) - 1), 1, len(results))


def draw_reduced_time(results, key, folder):
    """Creep at several temperatures over time, and over reduced time."""
    sheet, kind = Sheet(results, (1, 1)), results[0].kind
    alike = [r for r in results if r.kind is kind]
    for r, width in zip(alike, widths(alike)):
        time, value = r.curve()
        shown = (time > 0) & (value * np.sign(value[-1]) > 0)
        sheet.panels[0].plot(time[shown], value[shown], **r.look, label=label(r))
        sheet.panels[1].plot(time[shown] / r.shift, value[shown], **r.look, lw=width)
    sheet.label(0, "Time [s]", kind.axis, "xy")
    sheet.label(1, f"Reduced time t / aT [s], at {reference(alike)}", kind.axis, "xy")
    sheet.save(folder / f"{kind.name}_reduced_time.png", key,
               "Without breakage and at the same load all curves are one over reduced time.")


def draw_master_curve(results, key, folder):
    """Complex modulus and phase angle over reduced frequency."""
    sheet = Sheet(results, (1, 1))
    for r, width in zip(results, widths(results)):
        for axes, column in zip(sheet.panels, ("complex_modulus_MPa", "phase_angle_degrees")):
            axes.plot(r.modulus["frequency_Hz"] * r.shift, r.modulus[column], marker="o", mfc="none",
                      ms=2 + 1.7 * width, lw=1, label=label(r), **r.look)
    axis = f"Reduced frequency f aT [Hz], at {reference(results)}"
    sheet.label(0, axis, "|E*| [MPa]", "xy")
    sheet.label(1, axis, "Phase angle [degrees]", "x")
    sheet.panels[1].set_ylim(bottom=0)
    sheet.save(folder / "master_curve.png", key)
