"""Checks of a file of influence coefficients by laws that need no second computation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.contact.round_bodies import compressed_cylinder, held_ring_approach
from ltca.reading.coefficient_schema import is_solid, shape_of, uniform_parameters
from ltca.reading.station_walls import missed_between_stations, wall_bending

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


RECIPROCITY = "reciprocity of displacements solved for"
RIGID_MOTIONS = "rigid motions and change of datum"
RESULTANTS = "resultants of the patches and of the stations"
NEAR_FIELD_DISC, NEAR_FIELD_ROUND = "near field, disc, worst station", "near field, pin, roller, race"
CONVERGENCE = "convergence: error of the mesh, estimated"
HELD_PIN, HELD_RACE = "pin against the held ring", "race against the held ring, worst angle"
NEIGHBOURS = "near field, neighbours and sizes"
EVEN_PRESSURE = "stress left by even pressure on all walls"
WALLS_CLOSE = "stress along closed walls against their displacement"
STRESS_CONVERGENCE = "convergence of the stresses: error of the mesh, estimated"
OUT_OF_LINE = "entry out of line against those beside it"
BRACKET_LOWEST = "least share of plane stress, solid disc"
BRACKET_HIGHEST = "largest share of plane stress, solid disc"
INTERPOLATION, TILT_INTERPOLATION = "interpolation between stations", "interpolation between stations, tilt"
TILT_CONVERGENCE = f"{CONVERGENCE}, tilt"
# Laws on optional data, with the names of the data.
STATED_BY: dict[str, tuple[str, ...]] = {
    RECIPROCITY: ("symmetry",),
    RIGID_MOTIONS: ("rigid_residual",),
    RESULTANTS: ("disc_resultant",),
    NEAR_FIELD_DISC: ("wide_station",),
    NEAR_FIELD_ROUND: ("pin_wide_approach", "roller_wide_approach", "race_wide_approach"),
    HELD_PIN: ("core_radius",),
    HELD_RACE: ("race_bore_radius",),
    CONVERGENCE: ("convergence_estimate",),
    EVEN_PRESSURE: ("disc_stress",),
    WALLS_CLOSE: ("disc_stress",),
    STRESS_CONVERGENCE: ("convergence_stress",),
}
# Those of solid bodies alone.
STATED_BY_SOLIDS: dict[str, tuple[str, ...]] = {
    f"{RESULTANTS}, tilt": ("disc_tilt_resultant",),
    f"{NEAR_FIELD_DISC}, tilt": ("wide_tilt_approach",),
    f"{NEAR_FIELD_ROUND}, tilt": ("pin_wide_tilt_approach", "roller_wide_tilt_approach", "race_wide_tilt_approach"),
    BRACKET_LOWEST: ("bracket_lowest",),
    BRACKET_HIGHEST: ("bracket_highest",),
    TILT_CONVERGENCE: ("convergence_estimate_tilt",),
    INTERPOLATION: ("interpolation_error",),
    TILT_INTERPOLATION: ("interpolation_error_tilt",),
}
# What curvature may add: the square of a tenth, some per cent of ln 2.
NEAR_FIELD_LIMIT = 0.04
# Stated before any file was looked at: the bound on convergence, for the meshes are alike.
HELD_RING_LIMIT = 1.2e-2
# Both bounds tell gross mistakes and were set after the figures of some discs were known. Left by even pressure: 0.001 on
# the paper's disc with the default stations, 0.05 with a quarter of them. From twice the mesh: 0.044 there, 0.03 to 0.09
# on three random ones, of which a fifteenth is left.
EVEN_PRESSURE_LIMIT = 0.1
STRESS_CONVERGENCE_LIMIT = 0.3
# Set after the figures of some discs were known: 1e-4 with the default stations, 0.002 with half of them, 0.06 with a
# quarter, the fewest.
WALLS_CLOSE_LIMIT = 0.1
# Stated before any file was looked at. Plane strain is below the solid disc on its very mesh; plane stress is above it but for
# the error of the mesh, some per cent of the near field at worst.
BRACKET_BELOW, BRACKET_ABOVE = -1e-6, 1.05
CONVERGENCE_LIMIT = 1.2e-2
# Set after the figure of the paper's disc was known, 0.023: of the largest tilt without rigid motions, which is half of the
# largest approach in units of the near field, and from a mesh that is one layer poorer as well.
TILT_CONVERGENCE_LIMIT = 4e-2
# Of the largest entry: as much as the error of the meshes may be (`CONVERGENCE`).
INTERPOLATION_LIMIT = CONVERGENCE_LIMIT
# Tells entries that are wrong by a factor, in files that hold nothing wider; set after the figures of the paper's disc
# were known: 0.99 to 1.37 between neighbouring stations, 0.97 on its race, its pin 0.93 of the whole cylinder; with a
# quarter of the stations 2.9, since neighbours that far apart feel the ligament bend.
NEIGHBOUR_BOUNDS = (0.3, 5.0)
# An entry out of line by less than this, in units of the near field (a patch on itself has about 8), is none that matters.
LEAST_OUT_OF_LINE = 0.5
# Set after the figures of some discs were known: 1.0 to 1.3 with the default stations, 1.5 with half of them. With six to
# twelve stations on a wall 2 to 8, which is no measure of anything: there is no law then.
OUT_OF_LINE_LIMIT, OUT_OF_LINE_STATIONS, OUT_OF_LINE_DISTANCE = 10.0, 24, 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One figure with its bounds.

    Attributes
    ----------
    name : str
        Name of the figure.
    value : float
        The figure.
    lowest, highest : float
        Bounds.
    reason : str
        Reason for the bounds.
    """

    name: str
    value: float
    lowest: float
    highest: float
    reason: str

    @property
    def bounds(self) -> str:
        """The bounds as text."""
        if self.lowest == 0.0:
            return "no bound" if np.isinf(self.highest) else f"at most {self.highest:g}"
        if np.isinf(self.lowest):
            return f"at most {self.highest:g}"
        return f"at least {self.lowest:g}" if np.isinf(self.highest) else f"{self.lowest:g} to {self.highest:g}"

    @property
    def passed(self) -> bool:
        """Whether the figure lies between its bounds; NaN does not."""
        return bool(self.lowest <= self.value <= self.highest)


def project_rigid_motions(approach: FloatArray, resultants: FloatArray) -> FloatArray:
    """Return approaches, shape (m, m), without the part that rigid motions or the choice of a datum can change.

    It is Q A Q with Q the projection onto loads without resultant; `resultants`, shape (3, m), are those of the unit loads.
    """
    basis, _ = np.linalg.qr(resultants.T)
    left = approach - basis @ (basis.T @ approach)
    return np.asarray(left - (left @ basis) @ basis.T)


def body_length(dataset: Labelled, body: str) -> float:
    """Return the length along the axis of a body, mm: the thickness, of solid rollers their own."""
    return float(dataset.attrs["roller_length" if body == "roller" and is_solid(dataset) else "thickness"])


def near_field_unit(dataset: Labelled, body: str, tilt: bool = False) -> float:
    """Return 2(1 − ν²)/(πEt) of a body (without ν in plane stress), mm/N: the unit of the near field.

    That of `tilt` is 12/t² times it, rad/(N mm).
    """
    nu = 0.0 if dataset.attrs["plane"] == "stress" else float(dataset.attrs[f"{body}_poisson_ratio"])
    modulus, length = float(dataset.attrs[f"{body}_youngs_modulus"]), body_length(dataset, body)
    unit = 2.0 * (1.0 - nu**2) / (np.pi * modulus * length)
    return 12.0 / length**2 * unit if tilt else unit


def _kinds(dataset: Labelled) -> tuple[tuple[bool, str, str], ...]:
    """Even loads, and of solid bodies linear ones: whether it is a tilt, what variables and what laws are called."""
    even = (False, "approach", "")
    return (even, (True, "tilt_approach", ", tilt")) if is_solid(dataset) else (even,)


def station_resultants(dataset: Labelled) -> FloatArray:
    """Return force in x, y (N) and moment about the disc centre (N·mm) of a newton at each station, shape (3, stations)."""
    point = dataset["station_x"].values + 1j * dataset["station_y"].values
    inward = -(dataset["station_normal_x"].values + 1j * dataset["station_normal_y"].values)
    return np.stack([inward.real, inward.imag, (point.conjugate() * inward).imag])


def station_tilt_resultants(dataset: Labelled) -> FloatArray:
    """Return the moments about x and y of a unit linear load at each station, shape (2, stations)."""
    force = station_resultants(dataset)
    return np.stack([-force[1], force[0]])


def check_coefficients(dataset: Labelled) -> tuple[Check, ...]:
    """Check coefficients of the right schema by all laws and by the accuracy that they state about themselves.

    Those of `unstated_laws` are left out.
    """
    return check_laws(dataset) + check_stated_quality(dataset)


def check_laws(dataset: Labelled) -> tuple[Check, ...]:
    """Check coefficients of the right schema: reciprocity, definiteness, rigid bodies, closed forms; a broken law is damage."""
    return (
        *_check_reciprocity(dataset),
        *_check_definiteness(dataset),
        *_check_rigid_bodies(dataset),
        *_check_near_field(dataset),
        *_check_neighbours(dataset),
        *_check_lone_entries(dataset),
        *_check_closed_forms(dataset),
        *_check_bracket(dataset),
        *_check_stresses(dataset),
    )


def check_quick_laws(dataset: Labelled) -> tuple[Check, ...]:
    """Check coefficients of the right schema by laws that take milliseconds: files whose laws held when they were written.

    Where a bound that no wall loosens holds already, the law that asks for the thickness of the walls is left out.
    """
    return (
        *_check_reciprocity(dataset),
        *_check_round_definiteness(dataset),
        *_check_rigid_bodies(dataset),
        *_check_lone_entries(dataset),
        *_check_roller(dataset),
        *(() if _near_fields_in_bounds(dataset) else _check_near_field(dataset)),
        *_check_neighbours(dataset),
        *_check_bracket(dataset),
        *(() if _even_pressure_in_bounds(dataset) else _check_stresses(dataset)),
    )


def _near_fields_in_bounds(dataset: Labelled) -> bool:
    """Whether no near field is too small, and some one is as half-planes have it: walls that bend only add to single ones."""
    for tilt, name, _ in _kinds(dataset):
        slopes = [_disc_slopes(dataset, tilt, name), _round_slopes(dataset, tilt, name)]
        for each in slopes:
            if each.size and not (each.min() >= 1.0 - NEAR_FIELD_LIMIT and each.min() <= 1.0 + NEAR_FIELD_LIMIT):
                return False
        if slopes[1].size and slopes[1].max() > 1.0 + NEAR_FIELD_LIMIT:
            return False
    return True


def _even_pressure_in_bounds(dataset: Labelled) -> bool:
    return "disc_stress" not in dataset or _stress_left_by_even_pressure(dataset) <= EVEN_PRESSURE_LIMIT


def check_stated_quality(dataset: Labelled) -> tuple[Check, ...]:
    """Return the accuracy that a file states about itself with its bounds: worse than that is no sign of damage."""
    return tuple(_stated_quality(dataset))


def _stated_quality(dataset: Labelled) -> Iterator[Check]:
    if is_solid(dataset):
        reason = "of the largest entry, midway between stations, what the solid disc has beyond plane strain"
        for name in (INTERPOLATION, TILT_INTERPOLATION):
            yield from _stated(dataset, name, INTERPOLATION_LIMIT, reason)
    reason = (
        "of the largest entry without rigid motions; told two to forty times as large as it is (measured), or the change from a "
        "mesh of twice the size, a fifth of which is left"
    )
    yield from _stated(dataset, CONVERGENCE, CONVERGENCE_LIMIT, reason)
    if is_solid(dataset):
        reason = "as for even loads, of smaller entries and a layer less: half the size changes them by less than 1 %"
        yield from _stated(dataset, TILT_CONVERGENCE, TILT_CONVERGENCE_LIMIT, reason)
    reason = (
        "of the largest entry; told up to three times as large as it is (measured), or the change from twice the size"
    )
    yield from _stated(dataset, STRESS_CONVERGENCE, STRESS_CONVERGENCE_LIMIT, reason)


def unstated_laws(dataset: Labelled) -> dict[str, str]:
    """Return the laws that cannot be checked for lack of data in a file, with the missing names.

    A file of another code may leave out its derivation and the data that serve checking alone.
    """
    return {
        law: ", ".join(lacking)
        for law, names in (STATED_BY | STATED_BY_SOLIDS if is_solid(dataset) else STATED_BY).items()
        if (lacking := [name for name in names if not _holds(dataset, name)])
    }


def _holds(dataset: Labelled, name: str) -> bool:
    return name in dataset.variables or name in dataset.attrs


def _stated(dataset: Labelled, law: str, highest: float, reason: str) -> Iterator[Check]:
    """The figure that a file states about itself for a law, if it does."""
    (name,) = (STATED_BY | STATED_BY_SOLIDS)[law]
    if name in dataset.attrs:
        value = float(dataset.attrs[name])
        yield Check(name=law, value=value, lowest=0.0, highest=highest, reason=reason)


def _check_reciprocity(dataset: Labelled) -> Iterator[Check]:
    matrices = [dataset[f"{body}_{name}"].values for body in ("disc", "roller") for _, name, _ in _kinds(dataset)]
    stored = max(_asymmetry(matrix) for matrix in matrices)
    reason = "Maxwell–Betti; a solve of this size leaves 1e-12"
    yield Check(name="symmetry of the stored matrices", value=stored, lowest=0.0, highest=1e-8, reason=reason)
    yield from _stated(dataset, RECIPROCITY, 1e-8, reason)


def _asymmetry(matrix: FloatArray) -> float:
    """Largest difference of two entries that should be equal, of the largest entry."""
    if np.array_equal(matrix, matrix.T):  # as ours are; it takes a tenth of the time
        return 0.0
    return float(np.max(np.abs(matrix - matrix.T)) / np.max(np.abs(matrix)))


DEFINITE = "loads in equilibrium do positive work, in units of 2(1 − ν²)/(πEt); that of a patch alone is above 1"


def _check_definiteness(dataset: Labelled) -> Iterator[Check]:
    rounds = {check.name: check for check in _check_round_definiteness(dataset)}
    for tilt, name, also in _kinds(dataset):
        motions = station_tilt_resultants(dataset) if tilt else station_resultants(dataset)
        disc = project_rigid_motions(dataset[f"disc_{name}"].values, motions)
        smallest = float(np.linalg.eigvalsh(0.5 * (disc + disc.T))[len(motions)]) / near_field_unit(
            dataset, "disc", tilt
        )
        name_of_check = f"smallest eigenvalue, disc{also}"
        yield Check(name=name_of_check, value=smallest, lowest=0.1, highest=np.inf, reason=DEFINITE)
        yield rounds[_round_eigenvalue(also)]


def _round_eigenvalue(also: str) -> str:
    return f"smallest eigenvalue, pin, roller, race{also}"


def _check_round_definiteness(dataset: Labelled) -> Iterator[Check]:
    for tilt, name, also in _kinds(dataset):
        roller = float(np.linalg.eigvalsh(dataset[f"roller_{name}"].values)[0])
        race = float(np.fft.rfft(dataset[f"race_{name}"].values).real.min())
        others = min(
            roller / near_field_unit(dataset, "roller", tilt),
            race / near_field_unit(dataset, "race", tilt),
            float(dataset[f"pin_{name}"]) / near_field_unit(dataset, "pin", tilt),
        )
        yield Check(name=_round_eigenvalue(also), value=others, lowest=0.1, highest=np.inf, reason=DEFINITE)


def _check_rigid_bodies(dataset: Labelled) -> Iterator[Check]:
    reason = "a rigid motion moves no station relative to the bores; balanced loads know no datum: round-off"
    yield from _stated(dataset, RIGID_MOTIONS, 1e-10, reason)
    for tilt, _, also in _kinds(dataset):
        stored = "disc_tilt_resultant" if tilt else "disc_resultant"
        if not _holds(dataset, stored):
            continue
        places = station_tilt_resultants(dataset) if tilt else station_resultants(dataset)
        mesh = dataset[stored].values
        difference = np.max(np.abs(places - mesh), axis=1) / np.max(np.abs(mesh), axis=1)
        yield Check(
            name=RESULTANTS + also,
            value=float(np.max(difference)),
            lowest=0.0,
            highest=1e-4,
            reason="a patch on a curved boundary acts at its station up to the cube of its width",
        )


def _check_near_field(dataset: Labelled) -> Iterator[Check]:
    reason = (
        "half-plane: the approach falls by 2(1 − ν²)/(πEt) for each ln b; curvature adds the square of a tenth, some per cent "
        "of ln 2 at worst, a thin wall what it bends between both widths"
    )
    for tilt, name, also in _kinds(dataset):
        if _disc_slopes(dataset, tilt, name).size:
            wide, slopes = dataset["wide_station"].values, _disc_slopes(dataset, tilt, name)
            most = 1.0 + NEAR_FIELD_LIMIT + wall_bending(dataset, wide)
            # The station that is nearest to its bounds, or farthest beyond them; NaN first.
            used = np.where(slopes > 1.0, (slopes - 1.0) / (most - 1.0), (1.0 - slopes) / NEAR_FIELD_LIMIT)
            worst = int(np.argmax(used))
            lowest, value, highest = 1.0 - NEAR_FIELD_LIMIT, float(slopes[worst]), float(most[worst])
            yield Check(name=NEAR_FIELD_DISC + also, value=value, lowest=lowest, highest=highest, reason=reason)
        if _round_slopes(dataset, tilt, name).size:
            lowest, highest = 1.0 - NEAR_FIELD_LIMIT, 1.0 + NEAR_FIELD_LIMIT
            value = _farthest(_round_slopes(dataset, tilt, name))
            yield Check(name=NEAR_FIELD_ROUND + also, value=value, lowest=lowest, highest=highest, reason=reason)


def _disc_slopes(dataset: Labelled, tilt: bool, name: str) -> FloatArray:
    """Fall of the approach from a patch to a wider one at stations of the disc, in units of the near field by ln; empty
    where the file has no wider ones.
    """
    if not (_holds(dataset, "wide_station") and _holds(dataset, f"wide_{name}")):
        return np.zeros(0)
    wide = dataset["wide_station"].values
    narrow, broad = np.diag(dataset[f"disc_{name}"].values)[wide], dataset[f"wide_{name}"].values
    ratio = np.log(dataset["wide_half_width"].values / dataset["station_half_width"].values[wide])
    return np.asarray((narrow - broad) / ratio / near_field_unit(dataset, "disc", tilt))


def _round_slopes(dataset: Labelled, tilt: bool, name: str) -> FloatArray:
    """Fall of the approach of pin, roller and race to a patch twice as wide, in units of the near field by ln; empty where the
    file has none.
    """
    bodies = ("pin", "roller", "race")
    if not all(_holds(dataset, f"{body}_wide_{name}") for body in bodies):
        return np.zeros(0)
    falls = [
        float(np.ravel(dataset[f"{body}_{name}"].values)[0]) - float(dataset[f"{body}_wide_{name}"]) for body in bodies
    ]
    units = np.array([near_field_unit(dataset, body, tilt) for body in bodies])
    return np.asarray(np.array(falls) / np.log(2.0) / units)


def _check_neighbours(dataset: Labelled) -> Iterator[Check]:
    """Between a patch and its neighbour the approach falls like the logarithm; a pin yields about like a cylinder.

    Files with wider patches are checked by them, which is sharper: bending between neighbours cancels there.
    """
    for tilt, name, also in _kinds(dataset):
        if not (
            _holds(dataset, "wide_station") and _holds(dataset, f"wide_{name}") and _holds(dataset, f"pin_wide_{name}")
        ):
            yield _neighbours(dataset, tilt, name, also)


def _neighbours(dataset: Labelled, tilt: bool, name: str, also: str) -> Check:
    boundary, approach = dataset["station_boundary"].values, dataset[f"disc_{name}"].values
    place = dataset["station_x"].values + 1j * dataset["station_y"].values
    width, ratios = dataset["station_half_width"].values, []
    for number in np.unique(boundary).tolist():
        own = np.flatnonzero(boundary == number)
        other = np.roll(own, -1)
        fall = 0.5 * (approach[own, own] + approach[other, other]) - approach[own, other]
        ratios.append(
            fall / _fall(np.abs(place[own] - place[other]), width[own]) / near_field_unit(dataset, "disc", tilt)
        )
    shape = shape_of(dataset)  # numbers of the bodies it was derived for
    radius = shape.get("crank_bearing.inner_race_radius")
    if radius is not None:
        race, chord = dataset[f"race_{name}"].values, 2.0 * radius * np.sin(np.pi / dataset.sizes["race_angle"])
        fall = (race[0] - race[1]) / _fall(chord, dataset["race_half_width"].values)
        ratios.append(np.ravel(fall / near_field_unit(dataset, "race", tilt)))
    radius = shape.get("pin_wheel.pin_radius")
    if radius is not None:
        cylinder = compressed_cylinder(radius, float(dataset["pin_half_width"]))
        ratios.append(np.ravel(dataset[f"pin_{name}"].values / near_field_unit(dataset, "pin", tilt) / cylinder))
    found = np.concatenate(ratios)
    return Check(
        name=NEIGHBOURS + also,
        value=float(found[np.argmax(np.abs(np.log(np.maximum(found, 1e-300))))]),
        lowest=NEIGHBOUR_BOUNDS[0],
        highest=NEIGHBOUR_BOUNDS[1],
        reason="half-plane, and Johnson's cylinder for the pin: walls and curvature change it by a third, a wrong unit by more",
    )


def _check_lone_entries(dataset: Labelled) -> Iterator[Check]:
    """An approach changes gradually with the places of load and contact: no entry stands out among those beside it.

    Its second difference, where load and contact move together along one wall, or the contact alone along another one, is
    compared with the second differences at the next stations. An entry that is wrong alone is large in its own alone. Where
    another wall is nearer than the next station, what a patch does at its own place and the next is no error: there is no law of
    these then.
    """
    boundary = dataset["station_boundary"].values
    x, y = dataset["station_x"].values, dataset["station_y"].values
    starts = [0, *(np.flatnonzero(np.diff(boundary)) + 1).tolist(), boundary.size]
    everywhere = [slice(*ends) for ends in pairwise(starts)]
    walls = [wall for wall in everywhere if wall.stop - wall.start >= OUT_OF_LINE_STATIONS]
    spacing = [float(np.max(np.hypot(np.diff(x[wall]), np.diff(y[wall])))) for wall in walls]

    def apart(one: slice, other: slice) -> float:
        return float(np.sqrt(np.min((x[one, None] - x[other]) ** 2 + (y[one, None] - y[other]) ** 2)))

    nearest = [min((apart(wall, other) for other in everywhere if other != wall), default=np.inf) for wall in walls]
    reason = (
        "approaches change gradually along walls, in ratio to the next stations where it is more than half a unit of the near "
        "field; a wrong entry does so alone"
    )
    for tilt, name, also in _kinds(dataset):
        approach, unit = dataset[f"disc_{name}"].values, near_field_unit(dataset, "disc", tilt)
        ratios = [0.0]
        for first, rows in enumerate(walls):
            thin = nearest[first] <= spacing[first]
            ratios.append(_out_of_line(approach[rows, rows], unit, together=True, beside_alone=thin))
            for second, columns in enumerate(walls[first + 1 :], first + 1):
                if apart(rows, columns) > OUT_OF_LINE_DISTANCE * max(spacing[first], spacing[second]):
                    ratios.append(_out_of_line(approach[rows, columns], unit, together=False))
        yield Check(name=OUT_OF_LINE + also, value=max(ratios), lowest=0.0, highest=OUT_OF_LINE_LIMIT, reason=reason)


def _out_of_line(block: FloatArray, unit: float, *, together: bool, beside_alone: bool = False) -> float:
    """Largest second difference of entries between two walls relative to the next ones; 0 below `LEAST_OUT_OF_LINE` units.

    With `beside_alone` those of patches on themselves and on the next ones are left out.
    """
    bent = np.empty_like(block)
    if together:
        np.add(block[2:, 2:], block[:-2, :-2], out=bent[1:-1, 1:-1])
        for edge in (0, -1):  # walls are closed
            bent[edge] = np.roll(block[edge + 1], -1) + np.roll(block[edge - 1], 1)
            bent[:, edge] = np.roll(block[:, edge + 1], -1) + np.roll(block[:, edge - 1], 1)
    else:
        np.add(block[2:], block[:-2], out=bent[1:-1])
        bent[0], bent[-1] = block[1] + block[-1], block[0] + block[-2]
    bent *= -0.5
    bent += block
    if beside_alone:
        own = np.arange(len(bent))
        for step in (-1, 0, 1):
            bent[own, (own + step) % len(bent)] = 0.0
    place = max((int(np.argmax(bent)), int(np.argmin(bent))), key=lambda each: abs(bent.flat[each]))
    row, column = np.unravel_index(place, bent.shape)
    # Where both move together an entry is in three differences of its own diagonal, otherwise of its own column: those two and
    # three stations away are without it, as all of the neighbouring diagonals or columns. Over a hole a patch bends the wall
    # under itself, by turns more and less, and the wall beside it hardly: that shows along the own diagonal alone.
    beside, away = np.array([-2, -1, 1, 2]), np.array([-3, -2, 2, 3])
    others = bent[row, (column + beside) % bent.shape[1]]
    along = bent[(row + away) % bent.shape[0], (column + away) % bent.shape[1] if together else column]
    largest, next_largest = abs(float(bent.flat[place])), float(np.max(np.abs([others, along])))
    return largest / max(next_largest, 1e-300) if largest > LEAST_OUT_OF_LINE * unit else 0.0


def _fall(distance: FloatArray | float, half_width: FloatArray) -> FloatArray:
    """ln(distance) minus the mean logarithm of a patch on itself."""
    return np.asarray(np.log(distance) - np.log(0.5 * half_width) + 0.25)


def _check_roller(dataset: Labelled) -> Iterator[Check]:
    roller, widths = dataset["roller_approach"].values, dataset["roller_half_width"].values
    radius = float(dataset.attrs["roller_radius"])
    closed = np.array([compressed_cylinder(radius, float(width)) for width in widths])
    softest = _plane_stress(dataset, "roller")
    yield Check(
        name="roller against the compressed cylinder",
        value=_farthest(roller.sum(axis=1) / near_field_unit(dataset, "roller") / closed),
        lowest=0.997,
        highest=1.003 * softest,
        reason="Johnson's closed form of a whole cylinder, a solid one between plane strain and plane stress; curvature under "
        "the patch adds 0.3 (b/R)² of about 4",
    )


def _check_closed_forms(dataset: Labelled) -> Iterator[Check]:
    yield from _check_roller(dataset)
    shape = shape_of(dataset)
    for name, body, inner, outer in (
        (HELD_PIN, "pin", "core_radius", "pin_wheel.pin_radius"),
        (HELD_RACE, "race", "race_bore_radius", "crank_bearing.inner_race_radius"),
    ):
        if _holds(dataset, inner) and outer in shape:
            yield Check(
                name=name,
                value=_off_held_ring(dataset, body, float(dataset.attrs[inner]), shape[outer]),
                lowest=0.0,
                highest=HELD_RING_LIMIT,
                reason="closed form of a ring held inside (Muskhelishvili), with the half-width as it is: 1e-4 of finite "
                "elements on the default mesh; of the largest",
            )


def _plane_stress(dataset: Labelled, body: str) -> float:
    """Return how much softer plane stress is than a body in its own state in the near field: a solid one by 1/(1 − ν²)."""
    return 1.0 / (1.0 - float(dataset.attrs[f"{body}_poisson_ratio"]) ** 2) if is_solid(dataset) else 1.0


def _off_held_ring(dataset: Labelled, body: str, inner: float, outer: float) -> float:
    """Largest difference of a round body's approaches from the closed form, relative to the largest; NaN where there is no
    ring.

    Of solid bodies it is what harmonics along the ring lie outside of plane strain and plane stress in all, between which their
    energy is under any even load.
    """
    if not 0.0 < inner < outer:
        return float("nan")
    nu = float(dataset.attrs[f"{body}_poisson_ratio"])
    own = np.ravel(dataset[f"{body}_approach"].values) / near_field_unit(dataset, body)
    angle = 2.0 * np.pi * np.arange(own.size) / own.size
    width = float(np.max(dataset[f"{body}_half_width"].values))
    strain, stress = (
        held_ring_approach(inner, outer, width, kolosov, angle) for kolosov in (3.0 - 4.0 * nu, (3.0 - nu) / (1.0 + nu))
    )
    if not is_solid(dataset):
        closed = strain if dataset.attrs["plane"] == "strain" else stress
        return float(np.max(np.abs(own - closed)) / np.max(np.abs(closed)))
    lowest, highest = strain, stress * _plane_stress(dataset, body)
    outside = sum(np.maximum(np.fft.fft(each).real, 0.0).sum() / own.size for each in (lowest - own, own - highest))
    return float(outside / np.max(np.abs(lowest)))


def _check_bracket(dataset: Labelled) -> Iterator[Check]:
    """What a file of solid bodies states of plane strain (0) and plane stress (1)."""
    if not is_solid(dataset):
        return
    reason = (
        "without thickness strain the disc is stiffer, in plane strain on the very mesh; plane stress is in equilibrium and so "
        "the softest, but for the error of the mesh: of any balanced loads"
    )
    for name, attribute, bounds in (
        (BRACKET_LOWEST, "bracket_lowest", (BRACKET_BELOW, np.inf)),
        (BRACKET_HIGHEST, "bracket_highest", (-np.inf, BRACKET_ABOVE)),
    ):
        if attribute in dataset.attrs:
            value = float(dataset.attrs[attribute])
            yield Check(name=name, value=value, lowest=bounds[0], highest=bounds[1], reason=reason)


def even_pressure(dataset: Labelled) -> FloatArray:
    """Return the load of each station under a pressure of 1 MPa on all walls of the disc, N, shape (stations,)."""
    boundary = dataset["station_boundary"].values
    points = dataset["station_x"].values + 1j * dataset["station_y"].values
    load = np.zeros(len(points))
    for number in np.unique(boundary).tolist():
        own = boundary == number
        count = int(np.count_nonzero(own))
        # Stations are uniform in a parameter of period 2π: the trapezoidal rule on |dr/dθ|.
        load[own] = 2.0 * np.pi / count * np.abs(_slope(points[own])) * float(dataset.attrs["thickness"])
    return load


def _slope(values: ComplexArray, at: FloatArray | None = None) -> ComplexArray:
    """Derivative of values at uniform places of a period 2π by the parameter, at these or other places, by Fourier series."""
    count = len(values)
    order = np.fft.fftfreq(count, 1.0 / count)
    series = 1j * order * np.fft.fft(values)
    if at is None:
        return np.asarray(np.fft.ifft(series))
    return np.asarray(np.exp(1j * np.outer(at, order)) @ series) / count


def _opening_of_walls(dataset: Labelled) -> Iterator[tuple[float, float]]:
    """Gap of each wall that is closed again by its strain and displacement, relative to the change of its length, and what the
    stations of that wall miss of its turn.

    Along a wall with unit tangent t and normal m the strain is ε = u_t′ + u_m t·m′; over the closed wall u_t returns to its
    initial value, so ∮ε ds = ∮u_m t·dm. An unloaded wall has ε = σ(1 − ν²)/E (plane strain), and u_m is the approach with
    its sign; in solid bodies ε lies between that and σ/E of plane stress. So stresses are related to approaches, in size and
    sign, by the loads on the other walls; the best factor between both sides over all of them counts, since few stations miss
    the peak beside a near load.

    A closed wall turns by 2π, whatever its shape (Hopf): how far ∮t·dm, summed as the displacement is, departs from that tells
    how well the stations follow a flank that turns within a small part of its roots. Sums of known displacements along 3,024
    flanks were off by 0.81 of 2δ/(1 − δ) at most where by more than 0.02, δ being that departure by 2π.
    """
    boundary, stressed = dataset["station_boundary"].values, dataset["stress_station_boundary"].values
    points = dataset["station_x"].values + 1j * dataset["station_y"].values
    normals = dataset["station_normal_x"].values + 1j * dataset["station_normal_y"].values
    stiffness = float(dataset.attrs["disc_youngs_modulus"])
    if dataset.attrs["plane"] != "stress":
        stiffness /= 1.0 - float(dataset.attrs["disc_poisson_ratio"]) ** 2
    least_factor = 1.0 / _plane_stress(dataset, "disc")
    least = 1e-9 * float(np.max(np.abs(dataset["disc_approach"].values)))
    for number in np.unique(boundary).tolist():
        own, seen = boundary == number, stressed == number
        slope = _slope(points[own])
        turning = np.real(np.conj(slope / np.abs(slope)) * _slope(normals[own]))
        # Approaches are counted into the body, normals point out of it.
        displaced = -(turning / np.count_nonzero(own)) @ dataset["disc_approach"].values[np.ix_(own, ~own)]
        if np.max(np.abs(displaced), initial=0.0) <= least:
            continue  # walls of this body are not coupled
        parameter = uniform_parameters(dataset, "stress_station", number)
        length = np.abs(_slope(points[own], parameter)) / np.count_nonzero(seen)
        strained = length @ dataset["disc_stress"].values[np.ix_(seen, ~own)] / stiffness
        factor = float(strained @ displaced / (displaced @ displaced))
        turns = -1.0 if number else 1.0  # normals point out of the body: into holes
        yield float(np.max([0.0, factor - 1.0, least_factor - factor])), abs(float(np.mean(turning)) - turns)


def _check_stresses(dataset: Labelled) -> Iterator[Check]:
    """A file may leave the stresses out: there is nothing to check then."""
    if "disc_stress" not in dataset:
        return
    left = _stress_left_by_even_pressure(dataset)
    points = dataset["station_x"].values + 1j * dataset["station_y"].values
    missed, _, _ = missed_between_stations(dataset["station_boundary"].values, points)
    yield Check(
        name=EVEN_PRESSURE,
        value=left,
        lowest=0.0,
        highest=EVEN_PRESSURE_LIMIT + missed if missed < 1.0 else np.inf,
        reason="it squeezes the disc evenly, σ = −p along every wall, all of it right under the pressure: what the "
        "loads do elsewhere cancels, but for how well the stations resolve it: they miss more across walls thinner than they "
        "are apart; of the sum of magnitudes",
    )
    # Both sums have the error of the missed part; where all may be missed, there is no bound.
    walls = [
        (opening, WALLS_CLOSE_LIMIT + 2.0 * part / (1.0 - part) if (part := missed + turn) < 1.0 else np.inf)
        for opening, turn in _opening_of_walls(dataset)
    ]
    # The wall that is nearest to its bound, or farthest beyond it; NaN first.
    used = [opening / highest for opening, highest in walls]
    opening, highest = walls[int(np.argmax(used))] if walls else (0.0, WALLS_CLOSE_LIMIT)
    yield Check(
        name=WALLS_CLOSE,
        value=opening,
        lowest=0.0,
        highest=highest,
        reason="a wall strained all around stays closed (∮ε ds = ∮u·dm); means over patches and arcs for points, what stations "
        "farther apart than walls are thick miss, and what they miss of the turn of the wall, 2π",
    )


def _stress_left_by_even_pressure(dataset: Labelled) -> float:
    stress, load = dataset["disc_stress"].values, even_pressure(dataset)
    return float(np.max(np.abs(stress @ load)) / max(np.max(np.abs(stress) @ load), 1e-300))


def _farthest(ratios: FloatArray) -> float:
    return float(ratios[np.argmax(np.abs(ratios - 1.0))])
