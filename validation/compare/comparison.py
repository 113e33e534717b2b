"""One position of a drive as any model answers it, and how two answers differ: definitions of all metrics.

- A **load difference** is relative to the largest load of its kind in the reference: a contact that carries almost
  nothing cannot give a large figure, and the sum over a kind stays a force.
- **Pressures** and **half-widths** are compared, relative to the reference, where a contact carries over 5 % of the
  largest load of its kind: below that its half-width is a few elements and says nothing about the drive.
- **Bearing forces** are compared crank by crank, relative to the largest of any crank in the reference.
- The **RMS** of load differences runs over the contacts of a kind that are loaded in either answer.
- Two answers have the **same loaded contacts** when every contact with over 1 % of the largest load of its kind in one
  is loaded in the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCSEC

Kind = PairKind
KINDS: tuple[Kind, ...] = tuple(CONTACT_KINDS)

COMPARED_SHARE = 0.05
"""Pressures and half-widths are compared above this part of the largest load of a kind."""

LOADED_SHARE = 0.01
"""Below this part of the largest load of its kind a contact may be open in the other answer."""

COUNTED_SHARE = 1e-3
"""A contact counts as loaded above this part of the largest load of its kind, as in `ltca.analysis.results`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KindAnswer:
    """Contacts of one kind; arrays over all parts, zeros where open.

    Attributes
    ----------
    load : array
        N.
    pressure : array
        Largest pressure at mid-width, MPa; not a number where a model has none (shaft pins on the paper's spring).
    half_width : array
        mm; not a number likewise.
    """

    load: FloatArray
    pressure: FloatArray
    half_width: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionAnswer:
    """What a model says about a drive at one crank angle.

    Attributes
    ----------
    kinds : dict of str to KindAnswer
        Contacts by kind (`KINDS`); rollers of several cranks follow each other crank after crank.
    bearing_radial, bearing_tangential : array, shape (cranks,)
        Force of each crank bearing on the disc along the eccentricity and 90° ahead, N.
    wheel_angle : float
        rad.
    disc_radial, disc_tangential : float
        Displacement of the disc, fitted to its bores, from the inner-race centre, of several their mean, mm.
    disc_rotation : float
        rad, fitted to the bores.
    """

    kinds: dict[Kind, KindAnswer]
    bearing_radial: FloatArray
    bearing_tangential: FloatArray
    wheel_angle: float
    disc_radial: float
    disc_tangential: float
    disc_rotation: float

    def loaded(self, kind: Kind) -> int:
        """Return the number of loaded contacts of a kind."""
        return int(np.count_nonzero(loaded_contacts(self.kinds[kind].load, COUNTED_SHARE)))

    def contact_name(self, kind: Kind, number: int) -> str:
        """Return the name of one of its contacts, as `contact_name`."""
        return contact_name(kind, number, _rollers_of_each(self.kinds["roller_outer"].load, self.bearing_radial))


def loaded_contacts(load: FloatArray, share: float) -> NDArray[np.bool_]:
    """Return which contacts carry more than a share of the largest load; none when nothing is loaded."""
    return np.asarray(load > share * np.max(load, initial=0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class KindDifference:
    """Difference of the contacts of one kind, model less reference.

    Attributes
    ----------
    load : array
        Load differences relative to the largest load of the kind in the reference.
    pressure, half_width : array
        Relative to the reference; not a number where not compared.
    compared : array of bool
        Contacts above 5 % of the largest load in the reference.
    rms_load : float
        Root mean square of `load` over contacts loaded in either.
    missing : tuple of int
        Contacts loaded in one answer only and above 1 % there.
    """

    load: FloatArray
    pressure: FloatArray
    half_width: FloatArray
    compared: NDArray[np.bool_]
    rms_load: float
    missing: tuple[int, ...]

    @property
    def worst_load(self) -> tuple[int, float]:
        """Contact with the largest load difference, and that difference with its sign."""
        return worst(self.load)

    @property
    def worst_pressure(self) -> tuple[int, float]:
        """Contact with the largest pressure difference, and that difference; (−1, nan) without any."""
        return worst(self.pressure)


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionDifference:
    """Difference of two answers to one position, model less reference.

    Attributes
    ----------
    kinds : dict of str to KindDifference
        By kind.
    bearing_radial, bearing_tangential : array, shape (cranks,)
        Relative to the magnitude of the reference's bearing force, of several cranks the largest.
    wheel_angle, disc_rotation : float
        Arc seconds.
    disc_displacement : float
        Length of the difference of the two displacement vectors, mm.
    """

    kinds: dict[Kind, KindDifference]
    bearing_radial: FloatArray
    bearing_tangential: FloatArray
    wheel_angle: float
    disc_rotation: float
    disc_displacement: float

    @property
    def worst_load(self) -> tuple[Kind, int, float]:
        """Kind, contact and load difference of the worst contact of all."""
        return self._worst({kind: item.worst_load for kind, item in self.kinds.items()})

    @property
    def worst_pressure(self) -> tuple[Kind, int, float]:
        """Kind, contact and pressure difference of the worst contact of all."""
        return self._worst({kind: item.worst_pressure for kind, item in self.kinds.items()})

    @property
    def missing(self) -> tuple[str, ...]:
        """Contacts that are loaded in one answer only, by name."""
        return tuple(self.contact_name(kind, number) for kind in self.kinds for number in self.kinds[kind].missing)

    def contact_name(self, kind: Kind, number: int) -> str:
        """Return the name of one of the contacts, as `contact_name`."""
        return contact_name(kind, number, _rollers_of_each(self.kinds["roller_outer"].load, self.bearing_radial))

    def _worst(self, found: dict[Kind, tuple[int, float]]) -> tuple[Kind, int, float]:
        kind = max(found, key=lambda name: -1.0 if np.isnan(found[name][1]) else abs(found[name][1]))
        return kind, *found[kind]


def contact_name(kind: Kind, number: int, rollers: int | None = None) -> str:
    """Return the name of a contact as rows and report give it; of several cranks with `rollers` each, crank and roller.

    Examples
    --------
    >>> contact_name("roller_outer", 11), contact_name("roller_outer", 11, 9)
    ('roller 11 bore', 'crank 1, roller 2 bore')
    """
    name = CONTACT_KINDS[kind].name
    if rollers is None or kind not in ("roller_outer", "roller_inner"):
        return name.format(number)
    return f"crank {number // rollers}, " + name.format(number % rollers)


def _rollers_of_each(load: FloatArray, of_cranks: FloatArray) -> int | None:
    return None if of_cranks.size == 1 else load.size // of_cranks.size


def worst(difference: FloatArray) -> tuple[int, float]:
    """Return place and value of the difference of the largest magnitude; (−1, nan) when there is none."""
    known = ~np.isnan(difference)
    if not known.any():
        return -1, float("nan")
    place = int(np.argmax(np.where(known, np.abs(difference), -1.0)))
    return place, float(difference[place])


def compare_kind(model: KindAnswer, reference: KindAnswer) -> KindDifference:
    """Return the differences of the contacts of one kind, model less reference.

    ValueError when the arrays differ in length, or the reference carries nothing while the model does.
    """
    if model.load.shape != reference.load.shape:
        raise ValueError(f"{model.load.size} contacts against {reference.load.size}: not the same drive")
    largest = float(np.max(reference.load, initial=0.0))
    if largest == 0.0 and np.any(model.load > 0.0):
        raise ValueError("the reference carries no load at all: nothing to relate a difference to")
    scale = largest if largest > 0.0 else 1.0
    load = (model.load - reference.load) / scale
    compared = loaded_contacts(reference.load, COMPARED_SHARE)
    either = (model.load > 0.0) | (reference.load > 0.0)
    alone = loaded_contacts(model.load, LOADED_SHARE) & (reference.load <= 0.0)
    alone |= loaded_contacts(reference.load, LOADED_SHARE) & (model.load <= 0.0)
    return KindDifference(
        load=load,
        pressure=_relative(model.pressure, reference.pressure, compared),
        half_width=_relative(model.half_width, reference.half_width, compared),
        compared=compared,
        rms_load=float(np.sqrt(np.mean(load[either] ** 2))) if either.any() else 0.0,
        missing=tuple(int(number) for number in np.flatnonzero(alone)),
    )


def _relative(model: FloatArray, reference: FloatArray, compared: NDArray[np.bool_]) -> FloatArray:
    found = np.full(reference.shape, np.nan)
    usable = compared & (reference > 0.0)
    found[usable] = model[usable] / reference[usable] - 1.0
    return found


def compare_positions(model: PositionAnswer, reference: PositionAnswer) -> PositionDifference:
    """Return the differences of two answers to the same position of the same drive, model less reference."""
    bearing = float(np.max(np.hypot(reference.bearing_radial, reference.bearing_tangential)))
    return PositionDifference(
        kinds={kind: compare_kind(model.kinds[kind], reference.kinds[kind]) for kind in KINDS},
        bearing_radial=(model.bearing_radial - reference.bearing_radial) / bearing,
        bearing_tangential=(model.bearing_tangential - reference.bearing_tangential) / bearing,
        wheel_angle=(model.wheel_angle - reference.wheel_angle) * ARCSEC,
        disc_rotation=(model.disc_rotation - reference.disc_rotation) * ARCSEC,
        disc_displacement=float(
            np.hypot(
                model.disc_radial - reference.disc_radial,
                model.disc_tangential - reference.disc_tangential,
            )
        ),
    )
