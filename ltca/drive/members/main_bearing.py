"""The main bearing, on which the pin wheel turns against the pin shaft."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, Angle, PositiveLength, SignedLength
from ltca.drive.members.preload import LoadConstant, Preload, Stiffness
from ltca.drive.units.quantities import quantity

BALL, ROLLER = 1.5, 10.0 / 9.0
"""Powers of the approach by which balls (Hertz) and rollers (Lundberg) press."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class BearingRow:
    """One row of rolling elements of the main bearing.

    Attributes
    ----------
    plane : float
        Axial place of the middle of the row, on the axis of ``disc.planes``, mm.
    kind : {"angular-contact ball", "tapered roller", "deep groove", "cylindrical"}
        Balls press with the power 3/2 of their approach, rollers with 10/9.
    contact_angle : float
        Angle of the contact normals against the radial plane, rad; 0 for cylindrical rollers.
    pitch_radius : float or None
        Radius of the circle of the contacts, mm, with a contact angle: it places the pressure centre, which concerns tilt alone.
    axial_stiffness : float or None
        Axial stiffness of the row at its preload, N/mm, with a contact angle.
    load_constant : float or None
        K of F = K δⁿ, axial force by axial displacement of the row, N/mmⁿ, in place of ``axial_stiffness``; needs a preload.
    radial_stiffness : float or None
        Radial stiffness of a row without contact angle, N/mm.
    preload : Preload or None
        Axial preload of the row; that of ``main_bearing.preload`` when left out.
    """

    plane: SignedLength
    kind: Literal["angular-contact ball", "tapered roller", "deep groove", "cylindrical"]
    contact_angle: Angle = 0.0
    pitch_radius: PositiveLength | None = None
    axial_stiffness: Stiffness | None = None
    load_constant: LoadConstant | None = None
    radial_stiffness: Stiffness | None = None
    preload: Preload | None = None

    @property
    def power(self) -> float:
        """n of F = K δⁿ."""
        return BALL if self.kind in ("angular-contact ball", "deep groove") else ROLLER


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class MainBearing:
    """Main bearing between the pin wheel and the pin shaft, which carries the output.

    Attributes
    ----------
    radial_stiffness : float or None
        Radial stiffness, N/mm; ``pin_wheel.support_stiffness`` is another name of it. With ``preload`` that of the bearing
        while both sides carry, otherwise that of the side that carries.
    tilt_stiffness : float or None
        Stiffness against tilt about the zero of ``disc.planes``, N·mm/rad, beside ``radial_stiffness``; rigid when left out. It
        needs ``contact.slices``.
    axial_stiffness : float or None
        Axial stiffness, N/mm; it tells how far forces along the axis displace the output, which moves no contact.
    clearance : float or None
        Radial internal clearance, diametral as usual: the wheel is free within half of it, mm; negative where it is tight.
    preload : Preload or None
        Preload: radial beside ``radial_stiffness``, axial beside ``bearings``.
    arrangement : {"O", "X"}
        How two rows with contact angles face each other: O where their contact normals meet the axis outside of the rows.
    bearings : tuple of BearingRow
        Rows of rolling elements, in place of ``radial_stiffness``.
    """

    radial_stiffness: Stiffness | None = None
    tilt_stiffness: Annotated[float, quantity("N*mm/rad", gt=0.0)] | None = None
    axial_stiffness: Stiffness | None = None
    clearance: SignedLength | None = None
    preload: Preload | None = None
    arrangement: Literal["O", "X"] = "O"
    bearings: tuple[BearingRow, ...] = ()

    @property
    def rows_resist_tilt(self) -> bool:
        """Whether the rows say how the bearing yields in tilt: at least two, each with its pressure centre."""
        known = all(row.pitch_radius is not None or not row.contact_angle for row in self.bearings)
        return known and len(self.bearings) > 1


def axial_preload(
    power: float, axial: float | None, load_constant: float | None, *, force: float | None, displacement: float | None
) -> tuple[float, float]:
    """Return the force, N, and the displacement, mm, of an axial preload by the one of them that is given: F = K δⁿ by the load
    constant, F = k δ/n by the axial stiffness k = dF/dδ at the preload.

    Examples
    --------
    >>> print("%.1f N, %.4f mm" % axial_preload(1.5, None, 1e6, force=None, displacement=0.01))
    1000.0 N, 0.0100 mm
    >>> print("%.1f N, %.4f mm" % axial_preload(1.5, 1.5e5, None, force=1e3, displacement=None))
    1000.0 N, 0.0100 mm
    """
    if load_constant is None:
        secant = (axial or 0.0) / power
        return (force, force / secant) if force is not None else (secant * (displacement or 0.0), displacement or 0.0)
    if force is not None:
        return force, (force / load_constant) ** (1.0 / power)
    return load_constant * (displacement or 0.0) ** power, displacement or 0.0
