"""
A verdict, and what a change makes of it
========================================

``ltca.check`` judges a drive as ``cyclo check`` does: against the limits of its file, its materials, geometry and theory. Here
the wheel pins of a robot joint become thinner.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

file = ltca.load_drive("robot-joint")
drive = file.cases["nominal"]
thinner = drive.with_fields({"pin_wheel": {"pin_radius": "2.2 mm"}, "load.torque": "500 N·m"})
limits = file.limits["nominal"] | {"max_pin_pressure_mid": "1.45 GPa"}

checks = {
    "as drawn": ltca.check(file, positions=28, limits={"max_pin_pressure_mid": "1.45 GPa"}, advice=False),
    "thinner pins, 500 N·m": ltca.check(thinner, positions=28, limits=limits, advice=False),
}
for name, found in checks.items():
    told = ", ".join(check.title for check in found.failed) or "passes"
    print(f"{name}: {told}")

# %%
# Safety is the limit by the value. What lies left of 1 fails.

shown = ("pin_pressure_mid", "roller_pressure_mid_outer", "roller_pressure_mid_inner", "pin_shaft_pressure_mid")
figure, axes = plt.subplots(figsize=(7.0, 2.8))
for place, (name, found) in enumerate(checks.items()):
    axes.barh(np.arange(len(shown)) + 0.36 * place, [found[key].safety for key in shown], height=0.34, label=name)
axes.axvline(1.0, color="black", linewidth=1.0)
axes.set_yticks(np.arange(len(shown)) + 0.18, [found[key].title for key in shown])
axes.invert_yaxis()
axes.set(xlabel="safety")
axes.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
figure.tight_layout()

# sphinx_gallery_start_ignore
before, after = (checks[name]["pin_pressure_mid"] for name in checks)
assert before.verdict == "pass"
assert after.verdict == "fail"
# A line contact has p ∝ √(F/ρ), and five quarters of the torque are shared by a few pins more.
assert 1.05 < after.value.value / before.value.value < 1.25**0.5 * (2.5 / 2.2) ** 0.5
# sphinx_gallery_end_ignore
