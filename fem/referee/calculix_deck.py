"""Input deck of the same problem for CalculiX: CPE6 elements, surface-to-surface penalty contact.

The deck has the loaded pose of `cyclo fem`, with all bodies undeformed: they overlap by their
approaches and CalculiX presses them apart; the rigid motion it adds is the difference of the two
codes. Differences from our model:

- rollers are held sideways at two nodes near their axis instead of in the mean (frictionless contacts
  leave these supports with next to nothing to carry, and a mean over all nodes would fill the matrix);
- contact is a penalty at many points of each face: pressure = `PENALTY_FACTOR` E/b times penetration, b being the
  half-width expected of the contact;
- rollers that carry nothing are left out, because nothing would hold them;
- elastic shaft pins (``pin_shaft.elastic_contact``) sit on their springs by a hundred nodes, each for the area about it, and
  two nodes keep them from turning.

**Why a hundred nodes carry a shaft pin.** Ours carries it by the mean displacement of its whole area, which is force spread
evenly over all nodes. An equation over all of them makes each pin a dense block, and CalculiX sets its structure up anew
in every iteration: at four times the default size 10 s each instead of 2 to 3. Spread over so many places, force and moment
the same, it is the same but next to these places: that moves the pin by 0.2 % of what its contact yields.

**When an answer counts.** With given points that touch the problem is linear: CalculiX solves it, frees the points that
pull, closes those that overlap and solves again. It ends as soon as the *number* of points changes by less than a
thousandth (its parameter delcon); no residual is left to ask for. At the default size that are 51 of 51,000 points: with
the first penalty of this deck it ended an increment after 28 iterations with 16 points that pulled, by up to 184 of
1549 MPa, and went on with another (paper's CS-1, 0.5 rad). The points must come to rest, so delcon is zero here, the
number of iterations is not limited, and no point is removed at random (alea).

**Why the penalty goes by the half-width.** Two quadratic surfaces whose nodes do not meet cannot follow each other at the
hundred points of a face: the stiffer the penalty against the elements, the longer points change sides, up and down in
number, and the harder those pull that are still to be freed (at three times the default size 402 of 17,544 were left, with
up to 9,440 MPa). What the penalty gives way is pressure times its compliance; the element has no part in it. In terms of the
smallest edge, as it once was, it got four times as stiff from four times the default size to the default, for nothing. In
terms of the half-width it gives way alike on every mesh and gets softer against the elements as they shrink: 20
iterations at the default size.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from fem.body.elasticity import area_loads, unknowns_of_boundary
from fem.body.surface import OppositeZone
from fem.contact.coupling import Pose
from fem.drive.full_solution import FullSolution
from fem.drive.model import ContactPair, DriveModel
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.drive.parts import Material
from ltca.errors import CycloError
from ltca.output.files import whole_file

# Penalty stiffness times expected half-width over E. Penetration under the peak pressure is then p b/(100 E), some
# thousandths of the approach; the wheel of the paper's drive gives way by 0.08″.
PENALTY_FACTOR = 100.0
# delcon, alea, kscalemax (its default), itf2f; see above.
CONTACT_CONTROLS = "0.,0.,100,200"
# Half-angle of the rigid shaft-pin arcs is this many times the zone they face.
RIGID_REACH = 1.3
# Nodes that carry an elastic shaft pin, see above.
SUPPORT_NODES = 100


def find_calculix() -> str:
    """Return the path of the program ``ccx``; CycloError when it is not installed."""
    program = shutil.which("ccx")
    if program is None:
        raise CycloError("--referee calculix: the program ccx is not installed (Debian: apt install calculix-ccx)")
    return program


def pair_name(pair: ContactPair) -> str:
    """Return the name of a contact pair in the deck."""
    return f"{pair.kind}_{pair.index}".upper()


def slave_faces(solution: FullSolution) -> dict[str, list[tuple[int, int]]]:
    """Return element and face (numbered as in the results: 3, 4, 5 for S1, S2, S3) of the slave side of each pair."""
    meshes = solution.model.meshes
    found = {}
    for pair in solution.model.pairs:
        race = pair.kind == "roller_inner"
        # Disc first, then the races of the cranks: see `_add_bodies`.
        offset = 0
        if race:
            before = solution.model.crank_of(pair.index) * meshes.inner_race.mesh.t.shape[1]
            offset = meshes.disc.mesh.t.shape[1] + before
        lines = _faces(meshes.inner_race if race else meshes.disc, pair.zone.nodes[:, 1], offset)
        found[pair_name(pair)] = [
            (int(element), int(side[1:]) + 2) for element, side in (line.split(",") for line in lines)
        ]
    return found


class _Deck:
    """Lines of the deck, nodes and elements numbered through all bodies."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.equations: list[str] = []
        self.springs: list[str] = []
        self.interactions: list[str] = []
        # By name: mesh, number before its first node and before its first element.
        self.placed: dict[str, tuple[BodyMesh, int, int]] = {}
        self.preload: list[tuple[int, complex]] = []
        self.next_node = 1
        self.next_element = 1

    def add_nodes(self, places: ComplexArray) -> int:
        """Write nodes; return the number before the first one."""
        offset = self.next_node - 1
        self.lines.append("*NODE, NSET=NALL")
        self.lines += [
            f"{offset + k},{x:.14g},{y:.14g},0."
            for k, (x, y) in enumerate(zip(places.real, places.imag, strict=True), 1)
        ]
        self.next_node += len(places)
        return offset

    def add_elements(self, kind: str, name: str, nodes: IntArray, material: Material, thickness: float) -> int:
        """Write elements with material and section; return the number before the first one."""
        offset = self.next_element - 1
        self.lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        self.lines += [f"{offset + k}," + ",".join(map(str, row)) for k, row in enumerate(nodes.tolist(), 1)]
        self.lines += [
            f"*MATERIAL, NAME=M_{name}",
            "*ELASTIC",
            f"{material.youngs_modulus:.10g},{material.poisson_ratio:.10g}",
            f"*SOLID SECTION, ELSET={name}, MATERIAL=M_{name}",
            f"{thickness:.10g}",
        ]
        self.next_element += len(nodes)
        return offset

    def add_body(self, name: str, body: BodyMesh, at: Pose, material: Material, thickness: float) -> None:
        """Write a body at its place."""
        nodes = self.add_nodes(at.centre + body.places * np.exp(1j * at.rotation))
        elements = self.add_elements("CPE6", name, nodes + 1 + body.element_nodes, material, thickness)
        self.placed[name] = (body, nodes, elements)

    def equate(self, terms: list[tuple[int, int, float]]) -> None:
        """Write Σ factor · u(node, direction) = 0; the first unknown is eliminated."""
        self.equations += ["*EQUATION", str(len(terms))]
        for first in range(0, len(terms), 4):
            self.equations.append(
                ",".join(f"{node},{direction},{factor:.14g}" for node, direction, factor in terms[first : first + 4])
            )


def _faces(body: BodyMesh, middles: IntArray, elements: int) -> list[str]:
    facets = middles - body.mesh.nvertices
    owners = body.mesh.f2t[0, facets]
    local = np.argmax(body.mesh.t2f[:, owners] == facets, axis=0)
    return [f"{elements + int(owner) + 1},S{int(side) + 1}" for owner, side in zip(owners, local, strict=True)]


def write_deck(solution: FullSolution, path: Path, *, penalty: float = PENALTY_FACTOR) -> Path:
    """Write a complete input deck (``.inp``) of the problem that a full solution in plane strain solved; return the path.

    `penalty` is the penalty stiffness times the expected half-width over E.
    """
    if solution.options.plane != "strain":
        raise CycloError("the CalculiX deck is plane strain; solve with --plane strain")
    model = solution.model
    deck = _Deck()
    deck.lines += [
        f"** cyclo: {model.drive.name}, crank angle {model.crank_angle:.10g} rad, wheel moment "
        f"{solution.state.wheel_moment:.10g} N mm, fingerprint {model.drive.fingerprint()}",
        "** mm, N, MPa; all bodies undeformed at the loaded pose",
    ]
    pairs = _carrying_pairs(solution)
    _add_bodies(deck, solution, pairs)
    wheel = deck.add_nodes(np.zeros(1, dtype=complex)) + 1
    for pair in pairs:
        _add_contact(deck, solution, pair, penalty)
    for pair in pairs:
        if pair.kind == "pin":
            _tie_core(deck, model.circle_centre("pin", pair.index, solution.pose), pair, wheel)
        elif pair.kind == "roller_outer":
            _guide_roller(deck, complex(model.roller_rays[pair.index]), pair)
        elif pair.kind == "hole" and pair.group >= 0:
            _carry_shaft_pin(deck, solution, pair)
    _add_step(deck, pairs, wheel, solution.state.wheel_moment)
    with whole_file(path) as part:
        part.write_text("\n".join(deck.lines) + "\n", encoding="ascii", newline="\n")
    return path


def _carrying_pairs(solution: FullSolution) -> list[ContactPair]:
    """All pins and holes, and both sides of the rollers that press on the disc: a free one would have no place."""
    own = solution.state.contact.pressure
    pairs = solution.model.pairs
    carrying = {pair.index for pair in pairs if pair.kind == "roller_outer" and np.any(own[pair.unknowns] > 0.0)}
    return [pair for pair in pairs if pair.kind in ("pin", "hole") or pair.index in carrying]


def _body_name(pair: ContactPair) -> str:
    return f"{pair.kind[:6]}_{pair.index}".upper()


def _race_name(model: DriveModel, crank: int) -> str:
    return "RACE" if model.placement.cranks == 1 else f"RACE_{crank}"


def _carrier_name(model: DriveModel, pair: ContactPair) -> str:
    return _race_name(model, model.crank_of(pair.index)) if pair.kind == "roller_inner" else "DISC"


def _add_bodies(deck: _Deck, solution: FullSolution, pairs: list[ContactPair]) -> None:
    """Disc, races, then pins and rollers; `slave_faces` counts on this order."""
    model, pose = solution.plane, solution.pose
    materials, thickness = model.drive.materials, model.drive.disc.thickness
    deck.add_body("DISC", model.meshes.disc, model.disc_pose(pose), materials.disc, thickness)
    for crank, centre in enumerate(model.race_centres.tolist()):
        name = _race_name(model, crank)
        deck.add_body(name, model.meshes.inner_race, Pose(centre=centre), materials.inner_race, thickness)
    for pair in pairs:
        if pair.group >= 0 and pair.kind != "roller_inner":
            # The mesh in the frame of its group, whose zones are known, turned to this body.
            centre = model.circle_centre(pair.kind, pair.index, pose)
            material = {"pin": materials.wheel_pin, "hole": materials.shaft_pin}.get(pair.kind, materials.roller)
            at = Pose(centre=centre, rotation=pair.turn)
            deck.add_body(_body_name(pair), model.groups[pair.group].body, at, material, thickness)


def _add_contact(deck: _Deck, solution: FullSolution, pair: ContactPair, penalty: float) -> None:
    """Write both surfaces of a pair and what acts between them."""
    model, pose = solution.plane, solution.pose
    drive, name = model.drive, pair_name(pair)
    carrier, _, elements = deck.placed[_carrier_name(model, pair)]
    faces = _faces(carrier, pair.zone.nodes[:, 1], elements)
    if pair.group < 0:
        opposite = _add_rigid_arc(
            deck, pair, model.disc_pose(pose), model.circle_centre("hole", pair.index, pose),
            drive.hole_stiffness, drive.disc.thickness, complex(pose.shaft_pin_displacements[pair.index]),
        )  # fmt: skip
    else:
        body, _, first = deck.placed[_body_name(pair)]
        zone: OppositeZone = model.groups[pair.group].zones[1 if pair.kind == "roller_inner" else 0]
        opposite = _faces(body, zone.nodes[1::2], first)
    deck.lines += [f"*SURFACE, NAME=S_{name}, TYPE=ELEMENT", *faces]
    deck.lines += [f"*SURFACE, NAME=O_{name}, TYPE=ELEMENT", *opposite]
    deck.interactions += [
        f"*SURFACE INTERACTION, NAME=I_{name}",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{penalty * drive.materials.disc.youngs_modulus / pair.expected_half_width:.6g}",
        f"*CONTACT PAIR, INTERACTION=I_{name}, TYPE=SURFACE TO SURFACE",
        f"S_{name},O_{name}",
    ]


def _add_step(deck: _Deck, pairs: list[ContactPair], wheel: int, wheel_moment: float) -> None:
    """Write constraints, springs, contacts, then the load and what is printed."""
    deck.lines.append("*NSET, NSET=FIXED")
    for name, (body, offset, _) in deck.placed.items():
        if name.startswith("RACE"):
            fixed = np.unique(unknowns_of_boundary(body, "inner") // 2) + offset + 1
            deck.lines += map(str, fixed.tolist())
    deck.lines += [*deck.equations, *deck.springs, *deck.interactions]
    deck.lines += ["*BOUNDARY", "FIXED,1,2"]
    deck.lines += ["*STEP, INC=200", "*STATIC", "1.,1.", "*CONTROLS, PARAMETERS=CONTACT", CONTACT_CONTROLS]
    deck.lines += ["*CLOAD", f"{wheel},1,{wheel_moment:.14g}"]
    for node, force in deck.preload:
        deck.lines += [f"{node},1,{force.real:.14g}", f"{node},2,{force.imag:.14g}"]
    for pair in pairs:
        name = pair_name(pair)
        deck.lines += [f"*CONTACT PRINT, SLAVE=S_{name}, MASTER=O_{name}", "CFN"]
    deck.lines += ["*CONTACT PRINT", "CSTR"]
    deck.lines += ["*NSET, NSET=WHEEL", str(wheel), "*NODE PRINT, NSET=WHEEL", "U", "*END STEP"]


def _tie_core(deck: _Deck, centre: complex, pair: ContactPair, wheel: int) -> None:
    """Let the core of a pin turn with the wheel: u = ω × r, ω being the first unknown of the wheel's node."""
    body, offset, _ = deck.placed[_body_name(pair)]
    for node in np.unique(unknowns_of_boundary(body, "core") // 2).tolist():
        x, y = body.mesh.doflocs[:, node]
        at = centre + complex(x, y) * np.exp(1j * pair.turn)
        deck.equate([(offset + node + 1, 1, 1.0), (wheel, 1, at.imag)])
        deck.equate([(offset + node + 1, 2, 1.0), (wheel, 1, -at.real)])


def _guide_roller(deck: _Deck, ray: complex, pair: ContactPair) -> None:
    """Hold a roller across its ray at two nodes near its axis of load."""
    body, offset, _ = deck.placed[_body_name(pair)]
    across = 1j * ray
    for node in _nodes_beside_centre(body, ray * np.exp(-1j * pair.turn)):
        terms = [(offset + node + 1, 1, across.real), (offset + node + 1, 2, across.imag)]
        deck.equate(sorted(terms, key=lambda term: -abs(term[2])))


def _add_rigid_arc(
    deck: _Deck,
    pair: ContactPair,
    disc: Pose,
    centre: complex,
    stiffness: float,
    thickness: float,
    displaced: complex,
) -> list[str]:
    """Write a rigid arc of a shaft pin on its springs; return its outer faces."""
    zone = pair.zone
    middle = np.angle(disc.place(zone.places[zone.edge_count // 2, 1:2])[0] - centre)
    reach = RIGID_REACH * 0.5 * zone.arc[-1] / pair.radius
    count = max(2 * zone.edge_count, 8)
    angles = middle + np.linspace(-reach, reach, 2 * count + 1)
    depth = pair.radius * 2.0 * reach / count
    outer = centre + pair.radius * np.exp(1j * angles)
    between = centre + (pair.radius - 0.5 * depth) * np.exp(1j * angles[::2])
    inner = centre + (pair.radius - depth) * np.exp(1j * angles)
    places = np.concatenate([outer, inner, between])
    offset = deck.add_nodes(places) + 1
    size = 2 * count + 1
    k = 2 * np.arange(count)
    nodes = np.column_stack(
        [size + k, k, k + 2, size + k + 2, 2 * size + k // 2, k + 1, 2 * size + k // 2 + 1, size + k + 1]
    )
    # Corners ccw: inner first, outer first, outer last, inner last (angles grow).
    material = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
    elements = deck.add_elements("CPE8", f"RIGID_{pair.index}", offset + nodes, material, thickness)
    reference = deck.add_nodes(np.array([centre])) + 1
    for node in range(len(places)):
        deck.equate([(offset + node, 1, 1.0), (reference, 1, -1.0)])
        deck.equate([(offset + node, 2, 1.0), (reference, 2, -1.0)])
    _add_spring(deck, reference, pair.index, stiffness, displaced)
    order = nodes[0].tolist()
    side = next(i for i in range(4) if {order[i], order[(i + 1) % 4]} == {0, 2})
    return [f"{elements + i + 1},S{side + 1}" for i in range(count)]


def _add_spring(deck: _Deck, reference: int, index: int, stiffness: float, displaced: complex) -> None:
    """Hold the node of a shaft pin by its spring, N/mm."""
    # The pose holds the pin displaced by F/k; springs start without force, so a force makes up for it.
    for direction in (1, 2):
        deck.springs += [
            f"*ELEMENT, TYPE=SPRING1, ELSET=SPRING_{index}_{direction}",
            f"{deck.next_element},{reference}",
            f"*SPRING, ELSET=SPRING_{index}_{direction}",
            str(direction),
            f"{stiffness:.10e}",
        ]
        deck.next_element += 1
    deck.springs += ["*BOUNDARY", f"{reference},3,3"]
    deck.preload.append((reference, -stiffness * displaced))


def _carry_shaft_pin(deck: _Deck, solution: FullSolution, pair: ContactPair) -> None:
    """Carry an elastic shaft pin evenly over its cross-section on its spring, without rotation."""
    model, pose = solution.plane, solution.pose
    body, offset, _ = deck.placed[_body_name(pair)]
    reference = deck.add_nodes(np.array([model.circle_centre("hole", pair.index, pose)])) + 1
    displaced = complex(pose.shaft_pin_displacements[pair.index])
    _add_spring(deck, reference, pair.index, model.drive.hole_stiffness, displaced)
    nodes, shares = even_support(body)
    carried = list(zip((offset + 1 + nodes).tolist(), shares.tolist(), strict=True))
    for direction in (1, 2):
        deck.equate([(reference, direction, -1.0), *((node, direction, share) for node, share in carried)])
    # Frictionless contact at a circle has no moment: two nodes keep the pin from turning and carry next to nothing.
    across = 1j * np.exp(1j * pair.turn)
    first, second = (offset + node + 1 for node in _nodes_beside_centre(body, 1.0))
    terms = [(first, 1, across.real), (first, 2, across.imag), (second, 1, -across.real), (second, 2, -across.imag)]
    deck.equate(sorted(terms, key=lambda term: -abs(term[2])))


def even_support(body: BodyMesh, count: int = SUPPORT_NODES) -> tuple[IntArray, FloatArray]:
    """Return up to `count` nodes of a circle about the origin, evenly spread, and the share of a force on each.

    Shares are the areas nearest to each node, corrected so that their resultant passes through the origin; they sum to one.
    """
    areas = area_loads(body)[::2, 0]
    areas = areas / np.sum(areas)
    places = body.places
    number = np.arange(count)
    # A sunflower's seeds have equal areas.
    seeds = np.abs(places).max() * np.sqrt((number + 0.5) / count) * np.exp(1j * np.pi * (3.0 - np.sqrt(5.0)) * number)
    _, nearest = cKDTree(body.mesh.doflocs.T).query(np.column_stack([seeds.real, seeds.imag]))
    nodes = np.unique(nearest)
    _, owner = cKDTree(body.mesh.doflocs.T[nodes]).query(body.mesh.doflocs.T)
    nearby = np.bincount(owner, weights=areas, minlength=len(nodes)).astype(float)
    # Least change that gives the resultant its size and its place.
    modes = np.vstack([np.ones(len(nodes)), body.mesh.doflocs[:, nodes]])
    change = np.linalg.lstsq(modes, np.array([1.0, 0.0, 0.0]) - modes @ nearby, rcond=None)[0]
    return nodes, nearby + change


def _nodes_beside_centre(body: BodyMesh, direction: complex) -> tuple[int, int]:
    """Return the nodes nearest to 0.3 of the radius on both sides of the centre of a round body."""
    places = body.places
    reach = 0.3 * float(np.abs(places).max()) * direction
    return int(np.argmin(np.abs(places + reach))), int(np.argmin(np.abs(places - reach)))
