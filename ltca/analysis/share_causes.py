"""Why discs carry unequal parts of the torque: parts that yield more in the plane of one disc than of another, or differ.

Compared are the beams of shaft pins and wheel pins and the crankshafts on their bearings, clearances of single discs, and errors
of single discs, holes, rollers and eccentrics. A ring that posts hold counts as rigid
here, though the posts yield. Main bearing, carrier and the torsion of the cranks are never named as causes, though they may be.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ltca.arrays import FloatArray
from ltca.beam import PinBeam
from ltca.drive.fields import read_field
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.drive.single_discs import single_discs
from ltca.laws.member_bearings import crank_stiffness

LEAST_INEQUALITY = 0.05
"""Difference of a disc's part of the torque from an equal one, by that, from which a cause is named."""
LEAST_DIFFERENCE = 0.1
"""Difference of the flexibilities in the planes of the discs, by the largest, from which a part is a cause."""
ERRORS_OF_DISCS = (
    "runout",
    "profile_errors",
    "hole_errors",
    "lead_crown_drop",
    "lead_relief_length",
    "lead_relief_depth",
    "lead_slope",
)
"""Fields of ``disc`` that an entry of ``disc.of`` may replace."""


def share_words(drive: Drive, share: FloatArray) -> str:
    """Name what makes discs share the torque unequally: which beam in which plane, which clearances, errors of which parts.

    Parameters
    ----------
    drive : Drive
        The drive.
    share : array, shape (discs,)
        Part of the torque that each disc carries, in the mean.

    Returns
    -------
    str
        Empty where the parts are equal within `LEAST_INEQUALITY`, or none of these differs from disc to disc.
    """
    if share.size == 1 or not np.all(np.isfinite(share)) or np.max(np.abs(share * share.size - 1.0)) < LEAST_INEQUALITY:
        return ""
    causes = []
    for part, flexibility in _by_plane(drive).items():
        low, high = int(np.argmin(flexibility)), int(np.argmax(flexibility))
        if flexibility[high] - flexibility[low] > LEAST_DIFFERENCE * flexibility[high] and share[low] > share[high]:
            planes = " and ".join(
                f"{1e6 * flexibility[disc]:.3g} µm in the plane of disc {disc} ({drive.disc.disc_planes[disc]:g} mm)"
                for disc in (low, high)
            )
            causes.append(f"{part} yield by {planes}")
    if causes:
        causes[0] = f"under 1 kN of a disc on each, {causes[0]}"
    causes += [*_clearances_of_discs(drive, share), *_errors_of_discs(drive)]
    if not causes:
        return ""
    parts = ", ".join(f"{part:.2f}" for part in share)
    return f"the discs carry {parts} of the torque, not equal parts: {'; '.join(causes)}"


def _clearances_of_discs(drive: Drive, share: FloatArray) -> Iterator[str]:
    """Clearances that differ between the discs, where the disc with the larger one carries less."""
    for path, name in {"clearance.pin_hole": "pin-hole clearance", "clearance.bearing": "bearing clearance"}.items():
        sizes = [read_field(single, path) for single in single_discs(drive)]
        low, high = int(np.argmin(sizes)), int(np.argmax(sizes))
        if sizes[low] < sizes[high] and share[low] > share[high]:
            common = read_field(drive, path)
            own = high if sizes[high] != common else low
            yield (
                f"the {name} is {sizes[low]:g} mm at disc {low} and {sizes[high]:g} mm at disc {high} "
                f"(disc.of.{own}.{path})"
            )


def _errors_of_discs(drive: Drive) -> Iterator[str]:
    """Errors and leads that differ between the discs, by their fields."""
    singles = single_discs(drive)
    of_discs = {f"disc.of.N.{name}": [getattr(one.disc, name) for one in singles] for name in ERRORS_OF_DISCS}
    of_discs["disc.of.N.roller_errors"] = [one.crank_bearing.roller_errors for one in singles]
    of_discs["disc.of.N.bore_errors"] = [one.disc.of for one in singles]
    of_discs["crank.of.N"] = [(one.crank.eccentricity_error, one.crank.of) for one in singles]
    names = [path for path, values in of_discs.items() if any(value != values[0] for value in values)]
    if names:
        yield f"the discs differ in {', '.join(names)}"


def _by_plane(drive: Drive) -> dict[str, FloatArray]:
    """Flexibility of each yielding part in the planes of the discs, mm/N, by its name with its field."""
    flexibility = {}
    shaft, wheel, crank = shaft_pin_beam(drive), wheel_pin_beam(drive), crank_stiffness(drive)
    discs = drive.disc.number_of_discs
    if shaft is not None:
        floating = shaft.ends[1] != "free" and drive.posts is None
        flange = f"clamped at {-0.5 * drive.shaft_pin_span:g} mm"
        flexibility[f"shaft pins (pin_shaft.beam, {flange})"] = _of_beam(shaft, drive, floating=floating)
    if wheel is not None:
        flexibility["wheel pins (pin_wheel.beam)"] = _of_beam(wheel, drive, floating=False)
    if crank is not None:
        flexibility["crankshafts on their bearings (crank.support)"] = np.diag(np.linalg.inv(crank))[:discs]
    return flexibility


def _of_beam(beam: PinBeam, drive: Drive, *, floating: bool) -> FloatArray:
    """Deflection under unit load of each disc on every pin; a ring that floats turns with the tips, which it ties."""
    planes, width = from_start(beam, drive).tolist(), drive.disc.thickness
    at_load = np.diag(beam.flexibility(planes, width))
    return np.asarray(at_load + beam.tip_shape(planes, width) ** 2 / beam.tip_stiffness if floating else at_load)
