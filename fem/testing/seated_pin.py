"""A round pin in a hardly larger bore in plane strain: the reference for laws of conforming seats.

The bore is in a ring so wide that it represents an infinite body (its outside is fixed; the datum is the mean displacement
of a circle about the bore), or in a sleeve that is pressed from outside. The pin is a free body: its force is balanced by
a uniform body force and its place is the mean of its section.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementTriP2, ElementVector, MeshTri1

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, traction_load, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import Pose, integrate_pair
from fem.contact.pressure_measures import peak_of, pressure_moments
from fem.contact.two_bodies import TwoBodyContact, press_together
from fem.contact.unilateral import ContactProblem, solve_floating_contact
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import DEFAULT_GROWTH, Refinement
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleCurve, CircleShape, RingShape
from ltca.arrays import FloatArray
from ltca.drive.parts import Material

DATUM_POINTS = 720


@dataclass(frozen=True, slots=True, kw_only=True)
class SeatedPin:
    """A pin pressed into its bore.

    Attributes
    ----------
    approach : float
        Travel of the pin from where it touches, relative to the datum circle, mm.
    effective_half_angle : float
        2√⟨θ²⟩ of the pressure, rad: half the arc of Hertz, a little less than half the arc of a conforming seat. It comes
        out far better than the ends of the arc, which lie somewhere between two vertices.
    largest_pressure : float
        MPa.
    contact : TwoBodyContact
        Pressure over the arc.
    unknowns : int
        Of both meshes.
    """

    approach: float
    effective_half_angle: float
    largest_pressure: float
    contact: TwoBodyContact
    unknowns: int


def press_pin_into_bore(
    *,
    pin: Material,
    bore: Material,
    pin_radius: float,
    bore_radius: float,
    datum_radius: float,
    length: float,
    load: float,
    half_angle: float,
    elements: float = 40.0,
    width: float = 60.0,
    growth: float = DEFAULT_GROWTH,
) -> SeatedPin:
    """Press a pin into the bore of a very wide body.

    Parameters
    ----------
    pin, bore : Material
        Of both bodies.
    pin_radius, bore_radius, datum_radius, length : float
        mm.
    load : float
        N.
    half_angle : float
        That is expected, rad; it sizes the elements and the zone of contact.
    elements : float
        Over the expected arc.
    width : float
        Outer radius of the ring over that of the datum. Fixed there, it changes the motion of the datum against the bore
        by the inverse square.
    growth : float
        Of the elements from the arc into the bodies.
    """
    place, reach = _refinement(pin_radius, half_angle, elements)
    disc = mesh_circle(CircleShape(name="pin", radius=pin_radius), [place], growth=growth)
    # Its own arc is the pin's, not its angle: the play may be no small part of the radius.
    facing = Refinement(bore_radius, 0.0, place.size, place.radius)
    shape = RingShape(inner_radius=bore_radius, outer_radius=width * datum_radius, name="bore")
    ring = mesh_ring(shape, [facing], growth=growth)
    curve = CircleCurve(name="inner", radius=bore_radius, encloses_body=False)
    zone = PressureZone.on_boundary(ring, curve, complex(bore_radius), reach, thickness=length)
    opposite = OppositeZone.on_circle(disc, "surface", complex(pin_radius), 1.1 * reach)
    carrier = condense_body(
        ring,
        assemble_stiffness(ring, bore, thickness=length),
        zone.load_shapes(ring.unknowns),
        fixed=unknowns_of_boundary(ring, "outer"),
    )
    free = condense_body(disc, assemble_stiffness(disc, pin, thickness=length), opposite.unit_loads(disc.unknowns))
    contact = press_together(
        zone,
        carrier,
        opposite,
        free,
        pose=Pose(centre=complex(bore_radius - pin_radius)),
        radius=pin_radius,
        load=load,
        direction=-1.0 + 0.0j,
        expected_half_width=half_angle * pin_radius,
    )
    moved = carrier.displacement(contact.solution.pressure)
    angle = 2.0 * np.pi * (np.arange(DATUM_POINTS) + 0.5) / DATUM_POINTS
    points = datum_radius * np.array([np.cos(angle), np.sin(angle)])
    # Off the boundary edges are straight: vertices alone find the elements and place their points.
    straight = MeshTri1(np.ascontiguousarray(ring.mesh.doflocs[:, : ring.mesh.nvertices]), ring.mesh.t)
    at = Basis(straight, ElementVector(ElementTriP2())).probes(points) @ moved
    datum = float(np.mean(at.reshape(2, -1)[0]))
    return SeatedPin(
        approach=contact.approach - datum,
        effective_half_angle=contact.half_width / bore_radius,
        largest_pressure=contact.peak_pressure,
        contact=contact,
        unknowns=ring.unknowns + disc.unknowns,
    )


def _refinement(pin_radius: float, half_angle: float, elements: float) -> tuple[Refinement, float]:
    """Small elements about the arc, and how far the zone of contact reaches, mm."""
    reach = float(2.0 * pin_radius * np.sin(0.5 * min(1.25 * half_angle, 3.0)))
    return Refinement(pin_radius, 0.0, 2.0 * half_angle * pin_radius / elements, reach), reach


@dataclass(frozen=True, slots=True, kw_only=True)
class SqueezedSleeve:
    """A sleeve between its pin and a flank outside, in line.

    Attributes
    ----------
    approach : float
        Travel of the pin from where it touches, relative to the mean displacement of the patch outside weighted by its
        pressure, mm.
    effective_half_angle : float
        2√⟨θ²⟩ of the pressure of the pin, rad.
    largest_pressure : float
        Of the pin, MPa.
    unknowns : int
        Of both meshes.
    """

    approach: float
    effective_half_angle: float
    largest_pressure: float
    unknowns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SleeveOnPin:
    """A sleeve on its pin, pressed from outside.

    Attributes
    ----------
    pin, sleeve : Material
        Of both bodies.
    pin_radius, bore_radius, outer_radius, length : float
        mm.
    half_angle : float
        That is expected of the arc of the pin, rad; it sizes the elements and the zone of contact.
    patch_half_width : float
        Of the semi-elliptic pressure outside, mm.
    """

    pin: Material
    sleeve: Material
    pin_radius: float
    bore_radius: float
    outer_radius: float
    length: float
    half_angle: float
    patch_half_width: float

    def meshes(self, elements: float, growth: float = DEFAULT_GROWTH) -> tuple[BodyMesh, BodyMesh]:
        """Return meshes of pin and sleeve, the arc and the patch outside on the x axis.

        `elements` is their number over the expected arc (over the patch a third of it), `growth` that of the element edge
        into the bodies.
        """
        place, _ = _refinement(self.pin_radius, self.half_angle, elements)
        width = self.patch_half_width
        outside = Refinement(self.outer_radius, 0.0, 6.0 * width / elements, 1.2 * width)
        shape = RingShape(inner_radius=self.bore_radius, outer_radius=self.outer_radius, name="sleeve")
        return (
            mesh_circle(CircleShape(name="sleeved_pin", radius=self.pin_radius), [place], growth=growth),
            mesh_ring(shape, [place, outside], growth=growth),
        )


def squeeze_sleeve(seat: SleeveOnPin, disc: BodyMesh, ring: BodyMesh, load: float) -> SqueezedSleeve:
    """Squeeze a sleeve between its pin and the pressure outside under a load, N, on meshes of pin and sleeve."""
    _, reach = _refinement(seat.pin_radius, seat.half_angle, 1.0)
    bore_radius, length = seat.bore_radius, seat.length
    curve = CircleCurve(name="inner", radius=bore_radius, encloses_body=False)
    zone = PressureZone.on_boundary(ring, curve, complex(bore_radius), reach, thickness=length)
    opposite = OppositeZone.on_circle(disc, "surface", complex(seat.pin_radius), 1.1 * reach)

    def pressure(x: FloatArray, n: FloatArray) -> tuple[FloatArray, FloatArray]:
        inside = np.clip(1.0 - (x[1] / seat.patch_half_width) ** 2, 0.0, None) * (x[0] > 0.0)
        return -np.sqrt(inside), np.zeros_like(inside)

    patch = traction_load(ring, "outer", pressure, thickness=length)
    patch /= -patch[0::2].sum()
    shapes = sp.hstack([zone.load_shapes(ring.unknowns), sp.csc_matrix(patch[:, None])], format="csc")
    carrier = condense_body(ring, assemble_stiffness(ring, seat.sleeve, thickness=length), shapes)
    free = condense_body(disc, assemble_stiffness(disc, seat.pin, thickness=length), opposite.unit_loads(disc.unknowns))
    pair = integrate_pair(zone, Pose(), Pose(centre=complex(bore_radius - seat.pin_radius)), seat.pin_radius, opposite)
    own, by_patch = carrier.compliance[:-1, :-1], carrier.compliance[:-1, -1]
    problem = ContactProblem(
        compliance=own + pair.opposite_loads.T @ free.compliance @ pair.opposite_loads,
        gap=pair.gap + by_patch * load,
        motions=-pair.force[0][:, None],
        external=np.array([load]),
    )
    arc = zone.arc
    start = np.abs(arc[1:-1] - 0.5 * arc[-1]) < 0.8 * seat.half_angle * bore_radius
    solution = solve_floating_contact(problem, start)
    found = zone.at_vertices(solution.pressure)
    half_width = 2.0 * float(np.sqrt(pressure_moments(arc, found)[2]))
    return SqueezedSleeve(
        approach=float(by_patch @ solution.pressure + carrier.compliance[-1, -1] * load - solution.motion[0]),
        effective_half_angle=half_width / bore_radius,
        largest_pressure=peak_of(arc, found, half_width),
        unknowns=ring.unknowns + disc.unknowns,
    )
