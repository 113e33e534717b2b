"""
A first analysis
================

Load a drive, analyse it over a turn of the crank, and plot the results. The drive is that of the paper, in the case without
clearances.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

drive = ltca.load_drive("paper").cases["CS-1"]
result = ltca.analyse(drive, positions=52)
print(result)

# %%
# The dataset has all quantities with names and units. A wheel pin carries load over a part of the turn; the next pin follows
# a tooth pitch later.

data = result.dataset.isel(case=0, disc=0)
turn = np.degrees(data["crank_angle"])

figure, axes = plt.subplots(figsize=(7.0, 3.6))
for pin in range(0, 14, 2):
    axes.plot(turn, data["pin_load"].sel(pin=pin), label=f"pin {pin}")
axes.set(xlabel="crank angle [°]", ylabel="load of the wheel pin [N]")
axes.legend(ncols=4, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 1.22), frameon=False)
figure.tight_layout()

# %%
# The mean bearing force perpendicular to the eccentricity is T/(u e) for any clearances, by the balance of work.

mean = float(data["bearing_tangential"].mean())
print(f"{mean:.1f} N, and T/(u e) = {drive.load.torque / (drive.reduction_ratio * drive.crank.eccentricity):.1f} N")

# sphinx_gallery_start_ignore
# The paper prints 6737.5 N; 52 positions are four per tooth pitch.
assert abs(mean - 6737.5) < 2.0
# sphinx_gallery_end_ignore
