"""Stress in the disc of a full solution: along flank, bore and hole walls, and below its contacts.

A place on a wall is *clear* when it is farther than four half-widths from every loaded contact on that wall; the largest
tensile stresses are those of clear places. Below contacts the shear stress is looked for where the mesh resolves it: at
over 5 % of the largest load of their kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.body.stress import recover_stress
from fem.body.wall_stress import WallStress, stress_along_wall
from fem.contact.subsurface_shear import largest_shear_below
from fem.drive.contact_results import PairResult
from fem.drive.full_solution import FullSolution
from fem.drive.grading import FINE_SHARE
from fem.drive.model import ContactPair
from ltca.arrays import FloatArray
from ltca.quantities import QUANTITIES

CLEAR_HALF_WIDTHS = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscStress:
    """Stress in the disc.

    Attributes
    ----------
    walls : tuple of WallStress
        Flank, then each bore, then each hole, frame of the disc.
    clear : tuple of array of bool
        Which nodes of each wall are clear of its contacts.
    root_stress : array, shape (lobes,)
        Largest tensile stress along the flank about each root, from crest to crest; root k lies at θ = 2πk/z_C. MPa, not
        a number where nothing is clear.
    bore_stress : float
        Along the bores, the largest of all, MPa.
    hole_stress : array, shape (z_PS,)
        Along each hole wall, MPa.
    pin_shear_max, roller_shear_max_outer, pin_shaft_shear_max : array
        Largest shear stress in the plane below the contacts of wheel pins, rollers in the bore and shaft pins, MPa; zero
        below 5 % of the largest load of the kind.
    """

    walls: tuple[WallStress, ...]
    clear: tuple[NDArray[np.bool_], ...]
    root_stress: FloatArray
    bore_stress: float
    hole_stress: FloatArray
    pin_shear_max: FloatArray
    roller_shear_max_outer: FloatArray
    pin_shaft_shear_max: FloatArray

    @property
    def bores(self) -> int:
        """Number of bores: walls that are neither the flank nor holes."""
        return len(self.walls) - 1 - len(self.hole_stress)


def recover_disc_stress(solution: FullSolution) -> DiscStress:
    """Return the stress in the disc of a full solution."""
    model = solution.plane
    body, shape = model.meshes.disc, model.shapes.disc
    displacement = model.disc_displacement(solution.state.contact.pressure)
    stress = recover_stress(body, displacement, model.drive.materials.disc, state=solution.options.plane)
    loaded = [
        (pair, detail, *_centre_of_pressure(pair, detail))
        for pair, detail in zip(model.pairs, solution.contacts.details, strict=True)
        if detail.load > 0.0 and pair.kind != "roller_inner"
    ]
    walls = tuple(stress_along_wall(body, stress, curve) for curve in shape.curves)
    clear = []
    for wall in walls:
        far = np.ones(len(wall.points), dtype=bool)
        for pair, detail, place, _ in loaded:
            if pair.zone.curve.name == wall.name:
                far &= np.abs(wall.points - place) > CLEAR_HALF_WIDTHS * detail.half_width
        clear.append(far)
    shear = {
        "pin": np.zeros(len(solution.contacts.pin_load)),
        "roller_outer": np.zeros(len(solution.contacts.roller_load)),
        "hole": np.zeros(len(solution.contacts.pin_shaft_load)),
    }
    for pair, detail, place, outward in loaded:
        if detail.share > FINE_SHARE:
            shear[pair.kind][pair.index], _ = largest_shear_below(body, stress, place, -outward, detail.half_width)
    lobes = round(shape.flank.profile.reduction_ratio) - 1
    flank, *openings = zip(walls, clear, strict=True)
    bores = len(shape.bores)
    nearest = np.mod(np.rint(flank[0].parameter * lobes / (2.0 * np.pi)).astype(int), lobes)
    return DiscStress(
        walls=walls,
        clear=tuple(clear),
        root_stress=np.array([_largest(flank[0], flank[1] & (nearest == root)) for root in range(lobes)]),
        bore_stress=_largest_of_all([_largest(*bore) for bore in openings[:bores]]),
        hole_stress=np.array([_largest(*hole) for hole in openings[bores:]]),
        pin_shear_max=shear["pin"],
        roller_shear_max_outer=shear["roller_outer"],
        pin_shaft_shear_max=shear["hole"],
    )


def _centre_of_pressure(pair: ContactPair, detail: PairResult) -> tuple[complex, complex]:
    """Return the centre of pressure on the exact wall and the outward normal there, frame of the disc."""
    arc = pair.zone.arc
    edge = int(np.clip(np.searchsorted(arc, detail.middle) - 1, 0, pair.zone.edge_count - 1))
    along = (detail.middle - arc[edge]) / (arc[edge + 1] - arc[edge])
    points, _ = pair.zone.points(np.array([edge]), np.array([along]))
    place, normal = pair.zone.exact(points)
    return complex(place[0]), complex(normal[0])


def _largest(wall: WallStress, among: NDArray[np.bool_]) -> float:
    return float(np.max(wall.stress[among])) if among.any() else float("nan")


def _largest_of_all(values: list[float]) -> float:
    return float(np.nanmax(values)) if np.any(np.isfinite(values)) else float("nan")


STRESSES = (
    "root_stress", "bore_stress", "hole_stress", "pin_shear_max", "roller_shear_max_outer", "pin_shaft_shear_max",
)  # fmt: skip
"""Attributes of `DiscStress` that files hold, by their names in ``fem.nc``."""


def summarise_stress(discs: Sequence[DiscStress]) -> dict[str, Any]:
    """Return the stress in the discs for ``summary.json``: lists by disc, then by part.

    None replaces what is not a number.
    """

    def plain(values: Any) -> Any:
        if isinstance(values, list):
            return [plain(value) for value in values]
        return values if np.isfinite(values) else None

    return {
        QUANTITIES[name].fem_key: [plain(np.asarray(getattr(stress, name)).tolist()) for stress in discs]
        for name in STRESSES
    }


def stress_variables(discs: Sequence[DiscStress]) -> dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]:
    """Return the stress in each disc as variables of ``fem.nc``, dimensions as in ``results.nc``."""
    bores = discs[0].bores
    walls = [(disc, number, wall) for disc, stress in enumerate(discs) for number, wall in enumerate(stress.walls)]
    sizes = {"case": 1, "disc": len(discs), "crank": bores, "position": 1}
    values: dict[str, Any] = {
        "lobe": np.arange(len(discs[0].root_stress)),
        "wall_disc": np.concatenate([np.full(len(wall.parameter), number) for number, _, wall in walls]),
        "wall_boundary": np.concatenate([np.full(len(wall.parameter), number) for _, number, wall in walls]),
        "wall_parameter": np.concatenate([wall.parameter for *_, wall in walls]),
        "wall_stress": np.concatenate([wall.stress for *_, wall in walls]),
        "wall_clear": np.concatenate([clear.astype(int) for stress in discs for clear in stress.clear]),
    }
    for name in STRESSES:
        shape = [sizes.get(dimension, -1) for dimension in QUANTITIES[name].dimensions]
        values[name] = np.array([getattr(stress, name) for stress in discs], dtype=float).reshape(shape)
    found = {name: QUANTITIES[name].labelled(each, in_fem=True) for name, each in values.items()}
    if bores > 1:
        found["wall_boundary"][2]["long_name"] = f"0 flank, 1 + c bore c, {1 + bores} + k hole k"
        found["bore_stress"][2]["long_name"] = "largest tensile stress along the bores, clear of contacts"
    return found
