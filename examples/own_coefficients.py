"""
Own coefficients, a derivative, a figure for print
==================================================

What a study needs: influence coefficients of the bodies from a finite-element code of your own, loads with them, how a result
follows a dimension or the torque, and a figure as a PDF file.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import ltca
from fem.coefficients.dataset import derive_coefficients
from fem.coefficients.fit import check_against_drive
from ltca.reading.coefficient_file import read_coefficients, write_coefficients
from ltca.reading.coefficient_laws import check_coefficients

folder = Path(tempfile.mkdtemp())
drive = ltca.load_drive("paper").cases["CS-1"]

# %%
# The file has the positions at which your code is to load the disc, and the format of its answers. Here a coarse derivation with
# a quarter of the stations stands for them: replace its ``disc_approach`` and the like by the displacements that your code finds.

dataset = derive_coefficients(drive, case="CS-1", stations=0.25, size=2.0)
print("load at x, y [mm]:", dataset["station_x"].values[:3].round(3), dataset["station_y"].values[:3].round(3))
write_coefficients(dataset, folder / "mine.nc")

# %%
# Before it is used a file is held against physical laws, and against the drive that it is to serve: reciprocity, rigid motions,
# the near field of a line load, places and normals.

mine = read_coefficients(folder / "mine.nc", lawful=False)
for law in (*check_coefficients(mine), *check_against_drive(mine, drive, "mine.nc")):
    print(f"{'passes' if law.passed else 'fails'}: {law.name}")

# %%
# Loads with these bodies and with half-spaces, over a period of the flank, and how the pin loads follow the torque: the
# derivative comes from the Jacobian of the balance, no second solution is needed.

angles = np.linspace(0.0, 2.0 * np.pi / 13.0, 12, endpoint=False)
result = ltca.analyse(drive, crank_angle=angles, compliance=ltca.Hybrid(coefficients=folder / "mine.nc"))
half_space = ltca.analyse(drive, crank_angle=angles, compliance="half-space")
slopes = ltca.derivatives(result, ["load.torque"])
print(f"{float(slopes['max_pin_load_N'].squeeze()) * 1e3:.2f} N more on the most loaded wheel pin by 1 N·m")

figure, axes = plt.subplots(figsize=(3.4, 2.4))  # one column of a journal, in
for name, found in (("half-spaces", half_space), ("own coefficients", result)):
    axes.plot(np.degrees(angles), found.dataset["pin_load"].squeeze().max("pin") / 1e3, label=name)
axes.set(xlabel="crank angle [°]", ylabel="largest pin load [kN]")
axes.legend(frameon=False)
figure.tight_layout()
figure.savefig(folder / "figure.pdf")

# sphinx_gallery_start_ignore
ratio, eccentricity = 14.0, drive.crank.eccentricity
per_torque = slopes["bearing_tangential"].squeeze().mean().item()
assert abs(per_torque * ratio * eccentricity - 1.0) < 2e-3  # balance of power, T/(u e), in the mean over a period
assert (folder / "figure.pdf").read_bytes().startswith(b"%PDF")
# sphinx_gallery_end_ignore
