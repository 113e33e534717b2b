"""
Orders of the transmission error
================================

The transmission error has the periods of the disc teeth and of the pin holes. A simultaneous fit of the known orders
separates these contributions.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca
from ltca.analysis.transmission_error_orders import fit_orders, known_orders

ARCSEC = 180.0 / np.pi * 3600.0

drive = ltca.load_drive("paper").cases["CS-1"]
result = ltca.analyse(drive, positions=104)
error = result.loaded.transmission_error
angle = result.loaded.full.crank_angle

figure, axes = plt.subplots(figsize=(7.0, 3.0))
axes.plot(np.degrees(angle), (error - error.mean()) * ARCSEC)
axes.set(xlabel="crank angle [°]", ylabel="transmission error less its mean [″]")
figure.tight_layout()

# %%
# Orders per turn of the crank: 13 of the flank, 8 of the pin holes, and their multiples.

orders = tuple(order for order in known_orders(drive) if order.value in (8.0, 13.0, 16.0, 26.0))
spectrum = fit_orders(angle, error, orders)
for order, amplitude in zip(spectrum.orders, spectrum.amplitude, strict=True):
    print(f"order {order.value:4.0f}  {amplitude * ARCSEC:5.2f}″  {order.name}")

figure, axes = plt.subplots(figsize=(6.0, 3.0))
axes.bar([f"{order.value:.0f}" for order in spectrum.orders], spectrum.amplitude * ARCSEC, color="#55a868")
axes.set(xlabel="order [per turn of the crank]", ylabel="amplitude [″]")
figure.tight_layout()

# sphinx_gallery_start_ignore
# docs/validation/paper.md, by ``cyclo curves paper --case CS-1``: 1.3″ (flank) and 1.1″ (holes).
assert abs(spectrum.of(13.0) * ARCSEC - 1.3) < 0.1
assert abs(spectrum.of(8.0) * ARCSEC - 1.1) < 0.1
# sphinx_gallery_end_ignore
