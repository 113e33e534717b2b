"""The plane finite-element ring of the pin wheel: what determines its flexibility, and the key of a file of it.

The flexibility of a plane body is a number by 1/(E b): modulus and width of the ring, and the stiffness of its bolts, take no
new derivation.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import acos, cos, pi, radians, sin, sqrt

from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.parts import Drive, PinWheel
from ltca.errors import Problem

LEAST_HALF_ARC = radians(45.0)
"""Half the arc of a seat below which it cannot lead its pin tangentially."""
SHARPEST_CORNER = radians(25.0)
"""Angle of the metal between two seats at their mouths, below which no sound mesh is made."""
LEAST_METAL = 0.1
"""Least metal between two seats whose mouths are narrower than they, by the radius of a seat."""
DEEP_SEATS = 0.085
"""Depth of the seats as a part of the radial height from which a free ring yields by some 10 % more than its beam: cosine rows of
forces have 3.3 % at 0.05 and 92 % at 0.25, which a power of the depth joins."""
BOLT_PATCH = 0.1
"""Radius of the patch that a bolt holds, by the radial height of the ring outside the seats."""


def seat_radius(wheel: PinWheel) -> float:
    """Return the radius of the seats of the wheel pins in their ring, mm: of the slot, or of the pin that is fixed in it."""
    own = wheel.seat.radius if wheel.seat.kind == "slot" else wheel.seat.pin_radius
    return own or wheel.pin_radius


def inner_radius_bounds(wheel: PinWheel) -> tuple[float, float]:
    """Return between which inner radii a ring with its seats can be meshed, mm: metal between the mouths of seats not too
    sharp, arcs long enough to lead a pin.
    """
    circle, seat = wheel.pin_circle_radius, seat_radius(wheel)
    sharp = -seat * cos(SHARPEST_CORNER) + sqrt(circle**2 - (seat * sin(SHARPEST_CORNER)) ** 2)
    return sharp, sqrt(circle**2 + seat**2 + 2.0 * circle * seat * cos(LEAST_HALF_ARC))


def seat_depth(drive: Drive) -> float:
    """Return how deep the seats of the wheel pins reach into their ring, as a part of its radial height; 0 without a ring."""
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        return 0.0
    return (wheel.pin_circle_radius + seat_radius(wheel) - ring.inner_radius) / (ring.outer_radius - ring.inner_radius)


def deep_seats_warning(drive: Drive) -> str | None:
    """Return a warning where a ring that is a beam has seats so deep that finite elements of it yield much more, or None.

    Built-in rings are left out: held all around they yield by little, as beam and as plane ring.
    """
    ring, part = drive.ring, seat_depth(drive)
    if ring is None or ring.model == "fe" or ring.flange == "built-in" or part <= DEEP_SEATS:
        return None
    height = ring.outer_radius - ring.inner_radius
    return (
        f"the seats of the wheel pins are {part * height:.4g} mm deep, {part:.2g} of the radial height of the ring "
        f"({height:.4g} mm): a beam has no seats cut into it, and from {DEEP_SEATS:g} on the ring is too stiff by 10 % "
        'and more, the drive by less; ring.model = "fe" has them'
    )


def bolt_patch_radius(drive: Drive) -> float:
    """Return the radius of the patch that a bolt of the ring holds, mm."""
    ring, wheel = drive.ring, drive.pin_wheel
    outer = 0.0 if ring is None else ring.outer_radius
    return BOLT_PATCH * (outer - wheel.pin_circle_radius - seat_radius(wheel))


def ring_mesh_problems(drive: Drive) -> Iterator[Problem]:
    """Yield why the ring of a drive cannot be one of finite elements, one sentence each: its seats have to lead the pins, its
    bolts to stand in metal.
    """
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        return
    sharp, short = inner_radius_bounds(wheel)
    inner, circle, seat = ring.inner_radius, wheel.pin_circle_radius, seat_radius(wheel)
    if inner < sharp:
        yield Problem.of(
            "ring.inner_radius",
            f"= {inner:g} mm",
            f"must be at least {sharp:g} mm for finite elements of the ring",
            otherwise="metal between two seats ends too sharp for a mesh",
            bound=("at least", sharp),
        )
    if inner > short:
        yield Problem.of(
            "ring.inner_radius",
            f"= {inner:g} mm",
            f"must be at most {short:g} mm for finite elements of the ring",
            otherwise="the seats are too flat to lead the pins",
            bound=("at most", short),
        )
    between = 2.0 * circle * sin(pi / wheel.number_of_pins) - 2.0 * seat
    if between <= LEAST_METAL * seat and inner < circle:
        yield Problem.of(
            "ring.inner_radius",
            f"= {inner:g} mm",
            f"must be at least {circle:g} mm (pin_wheel.pin_circle_radius) for finite elements of the ring: "
            f"{between:.4g} mm of metal are left between two seats",
            bound=("at least", circle),
        )
    bolts, patch = ring.bolts, bolt_patch_radius(drive)
    if bolts is None or ring.flange == "built-in":
        return
    low, high = circle + seat + patch, ring.outer_radius - patch
    if not low <= bolts.circle_radius <= high:
        yield Problem.of(
            "ring.bolts.circle_radius",
            f"= {bolts.circle_radius:g} mm",
            f"must be {low:g} to {high:g} mm for finite elements of the ring, in metal outside the seats",
        )


def has_ring_of_elements(drive: Drive) -> bool:
    """Tell whether the analysis of a drive takes its ring from finite elements."""
    return drive.ring is not None and drive.ring.model == "fe"


def ring_shape(drive: Drive) -> dict[str, float]:
    """Return the numbers that determine the plane ring of a drive up to 1/(E b), by name: mm, counts; empty without ring."""
    drive.require_warmed()
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        return {}
    shape = {
        "pin_wheel.number_of_pins": float(wheel.number_of_pins),
        "pin_wheel.pin_circle_radius": wheel.pin_circle_radius,
        "seat_radius": seat_radius(wheel),
        "ring.inner_radius": ring.inner_radius,
        "ring.outer_radius": ring.outer_radius,
        "ring.material.poisson_ratio": ring.material.poisson_ratio,
        "built_in": float(ring.flange == "built-in"),
    }
    if ring.bolts is not None:
        shape |= {
            "ring.bolts.number": float(ring.bolts.number),
            "ring.bolts.circle_radius": ring.bolts.circle_radius,
        }
    return {name: float(f"{value:.12g}") for name, value in shape.items()}


def nearly_same_ring(first: Drive, second: Drive, bound: float) -> bool:
    """Tell whether plane rings of two drives differ so little that one may serve the other: as parts of the pin circle, which
    alone scales a ring, radii by at most `bound` of the radial height, seats by `bound` of their radius; numbers are equal.
    """
    one, other = ring_shape(first), ring_shape(second)
    if not one or one.keys() != other.keys():
        return False
    scale = one["pin_wheel.pin_circle_radius"] / other["pin_wheel.pin_circle_radius"]
    height = one["ring.outer_radius"] - one["ring.inner_radius"]
    for name, value in one.items():
        if name == "pin_wheel.pin_circle_radius":
            continue
        length = name.endswith("_radius")
        far = abs(other[name] * (scale if length else 1.0) - value)
        if name == "ring.material.poisson_ratio" or name == "seat_radius":
            most = bound * value
        else:
            most = bound * height if length else 0.0
        if far > most:
            return False
    return True


def ring_fingerprint(drive: Drive) -> str:
    """Return a hash of `ring_shape` (hex, 16 digits), the key of a file of the ring's flexibility."""
    return fingerprint_of(ring_shape(drive))


def loaded_half_arc(shape: dict[str, float]) -> float:
    """Return half the angle of a seat's wall that its pin loads, that of the outer half, rad, by a `ring_shape`."""
    inner, circle, seat = shape["ring.inner_radius"], shape["pin_wheel.pin_circle_radius"], shape["seat_radius"]
    return min(acos((inner**2 - circle**2 - seat**2) / (2.0 * circle * seat)), 0.5 * pi)
