"""Errors of the half-plane for wide contacts, compared with an elastic cylinder with its true boundary.

``python benchmarks/wide_contacts.py`` prints the errors of load, half-width and largest pressure at equal approach, in per
cent of `ltca.testing.elastic_cylinder.press_cylinder`, over the ratio of half-width to radius. ``parabola`` is the separation
used by the tables, ``circle`` that of ``direct``.
"""

from __future__ import annotations

import argparse

from ltca.testing.elastic_cylinder import CylinderContact, hertz_approach, press_cylinder, press_half_plane

CELLS, REACH = 400, 0.4
WIDTHS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3)


def errors(found: CylinderContact, right: CylinderContact) -> str:
    """Return the three errors in per cent as a row."""
    pairs = (
        (found.line_load, right.line_load),
        (found.half_width, right.half_width),
        (found.peak_pressure, right.peak_pressure),
    )
    return "".join(f"{100.0 * (value / reference - 1.0):9.3f}" for value, reference in pairs)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--widths", type=float, nargs="+", default=WIDTHS, help="b/r; default 0.02 to 0.3")
    arguments = parser.parse_args()
    titles = "".join(f"{name:>9}" for name in ("load", "width", "peak"))
    print(f"{'b/r':>6}   parabola {titles}   circle {titles}   per cent")
    for half_width in arguments.widths:
        approach = hertz_approach(half_width)
        right = press_cylinder(approach, CELLS, REACH)
        parabola, circle = (press_half_plane(approach, CELLS, REACH, parabola=flag) for flag in (True, False))
        print(f"{half_width:6.2f}            {errors(parabola, right)}          {errors(circle, right)}")


if __name__ == "__main__":
    main()
