"""A pair of solid blocks given to CalculiX: C3D20R on the same mesh, surface-to-surface penalty contact.

The elements have the vertices and mid-sides of ours; what differs is the node in the middle of faces and elements,
which ours have as well, and the integration, reduced there to eight points. The body opposite stands in the loaded
pose, undeformed: it overlaps the carrier by approach, tilt and what profile and lead leave of them, and CalculiX
presses both apart. Sides and bottom are held as ours are, planes of symmetry likewise. Contact is a penalty at many
points of each face (`fem.referee.calculix_deck`).

Pressures are compared face by face as means: of the points of CalculiX, and of ours, which is bilinear there.
CalculiX prints the points that touch alone; faces at the rim, of which some do not, are left out, because the areas of the
points are not told.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.referee.calculix import last_output, read_forces, read_pressures, run_calculix
from fem.referee.calculix_deck import CONTACT_CONTROLS
from fem.solid_contact.block import Block
from fem.solid_contact.solved_pair import SolvedPair
from ltca.arrays import BoolArray, FloatArray, IntArray
from ltca.drive.parts import Material
from ltca.errors import CycloError
from ltca.output.files import whole_file

PENALTY_FACTOR = 400.0
"""Penalty stiffness times half-width over E: four times that of the plane, where loads are given. Here the approach is, of
which the penetration takes p b/(400 E), some hundredths of a per cent."""
LOAD_BOUND, PRESSURE_BOUND = 3e-3, 2e-2
"""Asked of a pair on the same mesh: load and largest mean pressure of a face. Two elements for a half-width (`--size 4`) are too
few for either code."""
OPEN = 2.0
"""Reliefs beyond this many approaches are cut off: logarithmic profiles have no end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PairReferee:
    """Answer of CalculiX beside ours.

    Attributes
    ----------
    load : float
        Of the whole pair by CalculiX, N.
    largest : float
        Largest mean pressure of a face by CalculiX, MPa.
    own_largest : float
        Ours, of the same kind, MPa.
    deviation : float
        Root mean square of the differences of the faces that carry all over, by the largest.
    faces : int
        How many these are.
    seconds : float
        Wall time of ccx.
    """

    load: float
    largest: float
    own_largest: float
    deviation: float
    faces: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Row:
    """One quantity by both codes.

    Attributes
    ----------
    quantity : str
        With its unit.
    own, other : float
        Ours and CalculiX's.
    bound : float
        Of the relative difference.
    """

    quantity: str
    own: float
    other: float
    bound: float

    @property
    def difference(self) -> float:
        """Ours less the other, by the other."""
        return self.own / self.other - 1.0

    @property
    def passed(self) -> bool:
        """Whether the difference is within the bound; NaN is not."""
        return abs(self.difference) <= self.bound


@dataclass(frozen=True, slots=True, kw_only=True)
class _Numbering:
    """Where a block's nodes and elements stand in the deck."""

    lines: list[str]
    faces: list[str]
    elements: IntArray
    held: list[str]


def write_pair_deck(solved: SolvedPair, path: Path) -> Path:
    """Write a complete input deck (``.inp``) of a solved pair; return the path."""
    pair = solved.pair
    if pair.opposite_material is None:
        raise CycloError("--referee calculix: the body opposite is rigid; give an elastic one")
    lines = [
        f"** cyclo: {pair.name}, approach {solved.approach:.10g} mm, tilt {solved.tilt:.10g} rad",
        "** mm, N, MPa; both bodies undeformed in the loaded pose",
    ]
    parts = _parts(solved)
    for name, part, material in zip(
        ("CARRIER", "OPPOSITE"), parts, (pair.carrier_material, pair.opposite_material), strict=True
    ):
        lines += part.lines
        lines += _material(name, material)
        lines += [f"*SURFACE, NAME=S_{name}, TYPE=ELEMENT", *part.faces]
    stiffness = PENALTY_FACTOR * pair.carrier_material.youngs_modulus / float(solved.half_width.max())
    lines += [
        "*SURFACE INTERACTION, NAME=I_PAIR",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{stiffness:.6g}",
        "*CONTACT PAIR, INTERACTION=I_PAIR, TYPE=SURFACE TO SURFACE",
        "S_CARRIER,S_OPPOSITE",
        "*BOUNDARY",
        *parts[0].held,
        *parts[1].held,
        "*STEP, INC=200",
        "*STATIC",
        "1.,1.",
        "*CONTROLS, PARAMETERS=CONTACT",
        CONTACT_CONTROLS,
        "*CONTACT PRINT, SLAVE=S_CARRIER, MASTER=S_OPPOSITE",
        "CFN",
        "*CONTACT PRINT",
        "CSTR",
        "*END STEP",
    ]
    with whole_file(path) as part_file:
        part_file.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
    return path


def ask_about_pair(solved: SolvedPair, deck: Path, program: str) -> PairReferee:
    """Let CalculiX solve the deck of a pair and compare the answers; what it prints is written beside the deck as ``.dat``."""
    text, seconds = run_calculix(write_pair_deck(solved, deck), program)
    with whole_file(deck.with_suffix(".dat")) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    last = last_output(text)
    (force,) = read_forces(last).values()
    points = {element: values for (element, _), values in read_pressures(last).items()}
    elements = _parts(solved)[0].elements
    touching = [[points.get(int(number), []) for number in row] for row in elements]
    whole = inner_faces(np.array([[bool(values) for values in row] for row in touching]), solved)
    if not np.any(whole):
        raise CycloError(
            "--referee calculix: no face carries all over, so that none can be compared; give a smaller --size"
        )
    theirs = np.array([[np.mean(values) if values else 0.0 for values in row] for row in touching])[whole]
    own = face_means(solved)[whole]
    share = (2.0 if solved.pair.symmetric else 1.0) * (2.0 if solved.width.even else 1.0)
    return PairReferee(
        load=share * float(np.hypot(force[0], force[1])),
        largest=float(theirs.max()),
        own_largest=float(own.max()),
        deviation=float(np.sqrt(np.mean((own - theirs) ** 2)) / own.max()),
        faces=int(np.count_nonzero(whole)),
        seconds=seconds,
    )


def inner_faces(touching: BoolArray, solved: SolvedPair) -> BoolArray:
    """Return which faces carry all over: those that touch, and all around them too.

    The rim of a contact passes through faces next to ones that do not touch. How many points a face has says nothing: where
    the surfaces are cut by each other's edges faces have more. Planes of symmetry and ends of the line are no rim.
    """
    padded = np.pad(touching, 1, mode="edge")
    # The zone itself ends where nothing touches.
    padded[-1] = False
    if not solved.pair.symmetric:
        padded[0] = False
    columns, layers = touching.shape
    around = [padded[i : i + columns, k : k + layers] for i in range(3) for k in range(3)]
    return np.asarray(np.logical_and.reduce(around))


def referee_rows(solved: SolvedPair, answer: PairReferee) -> tuple[Row, Row]:
    """Return load and largest mean of a face beside CalculiX's, with their bounds."""
    return (
        Row("load at this approach, N", solved.load, answer.load, LOAD_BOUND),
        Row("largest mean of a face, MPa", answer.own_largest, answer.largest, PRESSURE_BOUND),
    )


def tabulate_referee(solved: SolvedPair, answer: PairReferee) -> list[str]:
    """Return a table of our answer and CalculiX's with bounds and verdicts, line by line."""
    return [
        f"{'':<34}{'cyclo':>12}{'ccx C3D20R':>12}{'difference, %':>15}{'bound, %':>10}  verdict",
        *(
            f"{row.quantity:<34}{row.own:>12.3f}{row.other:>12.3f}{100.0 * row.difference:>15.3f}{100.0 * row.bound:>10g}"
            f"  {'passed' if row.passed else 'FAILED'}"
            for row in referee_rows(solved, answer)
        ),
        f"means of {answer.faces} faces that carry all over differ by {100.0 * answer.deviation:.2f} % of the largest "
        f"(root mean square); ccx took {answer.seconds:.1f} s",
    ]


def _heights(solved: SolvedPair, body: int) -> FloatArray:
    """Ends of the layers that are in the deck: the upper half where pressures are even."""
    ends = solved.layers[body]
    return ends if solved.width.even else np.concatenate([-ends[:0:-1], ends])


def _parts(solved: SolvedPair) -> tuple[_Numbering, _Numbering]:
    found: list[_Numbering] = []
    nodes = elements = 0
    for body, block in enumerate(solved.blocks):
        part, nodes, elements = _number(solved, body, block, nodes, elements)
        found.append(part)
    return found[0], found[1]


def _number(
    solved: SolvedPair, body: int, block: Block, first_node: int, first_element: int
) -> tuple[_Numbering, int, int]:
    """Lines of one block, and the numbers after its last node and element."""
    pair, ends = solved.pair, _heights(solved, body)
    z = np.empty(2 * ends.size - 1)
    z[0::2], z[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    section = block.section
    corners, sides = section.element_nodes[:, :4], section.element_nodes[:, 4:8]
    used = np.zeros((section.node_count, z.size), dtype=bool)
    used[np.unique(corners)] = True
    used[np.unique(sides), ::2] = True
    number = np.zeros(used.shape, dtype=np.int64)
    number[used] = first_node + 1 + np.arange(np.count_nonzero(used))
    x, y = section.places
    lifted = np.broadcast_to(y[:, None], used.shape).copy()
    if body == 1:
        depth = np.repeat(np.arange(2 * block.rows + 1), 2 * block.columns + 1)
        top = y[: 2 * block.columns + 1][np.arange(section.node_count) % (2 * block.columns + 1)]
        # What the profile takes from the surface fades with the depth; approach and tilt move the whole block.
        fade = np.where(depth > 0, 1.0 - (y - top) / (y[-1] - top), 1.0)
        relief = np.clip(pair.relief(z), None, OPEN * abs(solved.approach) + abs(solved.tilt) * pair.length)
        relief = np.where(np.abs(z) <= 0.5 * pair.length * (1.0 + 1e-9), relief, 0.0)
        lifted = lifted + fade[:, None] * relief - (solved.approach + solved.tilt * z)
    lines = [f"*NODE, NSET=N_{body}"]
    for node, level in zip(*np.nonzero(used), strict=True):
        lines.append(f"{number[node, level]},{x[node]:.14g},{lifted[node, level]:.14g},{z[level]:.14g}")
    layers = ends.size - 1
    count = corners.shape[0]
    lines.append(f"*ELEMENT, TYPE=C3D20R, ELSET={('CARRIER', 'OPPOSITE')[body]}")
    for layer in range(layers):
        low, middle, high = 2 * layer, 2 * layer + 1, 2 * layer + 2
        rows = np.concatenate(
            [number[corners, low], number[corners, high], number[sides, low], number[sides, high], number[corners,
            middle]], axis=1,
        )  # fmt: skip
        for place, row in enumerate(rows.tolist()):
            lines.append(f"{first_element + layer * count + place + 1}," + ",".join(map(str, row[:15])) + ",")
            lines.append(",".join(map(str, row[15:])))
    # The surface is the first side of elements above it and the last of those below.
    inside = np.flatnonzero(np.abs(0.5 * (ends[1:] + ends[:-1])) < 0.5 * pair.length)
    own = np.arange(*block.zone_columns)
    surface = first_element + 1 + inside[None, :] * count + own[:, None]
    held = [f"{n},1,3" for n in number[block.far_nodes][used[block.far_nodes]].tolist()]
    far = np.zeros(section.node_count, dtype=bool)
    far[block.far_nodes] = True
    for node in block.plane_nodes[~far[block.plane_nodes]]:
        held += [f"{n},1,1" for n in number[node][used[node]].tolist()]
    if solved.width.even:
        held += [f"{n},3,3" for n in number[:, 0][used[:, 0] & ~far].tolist()]
    side = ("S6", "S3")[body]
    part = _Numbering(lines=lines, faces=[f"{n},{side}" for n in surface.ravel().tolist()], elements=surface, held=held)
    return part, first_node + int(np.count_nonzero(used)), first_element + layers * count


def _material(name: str, material: Material) -> list[str]:
    return [
        f"*MATERIAL, NAME=M_{name}",
        "*ELASTIC",
        f"{material.youngs_modulus:.10g},{material.poisson_ratio:.10g}",
        f"*SOLID SECTION, ELSET={name}, MATERIAL=M_{name}",
    ]


def face_means(solved: SolvedPair) -> FloatArray:
    """Return the means of our pressure over the faces that are in the deck, MPa, shape (columns, layers)."""
    field = solved.pressure
    means = 0.25 * (field[1:, 1:] + field[1:, :-1] + field[:-1, 1:] + field[:-1, :-1])
    if solved.pair.symmetric:
        means = means[means.shape[0] // 2 :]
    return np.asarray(means[:, means.shape[1] // 2 :] if solved.width.even else means)
