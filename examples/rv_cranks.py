"""
The cranks of an RV reducer
===========================

Three cranks on the carrier run in bores of two discs. The distribution of the load over the cranks varies with the crank angle.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

drive = ltca.load_drive("rv").cases["nominal"]
result = ltca.analyse(drive, positions=24)
data = result.dataset.isel(case=0)
turn = np.degrees(data["crank_angle"])
load = np.hypot(data["bearing_radial"], data["bearing_tangential"])

figure, axes = plt.subplots(figsize=(7.0, 3.4))
for crank in range(drive.crank.number):
    axes.plot(turn, load.isel(disc=0, crank=crank), label=f"crank {crank}")
axes.set(xlabel="crank angle [°]", ylabel="bearing force on disc 0 [N]")
axes.legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
figure.tight_layout()

# %%
# Contributions of the parts to the incremental compliance at the output:

shares = {key[17:]: value for key, value in result.summary.items() if key.startswith("compliance_share_")}
figure, axes = plt.subplots(figsize=(6.4, 2.8))
axes.barh(list(shares), list(shares.values()), color="#4c72b0")
axes.set(xlabel="share of the compliance at the output")
figure.tight_layout()

# %%
# The mean loads of three identical cranks over a turn are equal.

mean = load.isel(disc=0).mean("position").to_numpy()
print(np.round(mean, 1), "N")

# sphinx_gallery_start_ignore
assert np.ptp(mean) / mean.mean() < 0.01  # cranks at 120°, 24 positions: equal by symmetry
assert abs(sum(shares.values()) - 1.0) < 1e-6
assert abs(shares["cranks"] - 0.55) < 0.02  # docs/how-to/several_cranks.md, `cyclo run`
# sphinx_gallery_end_ignore
