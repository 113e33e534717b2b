"""Where half-spaces end: contacts wider than the bodies are curved are refused, by name."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ltca.compliance.response import ContactPressures, Response
from ltca.drive.parts import Drive
from ltca.errors import DriveError

FloatArray = NDArray[np.float64]

HALF_WIDTH_BOUND = 0.3
"""Largest contact half-width as a part of the smallest radius in contact: beyond it the bodies are no half-spaces
and the separation is no parabola."""


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
        ("wheel pin", pressures.pins.half_width, np.minimum(flank_radius, pin_radius)),
        ("roller on the bore", pressures.outer.half_width, roller),
        ("roller on the inner race", pressures.inner.half_width, roller),
    ]
    discs = drive.disc.number_of_discs
    named = "load.torque" if torque is None else f"load.torque = {torque:g} N·mm"
    problems = []
    for name, half_width, radius in found:
        ratio = half_width / (HALF_WIDTH_BOUND * radius)
        if np.max(ratio) > 1.0:
            worst = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            bound = float(half_width[worst] / ratio[worst])
            disc, pair = divmod(int(worst[1]), ratio.shape[1] // discs)
            place = f"{pair}" if discs == 1 else f"{pair} of disc {disc}"
            problems.append(
                f"{named} cannot be carried: contact half-width {half_width[worst]:.4g} mm of {name} {place}, must "
                f"be at most {bound:.4g} mm ({HALF_WIDTH_BOUND:g} of the smallest radius in contact)"
            )
    if problems:
        raise DriveError(problems)
