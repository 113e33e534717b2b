"""
Thermal expansion of a plastic disc
===================================

PA12 expands ten times as much as steel. At which temperature is the clearance of a plastic disc lost?
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca
from ltca.drive.members.temperatures import warm_drive
from ltca.geometry.pairs import ContactGeometry

drive = ltca.load_drive("paper").cases["CS-3"]
expansion = dict.fromkeys(
    (f"materials.{part}.thermal_expansion" for part in ("roller", "inner_race", "shaft_pin")), 11.4e-6
)
plastic = drive.with_fields({"materials.disc": "PA12", "load.torque": "5 N m", **expansion})

warmth = np.array([20.0, 22.0, 24.0, 26.0, 28.0])
angle = 2.0 * np.pi * np.arange(52) / 52
gap = []
for celsius in warmth:
    warm = warm_drive(plastic.with_fields({"temperature.disc": celsius}))
    approach = ContactGeometry.of_drive(warm).flank(angle, np.zeros((52, 4))).approach
    gap.append(-float(approach.max()))

figure, axes = plt.subplots(figsize=(6.4, 3.4))
axes.plot(warmth, np.array(gap) * 1e3, marker="o")
axes.axhline(0.0, color="#888888", linewidth=0.8, linestyle="--")
axes.set(xlabel="temperature of the disc [°C], housing at 20 °C", ylabel="least gap of flank and pins [µm]")
figure.tight_layout()

# %%
# The clearance decreases per kelvin by the expansion of the disc at the pin circle, about 110e-6/K times 88 mm.

slope = np.polyfit(warmth, np.array(gap) * 1e3, 1)[0]
print(f"{slope:.1f} µm/K")

# sphinx_gallery_start_ignore
largest = 1e3 * 110e-6 * drive.pin_wheel.pin_circle_radius
assert -1.05 * largest < slope < -0.8 * largest
# sphinx_gallery_end_ignore
