"""Flexibility of the ring of the pin wheel at the seats of its pins: a curved beam in closed form, or plane finite elements.

A file of elements, from the cache or derived once for each shape, is for E b = 1 N/mm without bolts. Off comes the yield that the
law of a loose pin in its slot has as well, u = π r² b/4μ (2 p₀² C₀ + Σ pₙ² Cₙ) by Michell (docs/theory/ring_elements.md).
"""

from __future__ import annotations

import sys
from math import pi
from pathlib import Path

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.coefficient_files import derivation
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import has_ring_of_elements, loaded_half_arc, ring_fingerprint, ring_shape
from ltca.laws.backed import SLOT_DATUM
from ltca.laws.ring_beam import beam_flexibility, beyond_rigid_motions, on_bolts, rigid_motions
from ltca.output.derived_files import cache_folder, kept_file, read_kept, require_cache
from ltca.output.locks import held
from ltca.reading.ring_file import read_ring, require_same_ring, write_ring

DERIVATION = "ring"
HARMONICS = 4000
"""Of the pressure on a seat; the rest of the sum is below 1e-6 of it."""

SECONDS_PER_PIN = 0.05
"""Time of a derivation on one core, s: 0.7 s for 14 pins, 1.8 s for 40."""

_KNOWN: dict[str, FloatArray] = {}
"""Flexibilities of the rings that this process has read, by fingerprint."""
MAX_KNOWN = 16


def ring_flexibility(drive: Drive, lender: Drive | None = None) -> FloatArray | None:
    """Return displacements of seats by unit forces, mm/N, (z_P, 2, z_P, 2), of elements shaped as the lender's; None if rigid."""
    if not has_ring_of_elements(drive):
        return beam_flexibility(drive)
    found = _of_elements(drive, drive if lender is None else lender)
    # What is left of a stiff wall may be negative; with the law of the slot, which is in series, it is the ring's own again.
    return found - _of_slot(drive) if drive.pin_wheel.seat.kind == "slot" else found


def _of_elements(drive: Drive, lender: Drive) -> FloatArray:
    """The flexibility of a plane ring of a drive at its seats, bolts included, with the shape of that of the lender, mm/N."""
    ring, own, wheel = lender.ring, drive.ring, lender.pin_wheel
    assert ring is not None
    assert own is not None
    unit = 1.0 / (own.material.youngs_modulus * own.width)
    among, pins = unit * known_ring(lender), wheel.number_of_pins
    seats = 2.0 * pi * np.arange(pins) / pins
    places, radii = seats, np.full(pins, wheel.pin_circle_radius)
    if ring.flange == "built-in":
        return among
    if ring.bolts is None:
        modes = rigid_motions(places, radii).reshape(-1, 3)
        return beyond_rigid_motions(modes, among.reshape(2 * pins, -1)).reshape(among.shape)
    bolts = 2.0 * pi * np.arange(ring.bolts.number) / ring.bolts.number
    places = np.concatenate((seats, bolts))
    radii = np.concatenate((radii, np.full(bolts.size, ring.bolts.circle_radius)))
    modes = rigid_motions(places, radii).reshape(-1, 3)
    assert own.bolts is not None  # nearly the same ring has as many
    return on_bolts(among.reshape(2 * places.size, -1), modes, pins, own.bolts.stiffness)


def has_ring(drive: Drive) -> bool:
    """Tell whether the plane ring of a drive is there without being derived."""
    return ring_fingerprint(drive) in _KNOWN or kept_file(file_name(drive)).exists()


def expected_ring_seconds(drive: Drive) -> float:
    """Return about how long the derivation of the ring of a drive takes on one core, s."""
    return SECONDS_PER_PIN * drive.pin_wheel.number_of_pins


def known_ring(drive: Drive) -> FloatArray:
    """Return the content of the file of a drive's ring, found or derived once in a process; CycloError where that cannot be."""
    key = ring_fingerprint(drive)
    if key not in _KNOWN:
        while len(_KNOWN) >= MAX_KNOWN:
            del _KNOWN[next(iter(_KNOWN))]
        _KNOWN[key] = _kept_or_derived(drive)
    return _KNOWN[key]


def _kept_or_derived(drive: Drive) -> FloatArray:
    """The same from the cache, or newly derived and kept there."""
    name = file_name(drive)

    def read(path: Path) -> FloatArray:
        dataset = read_ring(path)
        require_same_ring(dataset, drive, str(path))
        found: FloatArray = dataset["flexibility"].values.astype(float)
        return found

    if (found := read_kept(name, read)) is not None:
        return found
    derive = derivation(DERIVATION)
    require_cache()
    with held(cache_folder() / f".{name}.lock", "the cache", "derive", wait=True):
        if (found := read_kept(name, read)) is not None:  # another process was faster
            return found
        path = cache_folder() / name
        print(
            f"deriving the ring of {drive.name}, once for each shape (some seconds; kept in {path.parent})",
            file=sys.stderr,
        )
        write_ring(derive(drive), path)
    return read(kept_file(name))


def file_name(drive: Drive) -> str:
    """Return the name of a file of the ring of a drive, by its shape."""
    return f"ring-{ring_fingerprint(drive)}.nc"


def _of_slot(drive: Drive) -> FloatArray:
    """What the law of the slots has of the flexibility at each seat, as `ring_flexibility`, mm/N."""
    ring, pins = drive.ring, drive.pin_wheel.number_of_pins
    assert ring is not None
    shape = ring_shape(drive)
    own = slot_yield(loaded_half_arc(shape), ring.material.poisson_ratio, SLOT_DATUM)
    own = own / (ring.material.youngs_modulus * ring.width)
    angle = 2.0 * pi * np.arange(pins) / pins
    axes = np.stack((np.exp(1j * angle), 1j * np.exp(1j * angle)), axis=1)
    components = np.stack((axes.real, axes.imag), axis=-1)  # (pins, axis, component)
    found = np.zeros((pins, 2, pins, 2))
    number = np.arange(pins)
    found[number, :, number, :] = np.einsum("pka,k,pkb->pab", components, own, components)
    if ring.flange == "built-in" or ring.bolts is not None:
        return found
    modes = rigid_motions(angle, drive.pin_wheel.pin_circle_radius).reshape(-1, 3)
    return beyond_rigid_motions(modes, found.reshape(2 * pins, -1)).reshape(found.shape)


def slot_yield(half_arc: float, poisson_ratio: float, datum: float) -> FloatArray:
    """Return the radial and tangential displacement of a seat in an infinite plate by a unit force on its wall, times E b.

    The mean weighted by the pressure over twice `half_arc`, rad, relative to the circle of `datum` radii; on half a seat:

    >>> print(slot_yield(0.5 * pi, 0.3, 3.0).round(3))
    [0.837 0.802]
    """
    kappa, shear = (3.0 - poisson_ratio) / (1.0 + poisson_ratio), 1.0 / (2.0 * (1.0 + poisson_ratio))
    order = np.arange(HARMONICS + 1)
    both = half_arc + 0.5 * np.sin(2.0 * half_arc), half_arc - 0.5 * np.sin(2.0 * half_arc)
    # ∫ cos θ cos nθ and ∫ sin θ sin nθ over the arc, by sinc(x) = sin x / x of the angle.
    less, more = (half_arc * np.sinc((order + step) * half_arc / pi) for step in (-1, 1))
    yields = np.empty(order.size)
    yields[0] = 2.0
    yields[1] = 2.0 * kappa / (kappa + 1.0) * np.log(datum) + 0.5
    yields[2:] = kappa / (order[2:] - 1.0) + 1.0 / (order[2:] + 1.0)
    found = []
    for whole, integral in zip(both, (less + more, less - more), strict=True):
        pressure = integral / (whole * pi)  # p_n of a unit force, by 1/(r b)
        pressure[0] *= 0.5
        energy = yields * pressure**2
        found.append(pi / (4.0 * shear) * (2.0 * energy[0] + energy[1:].sum()))
    return np.array(found)
