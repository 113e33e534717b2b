"""Figures of docs/theory/seats.md: laws of conforming seats against finite elements, Persson and Hertz.

``python -m validation.seats [--out docs/pictures]`` prints the tables and draws the picture; half a minute.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from fem.testing.seated_pin import SleeveOnPin, press_pin_into_bore, squeeze_sleeve
from ltca.arrays import FloatArray
from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.drive.parts import Material, contact_modulus
from ltca.laws.conforming import ConformingLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.output.files import whole_file

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
BRONZE = Material(youngs_modulus=110_000.0, poisson_ratio=0.34)
LENGTH = 12.0
ELEMENTS = 48.0
# Pin, bore and datum radius, load, bore.
SEATS = (
    (4.0, 4.004, 6.0, 10.0, STEEL),
    (4.0, 4.004, 6.0, 1150.0, STEEL),
    (4.0, 4.004, 6.0, 20_000.0, STEEL),
    (1.5, 1.51, 2.5, 1150.0, STEEL),
    (5.0, 5.02, 8.0, 4000.0, STEEL),
    (5.0, 5.02, 8.0, 4000.0, BRONZE),
    (4.0, 4.4, 9.0, 1150.0, STEEL),
    (4.0, 6.0, 9.0, 1150.0, BRONZE),
)
# Pin, bore and outer radius, load, sleeve.
SLEEVES = (
    (1.5, 1.51, 2.5, 100.0, STEEL),
    (1.5, 1.51, 2.5, 1150.0, STEEL),
    (1.5, 1.51, 2.5, 3000.0, STEEL),
    (5.0, 5.02, 7.0, 1150.0, STEEL),
    (5.0, 5.02, 7.0, 4000.0, BRONZE),
    (5.0, 5.02, 10.0, 4000.0, STEEL),
    (5.0, 5.02, 6.0, 1000.0, BRONZE),
)


def persson_load(half_width: ArrayLike) -> FloatArray:
    """Return F/(L E* ΔR) of equal materials at b = tan(α/2) (Ciavarella and Decuzzi 2001, after Persson 1964)."""
    b = np.asarray(half_width, dtype=float)
    return np.asarray(2.0 * np.pi * b**2 * (b**2 + 1.0) / (2.0 - np.log(b**2 + 1.0) - 2.0 * b**4))


def persson_pressure(angle: ArrayLike, half_width: ArrayLike) -> FloatArray:
    """Return p a L/F of equal materials at an angle from the line of load, rad, within the arc; b = tan(α/2)."""
    b, y = np.asarray(half_width, dtype=float), np.tan(0.5 * np.asarray(angle, dtype=float))
    root, edge = np.sqrt(b**2 - y**2), np.sqrt(b**2 + 1.0)
    logarithm = np.log((edge + root) / (edge - root))
    return np.asarray((2.0 * root / (edge * (1.0 + y**2)) + logarithm / (2.0 * b**2 * edge**2)) / np.pi)


def hertz_rows() -> Iterator[str]:
    """Yield a line for each load of the issue's slot: arc, peak pressure and approach by Hertz and by the law."""
    yield "where Hertz ends: pin 4.0 mm, slot 4.004 mm, datum 6 mm, 12 mm long, steel"
    law = _bore_law(*SEATS[1])
    play, radius = 0.004, 4.0 * 4.004 / 0.004
    for load in (10.0, 30.0, 100.0, 300.0, 1150.0, 3000.0, 20_000.0):
        width = float(line_half_width(load / LENGTH, radius, law.contact_modulus))
        peak = float(line_peak_pressure(load / LENGTH, radius, law.contact_modulus))
        # The law's own logarithm continued from loads where both agree, with Hertz' arc in it.
        light = 1e-9
        at_light = float(law.approach_and_compliance(light, play)[0]) / light
        scale = LENGTH * law.contact_modulus * np.pi
        approach = load * (at_light - np.log(load / light) / scale)
        angle, pressure = float(law.half_angle(load, play)), float(law.largest_pressure(load, play))
        travel = float(law.approach_and_compliance(load, play)[0])
        yield (
            f"  {load:7.0f} N  q {load / (LENGTH * law.contact_modulus * play):8.4f}  Hertz b/r {width / law.radius:.4f} "
            f"law α {angle:.4f} rad ({width / law.radius / angle - 1.0:+.1%})  peak {peak:.1f} against {pressure:.1f} MPa "
            f"({peak / pressure - 1.0:+.1%})  approach {1e3 * approach:.4f} against {1e3 * travel:.4f} µm "
            f"({approach / travel - 1.0:+.1%})"
        )


def _bore_law(pin_radius: float, bore_radius: float, datum: float, _load: float, bore: Material) -> ConformingLaw:
    return ConformingLaw.of_bodies(
        pin=STEEL, bore=bore, pin_radius=pin_radius, bore_radius=bore_radius, datum_radius=datum, length=LENGTH
    )


def seat_rows() -> Iterator[str]:
    """Yield a line for each seat: the law against finite elements."""
    yield f"pin in a bore, law against finite elements ({ELEMENTS:g} elements over the arc)"
    for case in SEATS:
        pin_radius, bore_radius, datum, load, bore = case
        law, play = _bore_law(*case), bore_radius - pin_radius
        half_angle = float(law.half_angle(load, play))
        found = press_pin_into_bore(
            pin=STEEL,
            bore=bore,
            pin_radius=pin_radius,
            bore_radius=bore_radius,
            datum_radius=datum,
            length=LENGTH,
            load=load,
            half_angle=half_angle,
            elements=ELEMENTS,
        )
        approach = float(law.approach_and_compliance(load, play)[0])
        pressure = float(law.largest_pressure(load, play))
        yield (
            f"  {pin_radius:g} in {bore_radius:g} mm, E {bore.youngs_modulus:g} MPa, {load:.0f} N: α {half_angle:.4f} rad  "
            f"approach {1e3 * approach:.4f} against {1e3 * found.approach:.4f} µm ({approach / found.approach - 1.0:+.2%})  "
            f"peak {pressure:.2f} against {found.largest_pressure:.2f} MPa ({pressure / found.largest_pressure - 1.0:+.2%})"
        )


def sleeve_rows() -> Iterator[str]:
    """Yield a line for each sleeve: its law, and the sum of laws without a wall, against finite elements.

    All are the travel between the pin and a flat flank's patch outside, the flank's own half left out: the mean
    displacement under the patch and half the mean separation.
    """
    yield "sleeve between its pin and a patch outside, against finite elements"
    for pin_radius, bore_radius, outer_radius, load, sleeve in SLEEVES:
        play = bore_radius - pin_radius
        law = ConformingLaw.of_sleeve(
            pin=STEEL,
            sleeve=sleeve,
            pin_radius=pin_radius,
            bore_radius=bore_radius,
            outer_radius=outer_radius,
            datum=outer_radius,
            length=LENGTH,
        )
        no_wall = _bore_law(pin_radius, bore_radius, outer_radius, load, sleeve)
        modulus = contact_modulus(STEEL, sleeve)
        width = float(line_half_width(load / LENGTH, outer_radius, modulus))
        seat = SleeveOnPin(
            pin=STEEL,
            sleeve=sleeve,
            pin_radius=pin_radius,
            bore_radius=bore_radius,
            outer_radius=outer_radius,
            length=LENGTH,
            half_angle=float(law.half_angle(load, play)),
            patch_half_width=width,
        )
        found = squeeze_sleeve(seat, *seat.meshes(ELEMENTS), load)
        # The sleeve's share of the laws of the flank contact, by its share of 1/E*.
        share = sleeve.plane_strain_compliance * modulus
        travel = found.approach + share * width**2 / (8.0 * outer_radius)
        plane = 2.0 * load / LENGTH / (np.pi * modulus) * (np.log(2.0 * outer_radius / width) + 0.5)
        line = float(LineContactLaw(LENGTH, modulus).approach_at_load(np.array([load]), outer_radius)[0][0])
        walled = share * plane + float(law.approach_and_compliance(load, play)[0])
        bare = float(no_wall.approach_and_compliance(load, play)[0])
        flank = (1.0 - share) * line
        sums = [share * plane + bare, share * line + bare]
        yield (
            f"  {pin_radius:g} in {bore_radius:g} in {outer_radius:g} mm, E {sleeve.youngs_modulus:g} MPa, {load:.0f} N: "
            f"FE {1e3 * travel:.3f} µm, law of the sleeve {1e3 * walled:.3f} ({walled / travel - 1.0:+.2%}); without a wall: "
            f"plane strain, datum R, {1e3 * sums[0]:.3f} ({sums[0] / travel - 1.0:+.0%}), half-space {1e3 * sums[1]:.3f} "
            f"({sums[1] / travel - 1.0:+.0%}; {(sums[1] + flank) / (travel + flank) - 1.0:+.0%} with the flank's half); "
            f"peak FE {found.largest_pressure:.1f}, of the sleeve {float(law.largest_pressure(load, play)):.1f} "
            f"({float(law.largest_pressure(load, play)) / found.largest_pressure - 1.0:+.2%}), without a wall "
            f"{float(no_wall.largest_pressure(load, play)):.1f} MPa "
            f"({float(no_wall.largest_pressure(load, play)) / found.largest_pressure - 1.0:+.0%})"
        )


def draw(path: Path) -> None:
    """Draw arc and peak pressure over the load and the pressure over the arc, against Persson and Hertz, as SVG."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    law = _bore_law(*SEATS[1])
    q = np.geomspace(1e-3, 1e2, 80)
    load = q * LENGTH * law.contact_modulus
    arcs = np.concatenate([np.geomspace(0.02, 0.7, 12), [0.8, 0.86, 0.885]])
    unit = law.contact_modulus / law.radius
    # Text stays text; without a date and with a salt the same figures make the same file.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "seats", "font.size": 9.0}):
        figure = Figure(figsize=(11.0, 3.4), layout="constrained")
        left, middle, right = figure.subplots(1, 3)
        left.semilogx(q, np.degrees(law.half_angle(load, 1.0)), "k", label="law")
        left.semilogx(persson_load(arcs), np.degrees(2.0 * np.arctan(arcs)), "o", ms=4, mfc="none", label="Persson")
        left.semilogx(q, np.degrees(np.sqrt(4.0 * q / np.pi)), "--", label="Hertz")
        left.set(xlabel="F/(L E* ΔR)", ylabel="half the arc α, degrees", ylim=(0.0, 120.0))
        middle.loglog(q, law.largest_pressure(load, 1.0) / unit, "k", label="law")
        peaks = persson_pressure(0.0, arcs) * persson_load(arcs)
        middle.loglog(persson_load(arcs), peaks, "o", ms=4, mfc="none", label="Persson")
        middle.loglog(q, np.sqrt(q / np.pi), "--", label="Hertz")
        middle.set(xlabel="F/(L E* ΔR)", ylabel="peak pressure · a/(E* ΔR)")
        for color, b in zip(("C0", "C1", "C2", "C3"), (0.1, 0.25, 0.5, 0.9), strict=True):
            alpha = 2.0 * np.arctan(b)
            angle = alpha * np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 61))[1:-1]
            right.plot(np.degrees(angle), persson_pressure(angle, b), color, label=f"α = {np.degrees(alpha):.0f}°")
            ellipse = 2.0 / (np.pi * alpha) * np.sqrt(1.0 - (angle / alpha) ** 2)
            right.plot(np.degrees(angle), ellipse, color, ls="--", lw=0.8)
        right.set(xlabel="θ, degrees", ylabel="p a L/F (dashed: ellipse on that arc)")
        for axes in (left, middle, right):
            axes.legend(frameon=False)
            axes.grid(visible=True, lw=0.3)
        with whole_file(path) as part, part.open("wb") as stream:
            figure.savefig(stream, format="svg", metadata={"Date": None})


def main() -> None:
    """Print the tables and draw the picture."""
    parser = argparse.ArgumentParser(prog="python -m validation.seats", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/pictures"), help="folder (default: docs/pictures)")
    folder = parser.parse_args().out
    for rows in (hertz_rows(), seat_rows(), sleeve_rows()):
        for row in rows:
            print(row, flush=True)
    draw(folder / "seats.svg")


if __name__ == "__main__":
    main()
