"""
Error of half-spaces for wide contacts
======================================

Half-space models neglect the curvature of the bodies. A cylinder with its true boundary, solved by Fourier series in plane
strain, gives their error.
"""

import matplotlib.pyplot as plt
import numpy as np

from ltca.testing.elastic_cylinder import hertz_approach, press_cylinder, press_half_plane

widths = np.array([0.05, 0.1, 0.15, 0.2, 0.25, 0.3])
off: dict[str, list[float]] = {"parabola (tables)": [], "true separation (grids)": []}
for width in widths:
    approach = hertz_approach(width)
    right = press_cylinder(approach, 100, 0.4)
    for name, parabola in zip(off, (True, False), strict=True):
        found = press_half_plane(approach, 100, 0.4, parabola=parabola)
        off[name].append(100.0 * (found.line_load / right.line_load - 1.0))

figure, axes = plt.subplots(figsize=(6.4, 3.4))
for name, error in off.items():
    axes.plot(widths, error, marker="o", label=name)
axes.axvline(0.3, color="#888888", linewidth=0.8, linestyle="--")
axes.set(xlabel="half-width by radius b/r", ylabel="error of the load [%]")
axes.legend(frameon=False)
figure.tight_layout()

# %%
# Beyond b/r = 0.3 a run refuses the drive and gives the torque that can be carried.

print({name: np.round(error, 2).tolist() for name, error in off.items()})

# sphinx_gallery_start_ignore
# docs/validation/index.md, by ``benchmarks/wide_contacts.py`` on finer cells.
assert abs(off["parabola (tables)"][-1] - 1.51) < 0.1
assert abs(off["true separation (grids)"][-1] - 0.98) < 0.1
# sphinx_gallery_end_ignore
