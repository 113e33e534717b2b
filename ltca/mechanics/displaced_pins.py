"""Contacts on pins that beams and the ring of the wheel displace: how they follow the displacements, and what they press."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE
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
        # Not a circle of references: what a search has evaluated goes as soon as nobody asks for it.
        self.at, system = weakref.proxy(at), at.system
        place, pins = system.geometries[0].placement, system.pins
        turned = unit(place.wheel_rotation(at.angle) + at.pose[:, WHEEL_ANGLE]).conjugate()[:, None]
        self.normal, self.pressing, self.leaning, self.turning, self.along = [], [], [], [], []
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
            self.leaning.append(normal + at.rubs_leaning[disc] * along if at.rubs else normal)
            if each.tilts is not None:
                self.turning.append(at.half * seen(each.tilts[0].gradient, each.tilts[1].gradient))

    def forces(self, load: FloatArray, aside: FloatArray | None = None, *, changes: bool = False) -> ComplexArray:
        """Return Lᵀ f of loads of all contacts, by row of the displacements, shape (positions, rows, pairs), with the friction of
        contacts that stick unless these are `changes` of loads, and what loads press `aside` of the normals as they turn, shape
        (positions, components, discs, pairs).
        """
        system, forces, moments = self.at.system, [], []
        for disc, kinds in enumerate(system.of_kind):
            pressed = np.concatenate((load[..., kinds[0]], load[..., kinds[2]]), axis=-1)
            force = pressed[:, 0] * self.pressing[disc]
            if self.turning:
                force = force + pressed[:, 1] * self.turning[disc]
                moment = pressed[:, 1] * self.leaning[disc]
                moments.append(moment if aside is None else moment + aside[:, 1, disc] * self.along[disc])
            if aside is not None:
                force = force + aside[:, 0, disc] * self.along[disc]
            if self.at.sticking and not changes:
                force = force + self.at.sticking[disc][2] * self.along[disc]
            forces.append(force)
        return np.stack(forces + moments, axis=1)

    def approaches(self, shifts: ComplexArray) -> FloatArray:
        """Return N u of the chosen contacts, shape (positions, components, chosen)."""
        system, at = self.at.system, self.at
        found = np.zeros((shifts.shape[0], system.components, at.count))
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

    def unsettled(self, shifts: ComplexArray) -> ComplexArray:
        """Return how far pins stand from where the loads press them, u + S Lᵀ f, by row of the displacements."""
        self._left: ComplexArray = np.asarray(shifts + self.at.system.model.pins.under(self.forces(self.at.load)))
        return self._left

    def slips(self, chosen: bool = False) -> FloatArray:
        """Return what pins have still to slip along their contacts, of all pairs, shape (positions, components, discs, pairs), or
        of the chosen ones as `turned_loads` has them.
        """
        found, at, system = [], self.at, self.at.system
        for disc, along in enumerate(self.along):
            each = [dot(along, self._left[:, disc])]
            if self.turning:
                each.append(dot(along, self._left[:, system.discs + disc]))
            found.append(np.stack(each, axis=1))
        if not chosen:
            return np.stack(found, axis=2)
        some = [np.concatenate((own[0], system.pins + own[2]), axis=1) for own in at.chosen]
        picked = [np.take_along_axis(one, own[:, None], axis=2) for one, own in zip(found, some, strict=True)]
        return np.concatenate(picked, axis=2)

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

    def of_all(self, values: FloatArray) -> FloatArray:
        """Values of the chosen contacts on pins, shape (positions, components, entries, columns), by disc and pair."""
        rows, components, _, columns = values.shape
        discs, pairs = self.at.system.discs, self.at.system.pins + self.at.system.holes
        found = np.zeros((rows, components, discs, pairs, columns))
        found[self.at.row, :, self.disc, self.pair] = values.swapaxes(1, 2)
        return found

    def turned_loads(self, size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return what loads on pins that move along their contacts resist with, the slip by the pose, and by how much loads turn
        with the pose against the pins.

        They are entries of the linear system behind the chosen contacts: stiffnesses F κ and, in slices, M κ between place and
        lean, shape (1 or 3, positions, entries), slips, shape (positions, components, entries, coordinates), and loads times
        the angle by which the wheel turns against the disc, of that shape: wheel pins are displaced in the turning wheel.
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
                each.append(np.stack([*parts, np.zeros(bend.shape)]) if system.components > 1 else np.stack(parts))
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
                if system.components > 1:
                    half = at.half[..., None] if at.half.ndim else at.half
                    by_lean = slip[:, 1]
                    by_lean[:, first:last, own[system.one.lean_place]] = half * along[..., DISC_PLACE]
                    if kind == 0 and system.one.wheel_leans:
                        by_lean[:, first:last, own[system.one.wheel_lean_place]] = -half * along[..., DISC_PLACE]
        return np.concatenate(each, axis=2), slip, turn

    def add_flexibility(self, whole: FloatArray) -> None:
        """Add N S Lᵀ to W, in place: of the chosen contacts, and behind these of what slips along them (`turned_loads`)."""
        at, system = self.at, self.at.system
        held = system.model.pins
        assert held is not None
        row = at.row
        pair, disc_of = np.concatenate((self.pair, self.pair), axis=1), np.concatenate((self.disc, self.disc))
        place = np.concatenate((self.place, at.count + np.arange(self.count)))

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


class PinBlocks:
    """Contacts on pins that feel no others than those on the same pin and, through the ring, on its seats.

    A pin has an entry by component and disc for its contact and another for what slips along it (`PinMembers.turned_loads`).
    With W the flexibility of its beam, N and L the derivatives by the seat and R the flexibility of the ring, the linear system
    is :math:`(1 + W K + N R L^T K)\\, x = y`: blocks of single pins B = 1 + W K, and one system of all seats,
    :math:`(1 + R L^T K B^{-1} N)\\, s = R L^T K B^{-1} y`, :math:`x = B^{-1} (y - N s)`.

    Arrays have the shape (positions, pairs, entries, …).

    Parameters
    ----------
    members : PinMembers
        Of all contacts.
    """

    def __init__(self, members: PinMembers) -> None:
        self.members, self.at, self.system = members, members.at, members.at.system
        place = self.system.geometries[0].placement
        self.pins = self.system.pins
        self.pairs, self.discs = self.pins + place.hole_radii.shape[-1], self.system.discs
        self.entries = 2 * self.system.components * self.discs

    def of_contacts(self, contacts: list[FloatArray], beside: FloatArray | None = None) -> FloatArray:
        """Values (positions, components, pairs, …) by disc of contacts, and of what slips (…, components, discs, pairs, …)."""
        mine = np.stack(contacts, axis=2)
        both = np.stack((mine, np.zeros(mine.shape) if beside is None else beside), axis=1)
        moved = np.moveaxis(both, 4, 1)
        return moved.reshape(moved.shape[0], self.pairs, self.entries, *moved.shape[5:])

    def to_contacts(self, values: FloatArray, *, slips: bool = False) -> FloatArray:
        """The contacts' part of entries, or that of what slips, shape (positions, components, discs, pairs, …)."""
        shape = values.shape[0], self.pairs, 2, self.system.components, self.discs, *values.shape[3:]
        return np.moveaxis(values.reshape(shape)[:, :, int(slips)], 1, 3)

    def pressed(self, stiffness: FloatArray, moved: FloatArray) -> FloatArray:
        """K of columns of entries, with the stiffness by kind, shape (1 or 3, positions, pairs, 2, discs)."""
        columns = moved.shape[-1]
        each = moved.reshape(*moved.shape[:2], 2, self.system.components, self.discs, columns)
        if self.system.components == 1:
            return np.asarray((stiffness[0][:, :, :, None, :, None] * each).reshape(moved.shape))
        k, mixed, turning = (one[..., None] for one in stiffness)
        first, second = each[:, :, :, 0], each[:, :, :, 1]
        found = np.stack((k * first + mixed * second, mixed * first + turning * second), axis=3)
        return found.reshape(moved.shape)

    def vectors(self) -> tuple[list[list[ComplexArray]], list[list[ComplexArray]]]:
        """Derivatives by displacement and, in slices, lean of what entries approach and tilt by and press with, by component and
        kind of displacement, each of the shape (positions, pairs, 2, discs).
        """
        members = self.members

        def both(first: list[ComplexArray], second: list[ComplexArray] | None) -> ComplexArray:
            mine = np.stack(first, axis=-1)
            other = np.zeros(mine.shape) if second is None else np.stack(second, axis=-1)
            return np.stack((mine, other), axis=2)

        normal, pressing = both(members.normal, members.along), both(members.pressing, members.along)
        if not members.turning:
            return [[normal]], [[pressing]]
        turning, none = both(members.turning, None), np.zeros(normal.shape, dtype=complex)
        return [[normal, none], [turning, normal]], [[pressing, none], [turning, pressing]]

    def flexibility(self, by: list[list[ComplexArray]], onto: list[list[ComplexArray]]) -> FloatArray:
        """W of every pin, shape (positions, pairs, entries, entries)."""
        held, (rows, pairs, _, discs) = self.system.model.pins, by[0][0].shape
        beams = held.beams if held.beams.ndim > 3 else held.beams[None]
        found = np.zeros((rows, pairs, 2, len(by), discs, 2, len(by), discs))
        for i in range(len(by)):
            for j in range(len(by)):
                beam = beams[:, :, i * discs : (i + 1) * discs, j * discs : (j + 1) * discs]
                if not beam.any():
                    continue
                for a, mine in enumerate(by):
                    for b, theirs in enumerate(onto):
                        left, right = mine[i][..., None, None], theirs[j][:, :, None, None]
                        found[:, :, :, a, :, :, b] += beam[:, :, None, :, None] * dot(left, right)
        return found.reshape(rows, pairs, self.entries, self.entries)

    def _on_seats(self, vectors: list[list[ComplexArray]]) -> FloatArray:
        """Derivatives by the displacements of the seats in the ring, shape (positions, seats, entries, 2)."""
        each = np.stack([one[0] for one in vectors], axis=3)[:, : self.pins]
        each = each.reshape(each.shape[0], self.pins, self.entries)
        return np.stack((each.real, each.imag), axis=-1)

    def _through_ring(
        self, by: list[list[ComplexArray]], onto: list[list[ComplexArray]], force: FloatArray
    ) -> FloatArray:
        """What entries are moved by through the ring under forces on them."""
        ring, rows, columns = self.system.model.pins.ring, force.shape[0], force.shape[-1]
        loads = np.matmul(self._on_seats(onto).swapaxes(2, 3), force[:, : self.pins])
        matrix = (ring if ring.ndim > 4 else ring[None]).reshape(-1, 2 * self.pins, 2 * self.pins)
        moved = np.matmul(matrix, loads.reshape(rows, -1, columns)).reshape(rows, self.pins, 2, columns)
        found = np.zeros(force.shape)
        found[:, : self.pins] = np.matmul(self._on_seats(by), moved)
        return found

    def eliminated(
        self, parts: Any, left: FloatArray, *, turning: bool
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return force and tangent that these contacts add to those of contacts at rest, the deformations' corrections at the
        pose and by it, and what loads press aside of the normals, by the pose and, last, at it.

        Parameters
        ----------
        parts : sequence of ltca.mechanics.contacts._Pressing
            Of the discs.
        left : array, shape (positions, components, contacts)
            r of all contacts.
        turning : bool
            Whether loads that turn with displaced pins count beyond what they hold.
        """
        system, at, size = self.system, self.at, self.at.size
        rows, components = at.pose.shape[0], system.components
        bent, along, turn = self.members.turned_loads(size)
        along, turn = (each.reshape(rows, components, self.discs, self.pairs, size) for each in (along, turn))
        bent = np.moveaxis(bent.reshape(bent.shape[0], rows, self.discs, self.pairs), 2, 3)
        if not turning:
            bent[0] = np.maximum(bent[0], 0.0)
            bent[1:], turn = 0.0, np.zeros(turn.shape)

        def whole(values: FloatArray, own: Any) -> FloatArray:
            if self.discs == 1:
                return values
            found = np.zeros((*values.shape[:-1], size))
            found[..., own] = values
            return found

        def on_pins(values: FloatArray, disc: int) -> FloatArray:
            pins, _, holes, _ = at.local[disc]
            return np.concatenate((values[:, :, pins], values[:, :, holes]), axis=2)

        g = self.of_contacts([whole(on_pins(part.g, disc), at.columns[disc]) for disc, part in enumerate(parts)], along)
        onto_pose = g
        if at.rubs:
            onto_pose = self.of_contacts(
                [whole(on_pins(part.force_map, disc), at.columns[disc]) for disc, part in enumerate(parts)], along
            )
        short = self.of_contacts(
            [
                np.concatenate((left[:, :, kinds[0]], left[:, :, kinds[2]]), axis=2)[..., None]
                for kinds in system.of_kind
            ],
            self.members.slips()[..., None],
        )
        of_discs = [np.concatenate((at.stiffness[..., k[0]], at.stiffness[..., k[2]]), axis=-1) for k in system.of_kind]
        stiffness = np.stack((np.stack(of_discs, axis=-1), np.zeros((at.stiffness.shape[0], *bent.shape[1:]))), axis=3)
        stiffness[: bent.shape[0], :, :, 1] = bent
        by, onto = self.vectors()
        flexible = self.flexibility(by, onto)
        held = system.model.pins
        seats = self.pins if held.ring is not None else 0
        nothing = [np.zeros((rows, components, self.pairs, size))] * self.discs
        turn = self.of_contacts(nothing, turn)
        extra = turn
        if at.by_slope is not None:
            slopes = [at.by_slope.load[:, :, at.at[d][0].start : at.at[d][3].stop] for d in range(self.discs)]
            by_slope = self.of_contacts([on_pins(each, d) for d, each in enumerate(slopes)])
            extra = turn + by_slope
        moved_by = g - np.matmul(flexible, extra)
        if held.ring is not None:
            moved_by = moved_by - self._through_ring(by, onto, extra)
        right = np.concatenate((moved_by, short), axis=-1)
        if seats:
            units = np.zeros((rows, self.pairs, self.entries, 2))
            press = np.zeros((rows, seats, self.entries, 2))
            for values, vectors in ((units, by), (press, onto)):
                values[:, :seats] = self._on_seats(vectors)
            right = np.concatenate((right, units), axis=-1)
        system_matrix = self.pressed(stiffness, flexible.swapaxes(2, 3)).swapaxes(2, 3)
        itself = np.arange(self.entries)
        system_matrix[:, :, itself, itself] += 1.0
        x = _solved_each(system_matrix, right)
        if seats:
            x, units = x[..., :-2], x[:, :seats, :, -2:]
            on = np.matmul(press.swapaxes(2, 3), self.pressed(stiffness[:, :, :seats], units))
            ring = held.ring if held.ring.ndim > 4 else held.ring[None]
            ring = ring.reshape(-1, 2 * seats, seats, 2)
            core = np.matmul(ring.swapaxes(1, 2), on).swapaxes(1, 2).reshape(rows, 2 * seats, 2 * seats)
            core = core + np.eye(2 * seats)
            loads = np.matmul(press.swapaxes(2, 3), self.pressed(stiffness[:, :, :seats], x[:, :seats]))
            moved = np.matmul(ring.reshape(-1, 2 * seats, 2 * seats), loads.reshape(rows, 2 * seats, -1))
            back = solved(core, moved).reshape(rows, seats, 2, -1)
            x[:, :seats] -= np.matmul(units, back)
        kx = self.pressed(stiffness, x).reshape(rows, self.pairs * self.entries, size + 1)
        if at.by_slope is not None:
            kx[..., :size] += by_slope.reshape(rows, -1, size)
        flat = onto_pose.reshape(rows, self.pairs * self.entries, size).swapaxes(1, 2)
        taken = np.matmul(flat, kx)
        # What loads turn with the pose is in the tangent at rest already.
        slips = g.reshape(rows, self.pairs, 2, components, self.discs, size)[:, :, 1]
        turned = np.zeros(g.shape).reshape(slips.shape[0], self.pairs, 2, components, self.discs, size)
        turned[:, :, 1] = slips
        turned = turned.reshape(g.shape)
        resting = self.pressed(stiffness, turned).reshape(rows, -1, size)
        slipped = x.copy()
        slipped[..., :-1] -= g
        taken += np.matmul(turn.reshape(rows, -1, size).swapaxes(1, 2), slipped.reshape(rows, -1, size + 1))
        tangent = taken[..., :-1]
        tangent = tangent - np.matmul(turned.reshape(rows, -1, size).swapaxes(1, 2), resting)
        found, pressed = self.to_contacts(x), kx.reshape(x.shape)
        pressed[..., :-1] += turn
        pressed[..., -1] *= -1.0
        return -taken[..., -1], tangent, -found[..., -1], found[..., :-1], self.to_contacts(pressed, slips=True)


def _solved_each(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Columns solved block by block, shape (positions, pairs, entries, columns), by Gauss's elimination of all blocks at once.

    Blocks are 1 + W K with symmetric K and, without friction, W, both positive but for what loads turn: pivots are positive.
    """
    rows, pairs, size, _ = matrix.shape
    m = np.ascontiguousarray(matrix.reshape(rows * pairs, size, size).transpose(1, 2, 0))
    r = np.ascontiguousarray(right.reshape(rows * pairs, size, -1).transpose(1, 2, 0))
    for place in range(size - 1):
        factors = m[place + 1 :, place] / m[place, place]
        m[place + 1 :, place + 1 :] -= factors[:, None] * m[place, place + 1 :]
        r[place + 1 :] -= factors[:, None] * r[place]
    for place in range(size - 1, -1, -1):
        for behind in range(place + 1, size):
            r[place] -= m[place, behind] * r[behind]
        r[place] /= m[place, place]
    return np.ascontiguousarray(r.transpose(2, 0, 1)).reshape(rows, pairs, size, -1)


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Columns solved position by position.

    Raises
    ------
    ConvergenceError
        When loads that turn with what they press make a system singular.
    """
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    except np.linalg.LinAlgError:
        raise ConvergenceError("contacts at a pose hold nothing: their linear system is singular") from None
