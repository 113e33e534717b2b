"""Error bars of the full finite-element solutions of a case, from nested meshes at one of its positions.

A bar is the distance of the compared solution of that position from the finest of three nested meshes
(`fem.reducer.nested_meshes`), or of the middle one, which has the edges of the compared solutions, whichever is larger, and the
bar of the finest. Two distances, because meshes of equal edges differ by where the end of a contact lies in an edge: one may be
small by chance. Walls, which compared solutions mesh finely, have such edges on the finest of the three, whose own bar is theirs.
Bars are parts of what the differences are parts of (`validation.compare.comparison`, `validation.compare.disc_stresses`), the
largest over the contacts of a kind and over the discs, so that those of one position serve all positions of the case.

They are numerical uncertainty alone: of input and model they say nothing (ASME V&V 10, V&V 20).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.errors import MemoryLimitError
from fem.options import SolutionOptions
from fem.reducer.nested_meshes import NestedFigure, NestedSolution, solve_nested
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.output.files import write_json
from validation.compare.comparison import Kind
from validation.compare.disc_stresses import Region
from validation.compare.finite_element_positions import FullPosition, position_key, position_name, read_kept, sealed

COMPARED_MESH = 1
"""Which of the nested meshes has the edges of the compared solutions."""
WALLS: dict[Region, str] = {"flank": "root_stress", "bore": "bore_stress", "holes": "hole_stress"}
SHEARS: dict[Kind, str] = {
    "pin": "pin_shear_max",
    "roller_outer": "roller_shear_max_outer",
    "hole": "pin_shaft_shear_max",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class KindBars:
    """Error bars of the contacts of one kind; None where no contact was loaded.

    Attributes
    ----------
    load : float or None
        Of the largest load of the kind.
    pressure, half_width, shear : float or None
        Of the value of the contact.
    """

    load: float | None = None
    pressure: float | None = None
    half_width: float | None = None
    shear: float | None = None


NO_BARS = KindBars()


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorBars:
    """Error bars of the full solutions of one case.

    Attributes
    ----------
    crank_angle : float
        Of the position that they come from, rad.
    kinds : dict of str to KindBars
        Of contacts.
    wheel_angle, disc_rotation : float
        Arc seconds.
    disc_displacement : float
        mm.
    bearing_force : float
        Of the largest bearing force.
    walls : dict of str to float
        Of the largest stress along any wall.
    """

    crank_angle: float
    kinds: dict[Kind, KindBars]
    wheel_angle: float
    disc_rotation: float
    disc_displacement: float
    bearing_force: float
    walls: dict[Region, float] = field(default_factory=dict)

    @property
    def largest_load(self) -> float:
        """Largest of the bars of loads."""
        return max(bars.load for bars in self.kinds.values() if bars.load is not None)

    @classmethod
    def of_nested(cls, nested: NestedSolution, compared: Sequence[FullPosition] = ()) -> ErrorBars:
        """Return the bars of a drive on nested meshes, with the compared solution of the same position, disc by disc."""
        of: dict[str, list[NestedFigure]] = {}
        for figure in nested.figures:
            of.setdefault(figure.quantity, []).append(figure)

        def own_bar(figure: NestedFigure) -> float:
            found, value = figure.estimate, _compared_value(figure, compared)
            away = 0.0 if value is None else abs(value - found.value) + found.bar
            return max(found.bar_at(COMPARED_MESH), away)

        def bar(name: str) -> float:
            return max(own_bar(figure) for figure in of[name])

        def relative(name: str) -> float | None:
            return max((own_bar(figure) / abs(figure.estimate.value) for figure in of.get(name, [])), default=None)

        def of_largest(name: str) -> float | None:
            own = [figure.estimate for figure in of.get(name, [])]
            return bar(name) / max(abs(each.value) for each in own) if own else None

        bearing = nested.levels[-1].bearing
        force = float(np.max(np.hypot(bearing[..., 0], bearing[..., 1])))
        walls = {region: of[name] for region, name in WALLS.items() if name in of}
        stresses = [figure.estimate for figures in walls.values() for figure in figures]
        largest = max((abs(each.value) for each in stresses), default=np.nan)
        return cls(
            crank_angle=nested.solution.crank_angle,
            kinds={
                kind: KindBars(
                    load=of_largest(names.load),
                    pressure=relative(names.pressure),
                    half_width=relative(names.half_width),
                    shear=relative(SHEARS[kind]) if kind in SHEARS else None,
                )
                for kind, names in CONTACT_KINDS.items()
            },
            wheel_angle=ARCSEC * bar("wheel_angle"),
            disc_rotation=ARCSEC * bar("disc_rotation"),
            disc_displacement=float(np.hypot(bar("disc_x"), bar("disc_y"))),
            bearing_force=max(bar("bearing_radial"), bar("bearing_tangential")) / force,
            walls={region: max(each.estimate.bar for each in figures) / largest for region, figures in walls.items()},
        )

    @classmethod
    def of_content(cls, content: dict[str, Any]) -> ErrorBars:
        """Return the bars that a file keeps."""
        return cls(**(content | {"kinds": {kind: KindBars(**bars) for kind, bars in content["kinds"].items()}}))


def _compared_value(figure: NestedFigure, compared: Sequence[FullPosition]) -> float | None:
    """Return a figure in the compared solution; None where it is not among what that keeps, or at another place."""
    if not compared:
        return None
    own, name, part = compared[figure.disc or 0], figure.quantity, figure.part
    if name in ("wheel_angle", "disc_rotation"):
        return float(getattr(own.answer, name))
    if part is None:
        return None
    if name in ("bearing_radial", "bearing_tangential"):
        return float(getattr(own.answer, name)[part])
    for kind, names in CONTACT_KINDS.items():
        contacts = own.answer.kinds[kind]
        arrays = {names.load: contacts.load, names.pressure: contacts.pressure, names.half_width: contacts.half_width}
        if kind in SHEARS:
            arrays[SHEARS[kind]] = own.stress.shear[kind]
        if name in arrays:
            return float(arrays[name][part])
    return None


def error_bars_of(
    drive: Drive,
    case: str,
    crank_angle: float,
    folder: Path,
    options: SolutionOptions,
    *,
    compared: Sequence[FullPosition] = (),
    progress: Callable[[str], None] | None = None,
) -> ErrorBars | None:
    """Return the error bars of a case at a crank angle (rad), from a kept file where it fits; None where memory is too small.

    The element edges are those of `options`, and of the solution `compared` at that angle, disc by disc. `progress` is called
    with a line for each step, among them why there are none.
    """
    key = position_key(drive, case, crank_angle, options)
    path = folder / f"{position_name(drive, case, crank_angle, options)}.json"
    content = read_kept(path, key, ("bars",))
    if content is None:
        try:
            nested = solve_nested(drive, crank_angle, options, progress=progress)
        except MemoryLimitError as error:
            if progress is not None:
                progress(f"no error bars: {error}")
            return None
        write_json(path, sealed(key, {"bars": asdict(ErrorBars.of_nested(nested, compared))}))
        content = read_kept(path, key, ("bars",))
    assert content is not None
    return ErrorBars.of_content(content["bars"])


def bars_words(bars: dict[str, ErrorBars | None]) -> str:
    """Return what a report tells of the error bars of its cases; empty where none were asked for."""
    if not bars:
        return ""
    missing = [case for case, own in bars.items() if own is None]
    told = (
        "Error bars of differences from full FE are the numerical uncertainty of the full solution: grid convergence index "
        "(F_s = 1.25) of three nested meshes at one position of each case. A difference below its error bar says nothing of the "
        "model. Uncertainty of the input and of the model are none of it."
    )
    return told + (f" None for {', '.join(missing)}: the memory is too small for its nested meshes." if missing else "")
