"""Contacts on pins that beams and the ring of the wheel displace."""

from __future__ import annotations

import weakref
from itertools import product
from typing import Any, TypeAlias

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.pair_motion import dot
from ltca.geometry.rotation import unit
from ltca.mechanics.places import Indices

Directions: TypeAlias = dict[tuple[int, int], ComplexArray]
"""By component of a contact and kind of displacement: of pins, 0, and leans of theirs, 1."""


class PinMembers:
    """Wheel pins and shaft pins of all discs under their contacts; wheel pins are displaced in the frame of the turning wheel."""

    def __init__(self, at: Any) -> None:
        # Not a circle of references: what a search has evaluated goes as soon as nobody asks for it.
        self.at, system = weakref.proxy(at), at.system
        place, pins = system.geometries[0].placement, system.pins
        turned = unit(place.wheel_rotation(at.angle) + at.pose[:, WHEEL_ANGLE]).conjugate()[:, None]
        self.along: list[ComplexArray] = []
        # How displacements of pins and their leans change components, by disc; how these load them, with friction.
        self.by: list[list[list[ComplexArray]]] = []
        self.onto: list[list[list[ComplexArray]]] = []
        self._chosen()
        for disc, each in enumerate(at.discs):
            frame = np.where(np.arange(pins + system.holes) < pins, turned, 1.0)

            def seen(first: FloatArray, second: FloatArray, frame: ComplexArray = frame) -> ComplexArray:
                both = np.concatenate((first, second), axis=1)[..., DISC_PLACE]
                return np.asarray(-(both[..., 0] + 1j * both[..., 1]) * frame)  # as the disc moves the other way

            along = seen(each.flank.along, each.holes.along)
            normal, *turning = (seen(*gradients) for gradients in each.gradients)
            rubs = (at.rubs[disc], at.rubs_leaning[disc]) if at.rubs else ()
            pressing, leaning = (normal + rub * along for rub in rubs) if rubs else (normal, normal)
            self.along.append(along)
            # Displacements change approaches and, as normals turn along the width, tilts; leans change tilts alone.
            self.by.append([[normal, *turning], *([normal] for _ in turning)])
            self.onto.append([[pressing, *turning], *([leaning] for _ in turning)])

    def forces(self, load: FloatArray, aside: FloatArray | None = None, *, changes: bool = False) -> ComplexArray:
        """Return Lᵀ f of loads, or of `changes` of loads without friction that sticks, shape (positions, rows, pairs), and of
        forces `aside` of the normals, shape (positions, components, discs, pairs).
        """
        system = self.at.system
        found = np.zeros((load.shape[0], system.components, system.discs, system.pins + system.holes), dtype=complex)
        for disc, kinds in enumerate(system.of_kind):
            pressed = np.concatenate((load[..., kinds[0]], load[..., kinds[2]]), axis=-1)
            for displaced, onto in enumerate(self.onto[disc]):
                force = found[:, displaced, disc]
                for component, direction in enumerate(onto, displaced):
                    force += pressed[:, component] * direction
                if aside is not None:
                    force += aside[:, displaced, disc] * self.along[disc]
            if self.at.sticking and not changes:
                found[:, 0, disc] += self.at.sticking[disc][2] * self.along[disc]
        return found.reshape(load.shape[0], -1, found.shape[-1])

    def approaches(self, shifts: ComplexArray) -> FloatArray:
        """Return N u of all contacts, shape (positions, components, contacts)."""
        system = self.at.system
        found = np.zeros((shifts.shape[0], system.components, system.contacts))
        for disc, (pins, _, holes, _) in enumerate(system.of_kind):
            for displaced, by in enumerate(self.by[disc]):
                moved = shifts[:, displaced * system.discs + disc]
                for component, direction in enumerate(by, displaced):
                    values = dot(direction, moved)
                    found[:, component, pins] += values[:, : system.pins]
                    found[:, component, holes] += values[:, system.pins :]
        return found

    def unsettled(self, shifts: ComplexArray) -> ComplexArray:
        """Return u + S Lᵀ f, how far pins stand from where the loads press them, mm."""
        self._left: ComplexArray = np.asarray(shifts + self.at.system.model.pins.under(self.forces(self.at.load)))
        return self._left

    def slips(self) -> FloatArray:
        """Return the remaining slips of pins along the chosen contacts, mm, in the order of `turned_loads`."""
        found, at, system = [], self.at, self.at.system
        for disc, (along, own) in enumerate(zip(self.along, at.chosen, strict=True)):
            some = np.concatenate((own[0], system.pins + own[2]), axis=1)
            each = [dot(along, left) for left in self._left[:, disc :: system.discs].swapaxes(0, 1)]
            found.append(np.stack([one[at.row, some] for one in each], axis=1))
        return np.concatenate(found, axis=2)

    def _chosen(self) -> None:
        """Find the contacts on pins among the chosen ones, their pins and discs."""
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

    def of_all(self, values: FloatArray) -> FloatArray:
        """Values of the chosen contacts on pins, shape (positions, components, entries, columns), by disc and pair."""
        rows, components, _, columns = values.shape
        discs, pairs = self.at.system.discs, self.at.system.pins + self.at.system.holes
        found = np.zeros((rows, components, discs, pairs, columns))
        found[self.at.row, :, self.disc, self.pair] = values.swapaxes(1, 2)
        return found

    def turned_loads(self, size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return stiffnesses F κ (in slices M κ between place and lean) of loads against pins that move along their contacts,
        slips by the pose, and loads times the angle by which the wheel turns against the disc.

        Shapes are (1 or 3, positions, entries) and twice (positions, components, entries, coordinates).
        """
        at, system = self.at, self.at.system
        rows, each = at.pose.shape[0], []
        slip, turn = np.zeros((2, rows, system.components, self.count, size))
        last = 0
        for disc, own in enumerate(system.columns):
            of_disc = at.discs[disc]
            for kind, motion, sign in ((0, of_disc.flank, -1.0), (2, of_disc.holes, 1.0)):
                some, first = at.chosen[disc][kind], last
                last += some.shape[1]
                bend = sign * motion.bending[at.row, some]
                load = at.load[:, :, system.of_kind[disc][kind]]
                parts = [bend * load[:, component][at.row, some] for component in range(system.components)]
                each.append(np.stack([*parts, *(np.zeros(bend.shape) for _ in parts[1:])]))
                if kind == 0:
                    for component, part in enumerate(load.swapaxes(0, 1)):
                        turning = turn[:, component, first:last]
                        turning[..., own[DISC_ROTATION]] -= part[at.row, some]
                        turning[..., own[WHEEL_ANGLE]] += part[at.row, some]
                        if at.by_crank:  # the wheel turns with the crank
                            turning[..., -1] += part[at.row, some] / of_disc.geometry.placement.reduction_ratio
                along = motion.along[at.row, some]
                by_place = slip[:, 0]
                by_place[:, first:last, own] = along
                if at.by_crank:
                    by_place[:, first:last, -1] = np.matmul(along, of_disc.nominal)[..., 0]
                for by_lean in slip.swapaxes(0, 1)[1:]:
                    by_lean[:, first:last, own[system.one.lean_place]] = at.half[..., None] * along[..., DISC_PLACE]
                    if kind == 0 and system.one.wheel_leans:
                        by_lean[:, first:last, own[system.one.wheel_lean_place]] = (
                            -at.half[..., None] * along[..., DISC_PLACE]
                        )
        return np.concatenate(each, axis=2), slip, turn

    def add_flexibility(self, whole: FloatArray) -> None:
        """Add N S Lᵀ to W, in place: of the chosen contacts, or of those on pins alone, then of their slips (`turned_loads`)."""
        at, system = self.at, self.at.system
        held = system.model.pins
        assert held is not None
        row = at.row
        pair = np.concatenate((self.pair, self.pair), axis=1)
        place = np.arange(2 * self.count)
        if system.coupled:
            place = np.concatenate((self.place, at.count + np.arange(self.count)))

        def chosen(values: list[ComplexArray], along: list[ComplexArray]) -> ComplexArray:
            first, second = (np.stack(each, axis=1)[row, self.disc, self.pair] for each in (values, along))
            return np.concatenate((first, second), axis=1)

        def every(by_disc: list[list[list[ComplexArray]]]) -> Directions:
            return {
                (component, displaced): chosen(
                    [each[displaced][component - displaced] for each in by_disc],
                    self.along if component == displaced else [np.zeros_like(one) for one in self.along],
                )
                for displaced in range(system.components)
                for component in range(displaced, system.components)
            }

        by, onto = every(self.by), every(self.onto)
        if held.beams.any():
            self._add_beams(whole, place, by, onto)
        if held.ring is None:
            return
        first, second = place[:, None], place[None, :]
        seats = held.ring.shape[-2]
        on_wheel = pair < seats
        seat = np.minimum(pair, seats - 1)
        behind = (row[..., None],) if held.ring.ndim > 4 else ()
        for a, b in np.ndindex(system.components, system.components):
            total, mine, theirs = np.zeros((*pair.shape, pair.shape[1])), by[a, 0], onto[b, 0]
            for x, left in enumerate((mine.real, mine.imag)):
                for y, right in enumerate((theirs.real, theirs.imag)):
                    moved = held.ring[(*behind, seat[:, :, None], x, seat[:, None, :], y)]
                    total += moved * (left * on_wheel)[:, :, None] * (right * on_wheel)[:, None, :]
            whole[:, a, first, b, second] += total

    def _add_beams(self, whole: FloatArray, place: Indices, by: Directions, onto: Directions) -> None:
        """Add the approaches of contacts on a pin by loads on the same pin, through its beam."""
        discs, beams, count = self.at.system.discs, self.at.system.model.pins.beams, self.count
        number = np.full((self.at.angle.size, discs, beams.shape[-3]), -1)
        number[self.at.row, self.disc, self.pair] = np.arange(count)
        for disc in range(discs):
            partner = number[self.at.row, disc, self.pair]
            row, mine = np.nonzero(partner >= 0)
            other, pin = partner[row, mine], self.pair[row, mine]
            behind = (row,) if beams.ndim > 3 else ()
            for ((a, i), left), ((b, j), right) in product(by.items(), onto.items()):
                beam = beams[(*behind, pin, self.disc[mine] + i * discs, disc + j * discs)]
                if not beam.any():
                    continue
                for first, second in product((mine, count + mine), (other, count + other)):
                    moved = beam * dot(left[row, first], right[row, second])
                    whole[row, a, place[first], b, place[second]] += moved


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a linear system position by position; ConvergenceError where loads that turn make one singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    except np.linalg.LinAlgError:
        raise ConvergenceError("contacts at a pose hold nothing: their linear system is singular") from None
