"""Two bodies pressed together along one direction: the smallest use of the contact machinery.

A drive consists of many such pairs; for this one there are closed forms and answers of other codes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.body.condensation import CondensedBody
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import PairIntegrals, Pose, integrate_pair
from fem.contact.pressure_measures import peak_of, pressure_moments
from fem.contact.unilateral import ContactProblem, ContactSolution, solve_floating_contact
from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoBodyContact:
    """Solution of two bodies in contact.

    Attributes
    ----------
    arc : array, shape (n,)
        Arc length of the vertices of the pressure zone, mm.
    pressure : array, shape (n,)
        MPa, zero at both ends.
    force : complex
        On the body opposite, N.
    approach : float
        Travel of the body opposite against `direction` from its given pose, mm, positive when pressed.
    half_width : float
        2√⟨x²⟩, mm.
    peak_pressure : float
        MPa.
    integrals : PairIntegrals
        Of the pair.
    solution : ContactSolution
        Of the condensed problem.
    """

    arc: FloatArray
    pressure: FloatArray
    force: complex
    approach: float
    half_width: float
    peak_pressure: float
    integrals: PairIntegrals
    solution: ContactSolution


def press_together(
    zone: PressureZone,
    carrier: CondensedBody,
    opposite: OppositeZone | None,
    opposite_body: CondensedBody | None,
    *,
    pose: Pose,
    radius: float,
    load: float,
    direction: complex,
    expected_half_width: float,
) -> TwoBodyContact:
    """Press a body with a given load against the body that carries the pressure.

    Parameters
    ----------
    zone : PressureZone
        On the body that stays where it is.
    carrier : CondensedBody
        That body; its unit loads are the unknowns of the zone.
    opposite, opposite_body
        Meshed zone and body opposite, whose unit loads are the nodal forces of the zone; None for a rigid one.
    pose : Pose
        Of the body opposite before it is pressed, see `fem.contact.coupling.gap_to_opposite`.
    radius : float
        Of its circle, mm; infinite for a flat.
    load : float
        N, on the full thickness.
    direction : complex
        Unit vector from the carrier toward the body opposite; it moves along this line only.
    expected_half_width : float
        For the first active set, mm.

    Returns
    -------
    TwoBodyContact
        Small displacements about the given pose.
    """
    integrals = integrate_pair(zone, Pose(), pose, radius, opposite)
    compliance = carrier.compliance.copy()
    if opposite is not None and opposite_body is not None:
        compliance += integrals.opposite_loads.T @ opposite_body.compliance @ integrals.opposite_loads
    along = integrals.force[0] * direction.real + integrals.force[1] * direction.imag
    problem = ContactProblem(
        compliance=compliance, gap=integrals.gap, motions=along[:, None], external=np.array([load])
    )
    arc = zone.arc
    vertices = arc if zone.loaded_ends else arc[1:-1]
    start = np.abs(vertices - 0.5 * arc[-1]) < 0.8 * expected_half_width
    solution = solve_floating_contact(problem, start)
    pressure = zone.at_vertices(solution.pressure)
    force = integrals.force @ solution.pressure
    half_width = 2.0 * float(np.sqrt(pressure_moments(arc, pressure)[2]))
    return TwoBodyContact(
        arc=arc,
        pressure=pressure,
        force=complex(force[0], force[1]),
        approach=-float(solution.motion[0]),
        half_width=half_width,
        peak_pressure=peak_of(arc, pressure, half_width),
        integrals=integrals,
        solution=solution,
    )
