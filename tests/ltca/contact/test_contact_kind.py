"""Kinds of contacts: modulus and length of each."""

from __future__ import annotations

from dataclasses import replace

import pytest

from ltca.contact.contact_kind import ContactKind, ContactKinds
from ltca.drive.parts import Material, Materials


def test_every_kind_has_the_modulus_of_its_two_bodies(paper_cases):
    """1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ (Johnson 4.40) with four different materials."""
    values = {"disc": (72e3, 0.34), "wheel_pin": (310e3, 0.26), "roller": (206e3, 0.3), "inner_race": (110e3, 0.28)}
    own = {name: Material(youngs_modulus=modulus, poisson_ratio=ratio) for name, (modulus, ratio) in values.items()}
    drive = paper_cases["CS-1"]
    drive = replace(drive, materials=replace(drive.materials, **own))
    assert isinstance(drive.materials, Materials)
    kinds = ContactKinds.of_drive(drive)
    for kind, first, second in (
        (kinds.pins, "disc", "wheel_pin"),
        (kinds.outer, "disc", "roller"),
        (kinds.inner, "inner_race", "roller"),
    ):
        yielding = sum((1.0 - ratio**2) / modulus for modulus, ratio in (values[first], values[second]))
        assert kind.contact_modulus == pytest.approx(1.0 / yielding, rel=1e-12), (first, second)


def test_every_kind_has_its_own_length(paper_cases):
    """Pins touch over the disc's thickness, rollers over their own length; circles are even, flanks are not."""
    drive = paper_cases["CS-1"]
    drive = replace(drive, crank_bearing=replace(drive.crank_bearing, roller_length=9.5))
    kinds = ContactKinds.of_drive(drive)
    assert (kinds.pins.length, kinds.outer.length, kinds.inner.length) == (11.8, 9.5, 9.5)
    assert (kinds.pins.symmetric, kinds.outer.symmetric, kinds.inner.symmetric) == (False, True, True)
    assert kinds.inner.end_cell == pytest.approx(0.095)  # a hundredth of the length


def test_kinds_are_values():
    """They held the cells of the last contact once: whoever came next started there."""
    one, other = (ContactKind(length=11.8, contact_modulus=113e3, generator=None, symmetric=True) for _ in range(2))
    assert hash(one) == hash(other)
    assert one == other
