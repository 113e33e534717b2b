"""What the torsional stiffness of a reducer is made of: every part that its file describes left out in turn, and alone.

A part that is left out is rigid. Compliances of parts do not add up where they share loads: a ring that yields spreads the load
over more pins, a bearing that yields moves it from crank to crank. So a part has two numbers: what the whole reducer gains
without it, and what it takes from contacts that stand between rigid parts.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from ltca.analysis.engines import Engine
from ltca.analysis.torque_curve import LOST_MOTION, torque_curve
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.yielding_parts import removable_parts, with_rigid, yielding_parts
from ltca.errors import ConvergenceError

TITLE = "what the torsional stiffness is made of"
HEADS = ("stiffness, N·m/′", "wind-up, ′", "lost motion, ′", "backlash, ′")
FORMS = ("{:.4g}", "{:.3f}", "{:.3f}", "{:.3f}")


@dataclass(frozen=True, slots=True, kw_only=True)
class TorsionalStiffness:
    """What is read from a torque curve without friction, means over crank angles and both senses, of the output.

    Attributes
    ----------
    stiffness : float
        From half the rated torque to all of it with the input held, N·mm/rad.
    wind_up : float
        To the rated torque from the end of the free play, rad.
    lost_motion : float
        Between both senses of a part of the rated torque, rad.
    backlash : float
        Free play with every clearance, rad.
    """

    stiffness: float
    wind_up: float
    lost_motion: float
    backlash: float

    @property
    def printed(self) -> tuple[float, ...]:
        """In the units of `HEADS`."""
        angles = (self.wind_up, self.lost_motion, self.backlash)
        return (self.stiffness / ARCMIN / 1e3, *(angle * ARCMIN for angle in angles))


@dataclass(frozen=True, slots=True, kw_only=True)
class StiffnessByPart:
    """Torsional stiffness of a reducer with and without each part that its file describes.

    Attributes
    ----------
    whole : TorsionalStiffness
        With everything.
    contacts : TorsionalStiffness
        With no part but the contacts, which always yield.
    always : tuple of str
        What always yields.
    without : mapping of str to TorsionalStiffness
        With the part of that name rigid.
    alone : mapping of str to TorsionalStiffness
        With all other parts rigid. The torsion of crankshafts has no entry: it needs their bearings.
    rigid : tuple of str
        Parts that are rigid because the file leaves them out, with the field that would say how.
    """

    whole: TorsionalStiffness
    contacts: TorsionalStiffness
    always: tuple[str, ...]
    without: Mapping[str, TorsionalStiffness]
    alone: Mapping[str, TorsionalStiffness]
    rigid: tuple[str, ...]

    @property
    def rows(self) -> dict[str, TorsionalStiffness]:
        """All of it by name, in the order of tables."""
        found = {"everything that is described": self.whole}
        found |= {f"without {name}": read for name, read in self.without.items()}
        if len(self.without) < 2:  # the same once more
            return found
        return (
            found
            | {f"contacts and {name}": read for name, read in self.alone.items()}
            | {"contacts alone": self.contacts}
        )

    @property
    def notes(self) -> list[str]:
        """What tables say beside their numbers, sentences without a full stop."""
        told = f"contacts are {', '.join(self.always)}"
        rigid = f"rigid in all rows, because left out: {', '.join(self.rigid)}"
        return [told, *([rigid] if self.rigid else []), "friction left out; a part that is left out has no clearance"]

    @property
    def content(self) -> dict[str, Any]:
        """The same as files hold it."""

        def kept(read: TorsionalStiffness) -> dict[str, float]:
            units = {"stiffness": "N_mm_per_rad", "wind_up": "rad", "lost_motion": "rad", "backlash": "rad"}
            return {f"{name}_{units[name]}": value for name, value in asdict(read).items()}

        return {
            "whole": kept(self.whole),
            "without": {name: kept(read) for name, read in self.without.items()},
            "alone": {name: kept(read) for name, read in self.alone.items()},
            "contacts_alone": kept(self.contacts),
            "contacts": [*self.always],
            "rigid": [*self.rigid],
        }

    @property
    def lines(self) -> list[str]:
        """The same as lines for the terminal."""
        wide = max(map(len, self.rows))
        table = []
        for name, read in self.rows.items():
            cells = (form.format(value) for form, value in zip(FORMS, read.printed, strict=True))
            table.append(
                f"  {name:<{wide}}  "
                + "  ".join(f"{cell:>{len(head)}}" for cell, head in zip(cells, HEADS, strict=True))
            )
        return [TITLE, f"  {'':<{wide}}  " + "  ".join(HEADS), *table, *(f"  {note}" for note in self.notes)]


def stiffness_by_part(
    drive: Drive, crank_angle: FloatArray, *, engine: Engine | None = None, lost_motion: float = LOST_MOTION
) -> StiffnessByPart:
    """Return the torsional stiffness of a reducer with and without each part that its file describes.

    Parameters
    ----------
    drive : Drive
        The drive, at its temperatures; its torque is the rated one.
    crank_angle : array, shape (angles,)
        φ_C, rad.
    engine : Engine, optional
        How bodies yield; half-spaces by default.
    lost_motion : float
        Part of the rated torque at which lost motion is read, from 0.001 to 0.5.

    Returns
    -------
    StiffnessByPart

    Raises
    ------
    ConvergenceError
        When the drive does not balance with a part left out; the message names the part.
    DriveError
        As of `torque_curve`.

    Examples
    --------
    >>> import numpy as np
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("rv").cases["nominal"].with_fields({"carrier.stiffness_torsion": "400 N·m/arcmin"})
    >>> found = stiffness_by_part(drive, np.array([0.3]))
    >>> twist = 1.0 / found.whole.stiffness - 1.0 / found.without["torsion of the carrier"].stiffness
    >>> f"{1.0 / twist / 1e3 / ARCMIN:.1f} N·m/arcmin"
    '400.0 N·m/arcmin'
    """
    drive = replace(drive, friction=None)
    parts = removable_parts(drive)
    known: dict[Drive, TorsionalStiffness] = {}

    def read(rigid: Collection[str]) -> TorsionalStiffness:
        variant = with_rigid(drive, rigid)
        if variant not in known:
            try:
                known[variant] = _read(variant, crank_angle, engine, lost_motion)
            except ConvergenceError as problem:
                raise ConvergenceError(f"with rigid {', '.join(rigid) or 'nothing'}: {problem}") from problem
        return known[variant]

    alone = {part: [other for other in parts if other != part] for part in parts}
    told = yielding_parts(drive)
    return StiffnessByPart(
        whole=read(()),
        contacts=read(parts),
        always=tuple(name for name in told.reducer if name not in parts),
        without={part: read((part,)) for part in parts},
        alone={part: read(rest) for part, rest in alone.items() if part in removable_parts(with_rigid(drive, rest))},
        rigid=told.rigid,
    )


def _read(drive: Drive, crank_angle: FloatArray, engine: Engine | None, lost_motion: float) -> TorsionalStiffness:
    curve = torque_curve(drive, crank_angle, points=0, engine=engine, lost_motion=lost_motion)
    # The ends of the free play are those of the curve towards vanishing torque; a tight drive has none.
    swing = curve.output_angle[:, -1] - curve.output_angle[:, 0]
    return TorsionalStiffness(
        stiffness=float(curve.reducer_stiffness.mean()),
        wind_up=float(0.5 * (swing - curve.backlash).mean()),
        lost_motion=float(curve.lost_motion.mean()),
        backlash=float(curve.backlash.mean()),
    )
