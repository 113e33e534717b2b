r"""Faces pressed together: gaps with profile and tilt, unilateral pressures, balance and energy.

The two surfaces of a contact have the same plane shape at every height but for a relief r(z) of some micrometres, and
move by an approach and a tilt. With the plane integrals of `fem.contact.coupling` at mid-height (of a zone of
thickness 1) the weighted gap of the hat φ_i along the arc and χ_k along the width is

.. math:: g_{ik} = \int\varphi_i g\,ds \int\chi_k\,dz + \int\varphi_i\,ds \int\chi_k r\,dz ,

and a motion of the body opposite by d(z) along a direction opens it by :math:`\int\varphi_i\,n\cdot d\,ds \int\chi_k
d(z)\,dz`. Left out are squares: what a relief or a tilt turns the normal out of the plane, and the shift of partners
along the arc, which `fem.solid_contact.displaced` finds from a solution and gives as a correction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.contact.coupling import PairIntegrals
from fem.contact.unilateral import ContactProblem, ContactSolution, solve_floating_contact
from fem.solid_contact.bodies import CondensedSolid
from fem.solid_contact.widths import WidthGrid
from ltca.arrays import BoolArray, FloatArray

Relief = Callable[[FloatArray], FloatArray]
"""By how much a surface falls short at heights, mm."""


def _one(z: FloatArray) -> FloatArray:
    return np.ones(np.shape(z))


def _height(z: FloatArray) -> FloatArray:
    return np.asarray(z)


def weighted_gap(
    integrals: PairIntegrals, width: WidthGrid, relief: Relief | None = None, breaks: FloatArray | None = None
) -> FloatArray:
    """Return the weighted gap of the undeformed surfaces, arc by arc, all heights of each, mm·mm².

    Parameters
    ----------
    integrals : PairIntegrals
        Of the pair in the plane, its zone of thickness 1.
    width : WidthGrid
        Hats along the width.
    relief : callable, optional
        What both surfaces together fall short by; none by default.
    breaks : array, optional
        Heights of its kinks, mm.
    """
    gap = np.outer(integrals.gap, width.moments(_one))
    if relief is not None:
        gap = gap + np.outer(integrals.measure, width.moments(relief, breaks))
    return np.asarray(gap.ravel())


def opening_of_motion(
    integrals: PairIntegrals, width: WidthGrid, direction: complex, along: Relief = _one
) -> FloatArray:
    """Return the weighted gap opened by a motion of the body opposite along a direction, by d(z) = `along`, mm·mm² by mm."""
    share = integrals.force[0] * direction.real + integrals.force[1] * direction.imag
    return np.asarray(np.outer(share, width.moments(along)).ravel())


@dataclass(frozen=True, slots=True, kw_only=True)
class PressedFaces:
    """Solution of two faces pressed together.

    Attributes
    ----------
    pressure : array, shape (arc hats, heights)
        MPa.
    approach : float
        Travel of the body opposite toward the carrier at mid-height, mm.
    tilt : float
        By which the travel grows with the height, rad.
    load : float
        Force along the direction of the approach, N.
    moment : float
        ∫ z dF, N·mm; positive where the upper half carries more.
    energy : float
        Strain energy ½ pᵀ S p, N·mm.
    work : float
        Half the pressures on the overlap of the undeformed surfaces, N·mm: equal to the energy where pressures close
        gaps exactly.
    solution : ContactSolution
        Of the condensed problem.
    """

    pressure: FloatArray
    approach: float
    tilt: float
    load: float
    moment: float
    energy: float
    work: float
    solution: ContactSolution


def press_faces(
    bodies: tuple[CondensedSolid, ...],
    integrals: PairIntegrals,
    width: WidthGrid,
    *,
    direction: complex,
    relief: Relief | None = None,
    breaks: FloatArray | None = None,
    approach: float | None = None,
    load: float | None = None,
    tilt: float = 0.0,
    moment: float | None = None,
    start: BoolArray | None = None,
    correction: FloatArray | None = None,
) -> PressedFaces:
    """Press two bodies together at an approach or by a load, at a tilt or by a moment.

    Parameters
    ----------
    bodies : tuple of CondensedSolid
        Held bodies with this one face each; a rigid one is left out.
    integrals : PairIntegrals
        Of the pair in the plane at mid-height, zone of thickness 1.
    width : WidthGrid
        Hats along the width; even ones need tilt and moment 0.
    direction : complex
        From the carrier of the pressure toward the body opposite.
    relief, breaks
        See `weighted_gap`.
    approach, load : float, optional
        One of them, mm or N.
    tilt : float
        rad, where no moment is given.
    moment : float, optional
        N·mm about mid-height; the tilt is then found.
    start : array of bool, optional
        First guess of what touches, shape (arc hats · heights,); by default where undeformed surfaces overlap, or all.
    correction : array, optional
        Weighted gap on top, arc by arc, mm·mm²: see `fem.solid_contact.displaced`.

    Raises
    ------
    ValueError
        When both or neither of approach and load are given, or an even pressure should tilt.
    ConvergenceError
        When no pressures balance the load.
    """
    if (approach is None) == (load is None):
        raise ValueError("give either an approach or a load")
    if width.even and (tilt != 0.0 or moment):
        raise ValueError("an even pressure knows no tilt")
    free = weighted_gap(integrals, width, relief, breaks)
    if correction is not None:
        free = free + correction
    push = opening_of_motion(integrals, width, direction)
    # Of even pressures the moment is zero.
    turn = np.zeros(push.size) if width.even else opening_of_motion(integrals, width, direction, _height)
    gap = free - (0.0 if approach is None else approach) * push - (tilt if moment is None else 0.0) * turn
    motions, external = [], []
    if load is not None:
        motions.append(push)
        external.append(load)
    if moment is not None and not width.even:
        motions.append(turn)
        external.append(moment)
    compliance = np.asarray(sum(body.compliance for body in bodies))
    problem = ContactProblem(
        compliance=compliance,
        gap=gap,
        motions=np.stack(motions, axis=1) if motions else np.zeros((gap.size, 0)),
        external=np.array(external),
    )
    if start is None:
        start = gap < 0.0 if load is None else np.ones(gap.size, dtype=bool)
    untouched = load is None and not np.any(gap < 0.0)
    solution = _open(problem) if untouched else solve_floating_contact(problem, start)
    found = iter(-solution.motion)
    reached = next(found) if approach is None else approach
    turned = tilt if moment is None or width.even else next(found)
    pressure = solution.pressure
    return PressedFaces(
        pressure=pressure.reshape(-1, width.size),
        approach=float(reached),
        tilt=float(turned),
        load=float(push @ pressure),
        moment=float(turn @ pressure),
        energy=float(0.5 * pressure @ compliance @ pressure),
        work=float(0.5 * pressure @ (reached * push + turned * turn - free)),
        solution=solution,
    )


def _open(problem: ContactProblem) -> ContactSolution:
    """The solution where the undeformed surfaces touch nowhere."""
    nothing = np.zeros(problem.gap.size)
    return ContactSolution(
        pressure=nothing,
        motion=np.zeros(0),
        opening=problem.gap,
        active=np.zeros(problem.gap.size, dtype=bool),
        residual=0.0,
        iterations=0,
    )
