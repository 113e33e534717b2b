"""Where half-spaces end: contacts wider than the bodies are curved are refused, by name."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ltca.compliance.response import ContactPressures, Response
from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.geometry.interference import ROUNDING, drawn_interference

FloatArray = NDArray[np.float64]

HALF_WIDTH_BOUND = 0.3
"""Largest contact half-width as a part of the smallest radius in contact: beyond it the bodies are no half-spaces
and the separation is no parabola."""
PIN, OUTER, INNER = "wheel pin", "roller on the bore", "roller on the inner race"


def check_half_widths(
    drive: Drive, contacts: Response, pressures: ContactPressures, torque: float | None = None
) -> None:
    """Refuse contacts wider than half-spaces stand for.

    Parameters
    ----------
    drive : Drive
        For the radii.
    contacts, pressures : Response, ContactPressures
        Of the solved positions.
    torque : float, optional
        Output torque, N·mm, for the message; none for a batch whose drives have torques of their own.

    Raises
    ------
    DriveError
        One sentence for each kind of contact that is too wide, naming the widest.
    """
    pin_radius, roller = drive.pin_wheel.pin_radius, drive.crank_bearing.roller_radius
    # 1/ρ = 1/r_pin + κ: the radius of a convex flank is a bound as well as the pin's; a concave one is wider than its pin.
    curvature = 1.0 / contacts.flank.effective_radius - 1.0 / pin_radius
    flank_radius = 1.0 / np.maximum(curvature, 1e-9)
    found: list[tuple[str, FloatArray, FloatArray | float]] = [
        (PIN, pressures.pins.half_width, np.minimum(flank_radius, pin_radius)),
        (OUTER, pressures.outer.half_width, roller),
        (INNER, pressures.inner.half_width, roller),
    ]
    problems = []
    for name, half_width, radius in found:
        ratio = half_width / (HALF_WIDTH_BOUND * radius)
        if np.max(ratio) > 1.0:
            worst = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            bound = float(half_width[worst] / ratio[worst])
            named = _cause(drive, contacts, name, worst, torque)
            problems.append(
                f"{named} cannot be carried: contact half-width {half_width[worst]:.4g} mm of {name} {worst[1]}, must "
                f"be at most {bound:.4g} mm ({HALF_WIDTH_BOUND:g} of the smallest radius in contact)"
            )
    if problems:
        raise DriveError(problems)


def _cause(drive: Drive, contacts: Response, name: str, worst: tuple[np.intp, ...], torque: float | None) -> str:
    """Field that presses a contact so wide: the fit where most of the approach was there before the load."""
    overlaps = drawn_interference(drive)
    if name == PIN:
        overlap, field, value = overlaps.pins, "disc.equidistant_offset", drive.disc.equidistant_offset
    else:
        overlap, field, value = overlaps.rollers, "crank_bearing.roller_radius", drive.crank_bearing.roller_radius
    if overlap > ROUNDING:
        approach = (
            contacts.flank.approach
            if name == PIN
            else contacts.rollers.inner_approach + contacts.rollers.outer_approach
        )
        if overlap > 0.5 * approach[worst]:
            return f"{field} = {value:g} mm: an overlap of {overlap:.4g} mm as drawn"
    return "load.torque" if torque is None else f"load.torque = {torque:g} N·mm"
