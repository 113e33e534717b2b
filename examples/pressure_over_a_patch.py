"""
Pressure over a contact
=======================

``result.pressure`` gives the pressure over one contact at one position: here of the roller that carries most on the inner race,
with straight rollers and with relieved ones.
"""

import matplotlib.pyplot as plt

import ltca

straight = ltca.load_drive("paper").cases["CS-1"]
relieved = straight.with_fields({"crank_bearing.roller_profile.logarithmic_factor": 1.0})
fields = {
    name: ltca.analyse(drive, crank_angle="17 deg").pressure("roller_inner")
    for name, drive in (("straight", straight), ("relieved", relieved))
}
field = fields["straight"]
print(
    f"roller {int(field['roller'])}: {field.attrs['load_N']:.0f} N, {field.attrs['pressure_mid_MPa']:.0f} MPa in the middle"
)

# %%
# The contact zone is a strip as long as the roller and some tenths of a millimetre wide. Pressure rises at ends without relief.

figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.4), sharey=True, layout="constrained")
for column, (name, patch) in zip(axes, fields.items(), strict=True):
    drawn = column.pcolormesh(
        patch["y"], patch["x"], patch, vmax=1.2 * field.attrs["pressure_mid_MPa"], shading="nearest"
    )
    column.set(title=f"{name} rollers", xlabel="along the width [mm]")
axes[0].set(ylabel="along the profile [mm]", ylim=(-0.15, 0.15))
figure.colorbar(drawn, ax=axes).set_label("pressure [MPa]")

# %%
# Along the width, on the middle of the strip. At an end without relief the pressure between elastic bodies is singular: the last
# cell is a hundredth of the length, and its mean is the largest pressure.

figure, axes = plt.subplots(figsize=(7.0, 3.2))
for name, patch in fields.items():
    axes.plot(patch["y"], patch.max("x"), label=name)
axes.set(xlabel="along the width [mm]", ylabel="pressure [MPa]", ylim=(0.0, 2.5 * field.attrs["pressure_mid_MPa"]))
axes.legend(frameon=False)
figure.tight_layout()

# sphinx_gallery_start_ignore
for patch in fields.values():  # pressure times area is the load
    assert abs(float((patch * patch.x_size * patch.y_size).sum()) / patch.attrs["load_N"] - 1.0) < 1e-9
ends = {name: float(patch.max("x")[0] / patch.max("x").sel(y=0.0, method="nearest")) for name, patch in fields.items()}
assert ends["straight"] > 1.5
assert ends["relieved"] < 1.0
# sphinx_gallery_end_ignore
