"""Contacts on pins that beams and the ring of the wheel displace: how they follow the displacements, and what they press."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.geometry.coordinates import DISC_PLACE, WHEEL_ANGLE
from ltca.geometry.pair_motion import dot
from ltca.geometry.rotation import unit


class PinMembers:
    """Wheel pins and shaft pins of all discs under their contacts.

    Displacements of wheel pins are those in the turning wheel. A pin moves against a disc as the disc moves the other way against
    it, so that the derivatives N are those by the place of the disc, turned round.

    Parameters
    ----------
    at : ltca.mechanics.contacts.Linearised
        The contacts at poses.
    """

    def __init__(self, at: Any) -> None:
        self.at, system = at, at.system
        place, pins = system.geometries[0].placement, system.pins
        turned = unit(place.wheel_rotation(at.angle) + at.pose[:, WHEEL_ANGLE]).conjugate()[:, None]
        self.normal, self.pressing, self.turning, self.along = [], [], [], []
        self._chosen()
        for disc, each in enumerate(at.discs):
            frame = np.where(np.arange(pins + system.holes) < pins, turned, 1.0)

            def seen(first: FloatArray, second: FloatArray, frame: ComplexArray = frame) -> ComplexArray:
                both = np.concatenate((first, second), axis=1)[..., DISC_PLACE]
                return np.asarray(-(both[..., 0] + 1j * both[..., 1]) * frame)

            normal = seen(each.flank.gradient, each.holes.gradient)
            along = seen(each.flank.along, each.holes.along)
            pressing = normal + at.rubs[disc] * along if at.rubs else normal
            self.along.append(along)
            self.normal.append(normal)
            self.pressing.append(pressing)
            if each.tilts is not None:
                self.turning.append(at.half * seen(each.tilts[0].gradient, each.tilts[1].gradient))

    def forces(self, load: FloatArray) -> ComplexArray:
        """Return Lᵀ f of loads of all contacts, by row of the displacements, shape (positions, rows, pairs)."""
        system, forces, moments = self.at.system, [], []
        for disc, kinds in enumerate(system.of_kind):
            pressed = np.concatenate((load[..., kinds[0]], load[..., kinds[2]]), axis=-1)
            force = pressed[:, 0] * self.pressing[disc]
            if self.turning:
                force = force + pressed[:, 1] * self.turning[disc]
                moments.append(pressed[:, 1] * self.pressing[disc])
            forces.append(force)
        return np.stack(forces + moments, axis=1)

    def approaches(self, shifts: ComplexArray) -> FloatArray:
        """Return N u of the chosen contacts, shape (positions, components, chosen)."""
        system, at = self.at.system, self.at
        found = np.zeros((shifts.shape[0], system.components, at.contacts.shape[1]))
        for disc in range(system.discs):
            by = dot(self.normal[disc], shifts[:, disc])
            each = [by]
            if self.turning:
                each.append(
                    dot(self.turning[disc], shifts[:, disc]) + dot(self.normal[disc], shifts[:, system.discs + disc])
                )
            some = at.chosen[disc]
            for kind, first in ((0, 0), (2, system.pins)):
                for component, values in enumerate(each):
                    found[:, component, at.at[disc][kind]] = values[at.row, first + some[kind]]
        return found

    def _chosen(self) -> None:
        """Where the contacts on pins stand among the chosen, and on which pins and discs."""
        at, system = self.at, self.at.system
        places, pairs, discs = [], [], []
        for disc in range(system.discs):
            for kind, first in ((0, 0), (2, system.pins)):
                own = at.at[disc][kind]
                places.append(np.arange(own.start, own.stop))
                pairs.append(first + at.chosen[disc][kind])
                discs.append(np.full(own.stop - own.start, disc))
        self.place, self.pair, self.disc = np.concatenate(places), np.concatenate(pairs, axis=1), np.concatenate(discs)
        self.count = self.place.size

    def turned_loads(self, size: int) -> tuple[FloatArray, FloatArray]:
        """Return what loads on pins that move along their contacts resist with, and the slip by the pose.

        They are entries of the linear system behind the chosen contacts: stiffnesses F κ and, in slices, M κ between place and
        lean, shape (1 or 3, positions, entries), and slips, shape (positions, components, entries, coordinates).
        """
        at, system = self.at, self.at.system
        rows, each = at.pose.shape[0], []
        slip = np.zeros((rows, system.components, self.count, size))
        last = 0
        for disc, own in enumerate(system.columns):
            of_disc = at.discs[disc]
            for kind, motion, sign in ((0, of_disc.flank, -1.0), (2, of_disc.holes, 1.0)):
                some, first = at.chosen[disc][kind], last
                last += some.shape[1]
                bend = sign * motion.bending[at.row, some]
                load = at.load[:, :, system.of_kind[disc][kind]]
                # bend = np.maximum(bend, 0.0)
                parts = [bend * load[:, component][at.row, some] for component in range(system.components)]
                each.append(np.stack([*parts, np.zeros(bend.shape)]) if system.components > 1 else np.stack(parts))
                along = motion.along[at.row, some]
                by_place = slip[:, 0]
                by_place[:, first:last, own] = along
                if at.by_crank:
                    by_place[:, first:last, -1] = np.matmul(along, of_disc.nominal)[..., 0]
                if system.components > 1:
                    half = at.half[..., None] if at.half.ndim else at.half
                    by_lean = slip[:, 1]
                    by_lean[:, first:last, own[system.one.lean_place]] = half * along[..., DISC_PLACE]
                    if kind == 0 and system.one.wheel_leans:
                        by_lean[:, first:last, own[system.one.wheel_lean_place]] = -half * along[..., DISC_PLACE]
        return np.concatenate(each, axis=2), slip

    def add_flexibility(self, whole: FloatArray) -> None:
        """Add N S Lᵀ to W, in place: of the chosen contacts, and behind these of what slips along them (`turned_loads`)."""
        at, system = self.at, self.at.system
        held = system.model.pins
        assert held is not None
        row = at.row
        pair, disc_of = np.concatenate((self.pair, self.pair), axis=1), np.concatenate((self.disc, self.disc))
        place = np.concatenate((self.place, at.contacts.shape[1] + np.arange(self.count)))

        def chosen(values: list[ComplexArray], along: list[ComplexArray]) -> ComplexArray:
            first, second = (np.stack(each, axis=1)[row, self.disc, self.pair] for each in (values, along))
            return np.concatenate((first, second), axis=1)

        none = np.zeros(pair.shape, dtype=complex)
        normal, pressing = chosen(self.normal, self.along), chosen(self.pressing, self.along)
        # By component and kind of displacement: shifts, and leans in slices.
        by: list[list[ComplexArray]] = [[normal]]
        onto: list[list[ComplexArray]] = [[pressing]]
        if self.turning:
            turning = chosen(self.turning, [np.zeros_like(one) for one in self.turning])
            by, onto = [[normal, none], [turning, normal]], [[pressing, none], [turning, pressing]]
        kinds = len(by[0])
        same = pair[:, :, None] == pair[:, None, :]
        first, second = place[:, None], place[None, :]
        if held.beams.any():
            behind = (row[..., None],) if held.beams.ndim > 3 else ()
            for i in range(kinds):
                for j in range(kinds):
                    at_pin = (
                        *behind,
                        pair[:, :, None],
                        (disc_of + i * system.discs)[:, None],
                        disc_of + j * system.discs,
                    )
                    beam = held.beams[at_pin] * same
                    if not beam.any():
                        continue
                    for a, mine in enumerate(by):
                        for b, theirs in enumerate(onto):
                            whole[:, a, first, b, second] += beam * dot(mine[i][:, :, None], theirs[j][:, None, :])
        if held.ring is None:
            return
        seats = held.ring.shape[-2]
        on_wheel = pair < seats
        seat = np.minimum(pair, seats - 1)
        behind = (row[..., None],) if held.ring.ndim > 4 else ()
        for a, mine in enumerate(by):
            for b, theirs in enumerate(onto):
                total = np.zeros(same.shape)
                for x, left in enumerate((mine[0].real, mine[0].imag)):
                    for y, right in enumerate((theirs[0].real, theirs[0].imag)):
                        moved = held.ring[(*behind, seat[:, :, None], x, seat[:, None, :], y)]
                        total += moved * (left * on_wheel)[:, :, None] * (right * on_wheel)[:, None, :]
                whole[:, a, first, b, second] += total
