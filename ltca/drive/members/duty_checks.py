"""What a duty and a lubricant cannot be: shares of the time that do not add up, a film that no speed draws in."""

from __future__ import annotations

from collections.abc import Iterator
from math import fsum

from ltca.drive.parts import Drive

SHARES = 1e-9
"""Round-off that shares of a duty may leave to one."""


def find_duty_problems(drive: Drive) -> Iterator[str]:
    """Yield what is wrong with shares of a duty and with a lubricant, one sentence each.

    Parameters
    ----------
    drive : Drive
        A drive whose single numbers are already valid.
    """
    total = fsum(entry.share for entry in drive.duty)
    if drive.duty and abs(total - 1.0) > SHARES:
        named = ", ".join(f"duty.{number}.share = {entry.share:g}" for number, entry in enumerate(drive.duty))
        yield f"{named}: must add up to 1, they add up to {total:.10g}"
    if drive.lubricant is not None and not drive.duty and drive.load.speed is None:
        yield (
            f"lubricant.viscosity = {drive.lubricant.viscosity:g} mm²/s: needs a speed, load.speed or those of [[duty]]; "
            "without one no film can be told"
        )
